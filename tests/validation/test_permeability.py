"""The table of permeability: the fit, the intervals over seeds, and the published fits that it is held against."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import math
import random
from pathlib import Path

import pytest

from pipeline.solve.bed import Bed
from pipeline.solve.settings import StokesSettings
from pipeline.solve.stokes.solver import solve_stokes
from pipeline.study.settings import read_study
from tests.openfoam import AIR
from tests.solve import rows as arrays
from validation.permeability import one_seed
from validation.permeability_data import DATA, SLIP_DATA, STUDIES, SWEPT, Measured, Slipping, measured, slipping
from validation.permeability_page import (
    figure,
    fit,
    fit_slip,
    interval,
    kinds,
    kinds_table,
    law,
    models_table,
    resistances,
    sizes_table,
    slip_table,
)
from validation.records import read_records
from validation.slip_sweep import permeability_gains


def mats(noise: float = 0.0) -> list[Measured]:
    """Mats whose resistance is 30 solidity^1.4, with a scatter."""
    drawn = random.Random(1)
    rows = []
    for spacing, solidity in ((0.0, 0.15), (0.3, 0.1), (1.0, 0.06), (2.0, 0.03)):
        for seed in range(1, 6):
            own = solidity * (1.0 + 0.01 * seed)
            k = 4.0 / (30.0 * own**1.4) * math.exp(noise * drawn.gauss(0.0, 1.0))
            rows.append(Measured("some", 10.0, 2.0, 0.15, "clear", spacing, seed, own, 12.0, 900, k, 0.09, 1.1 * k))
    return rows


def gains() -> list[Slipping]:
    """Two mats whose permeability gains 4 Kn^.9 solidity^.5."""
    return [
        Slipping(0.15, "clear", spacing, 1, solidity, kn, 4.0 * kn**0.9 * solidity**0.5)
        for spacing, solidity in ((2.0, 0.04), (0.3, 0.16))
        for kn in (0.05, 0.2)
    ]


def test_a_power_law_is_found_again_and_its_scatter_too() -> None:
    exact = fit(mats())
    assert exact.factor == pytest.approx(30.0)
    assert exact.power == pytest.approx(1.4)
    assert exact.growth == pytest.approx(0.0, abs=1e-9)
    assert exact.scatter == pytest.approx(0.0, abs=1e-9)
    assert exact.mats == 20
    # twenty draws know their standard deviation to a sixth
    assert fit(mats(0.1)).scatter == pytest.approx(0.1, rel=0.5)


def test_how_well_a_fit_is_known_comes_from_fitting_each_seed_alone() -> None:
    rows = mats()
    # every seed's mats lie on the same law
    assert law(rows, fit(rows)).endswith("resistance ± 0 % at 0.03, 0 % at 0.05, 0 % at 0.1, 0 % at 0.15 (95 %).")
    # seeds whose resistances differ by a factor as a whole: each mat counts, but there are two draws and not eight
    two = [
        dataclasses.replace(each, permeability=each.permeability * (1.1 if each.seed == 1 else 1.0))
        for each in rows
        if each.seed < 3
    ]
    # Student's t for two values: 12.706 times half of their difference
    assert f"± {100 * 12.706 * 0.5 * math.log(1.1):.0f} % at 0.03, " in law(two, fit(two))


def test_a_gain_by_slip_is_a_law_of_knudsen_number_and_solidity() -> None:
    rows = gains()
    found = fit_slip(rows)
    assert (found.factor, found.knudsen, found.solidity) == pytest.approx((4.0, 0.9, 0.5))
    assert found.scatter == pytest.approx(0.0, abs=1e-9)
    lines = slip_table(rows).split("\n")
    assert lines[0].endswith("| Kn 0.05 | Kn 0.2 |")
    # 4 x .2^.9 x .04^.5 = 18.8 %
    assert "| +18.8 % (" in lines[2]


def test_sizes_are_told_with_the_scatter_of_one_mat() -> None:
    rows = [
        dataclasses.replace(
            each, study="some", side=side, spacing=0.286, permeability=each.permeability * factor, seed=seed
        )
        for side, spread in ((5.0, 0.2), (14.0, 0.05))
        for seed, factor in enumerate((1.0 - spread, 1.0, 1.0 + spread), 1)
        for each in mats()[5:6]
    ]
    small, large = sizes_table(rows, fit(mats())).split("\n")[2:]
    # three values a spread apart have it for their standard deviation
    assert small.startswith("| 5 d | 2 | 12 d | 3 |")
    assert "| 20 % |" in small
    assert "| 5 % |" in large


def test_one_mesh_tells_the_gain_at_the_air_of_a_solution_and_more_in_thinner_air() -> None:
    radius = 5e-6
    mesh, domain = arrays.rows(0.1, around=4, outward=3, radius=radius)
    air = dataclasses.replace(AIR, mean_free_path=0.1 * radius)
    bed = Bed(face_area=1e-10, thickness=5e-5, pressure_factor=1.0)
    solution, _, _ = solve_stokes(
        mesh.face_mesh(), domain, air, bed, 0.1, "slip", "symmetry", StokesSettings(), lambda *_: None
    )
    assert solution.pressure_drop_slip is not None
    assert solution.pressure_drop_no_slip is not None
    gains = permeability_gains(mesh.face_mesh(), domain, "symmetry", [0.2, 0.1])
    # both stop at errors of 1e-4 of a drop
    assert gains[1] == pytest.approx(solution.pressure_drop_no_slip / solution.pressure_drop_slip - 1.0, abs=3e-4)
    # twice as thin, not quite twice the gain
    assert 1.5 * gains[1] < gains[0] < 2.0 * gains[1]


def test_a_plot_shows_what_there_is() -> None:
    rows = mats()
    drawn = figure(rows, [], fit(rows))
    assert len(drawn.axes) == 3
    assert len(figure(rows, gains(), fit(rows)).axes[2].lines) == 2


def test_each_seed_of_a_study_is_a_study_of_its_own() -> None:
    study = read_study(STUDIES[0])
    second = one_seed(study, 1, keep=True)
    assert (second.first_seed, second.seeds, second.keep) == (study.first_seed + 1, 1, "everything")
    assert second.points() == study.points()


def test_what_dense_mats_have_beyond_a_power_is_found_too() -> None:
    dense = [
        dataclasses.replace(each, permeability=each.permeability * math.exp(-3.0 * each.solidity)) for each in mats()
    ]
    found = fit(dense)
    assert (found.factor, found.power, found.growth) == pytest.approx((30.0, 1.4, 3.0))
    assert found.resistance(0.1) == pytest.approx(30.0 * 0.1**1.4 * math.exp(0.3))


def test_an_interval_is_students() -> None:
    mean, half = interval([1.0, 2.0, 3.0])
    assert mean == 2.0
    assert half == pytest.approx(4.3027 / math.sqrt(3.0), rel=1e-4)
    assert math.isnan(interval([1.0])[1])


def test_kinds_differ_by_more_than_their_seed_and_are_shown_from_loose_to_dense() -> None:
    rows = mats()
    assert [len(group) for group in kinds(rows)] == [5, 5, 5, 5]
    lines = kinds_table(rows, fit(rows)).split("\n")[2:]
    assert "clear, 2 d" in lines[0]
    # every mat lies on the fit, and slips by a tenth
    assert all("| 1.00 ± 0.00 | +10.0 % (Kn 0.090) |" in line for line in lines)


def test_a_model_is_held_against_the_fit_and_against_the_mats() -> None:
    rows = mats()
    davies = next(line for line in models_table(rows, fit(rows)).split("\n") if line.startswith("| Davies"))
    # 64 s^1.5 (1 + 56 s^3) over 30 s^1.4 at 5 %
    assert f"{64.0 * 0.05**1.5 * (1 + 56 * 0.05**3) / (30.0 * 0.05**1.4):.2f}" in davies


@pytest.mark.parametrize(("title", "solidity", "k"), [
    ("Jackson and James (1986)", 0.1, 3.0 * (-math.log(0.1) - 0.931) / (20.0 * 0.1)),
    ("Nabovati et al. (2009)", 0.1, 0.491 * (math.sqrt(9.257) - 1.0) ** 2.31),
    ("Koponen et al. (1998)", 0.1, 5.55 / (math.e**1.01 - 1.0)),
])  # fmt: skip
def test_published_fits_are_those_of_their_papers(title: str, solidity: float, k: float) -> None:
    assert 4.0 / resistances()[title](solidity) == pytest.approx(k, rel=1e-9)


def test_a_finished_run_of_a_study_is_read_in_diameters(tmp_path: Path) -> None:
    place = tmp_path / "results" / "one"
    place.mkdir(parents=True)
    (tmp_path / "work" / "one").mkdir(parents=True)
    (tmp_path / "work" / "one" / SWEPT).write_text("[[0.05, 0.06], [0.2, 0.21]]")
    set_ = ['mat.side="14 um"', 'mat.contact="clear"', 'mat.spacing="0.7 um"', "mat.seed=3"]
    (place / "manifest.json").write_text(json.dumps({"set": set_}))
    found = {
        "mat": {"thickness": 28e-6},
        "tetmesh": {"cells": 900},
        "compare": {"fiber_diameter": 1.4e-6, "knudsen": 0.09, "solidity": {"mesh": 0.06}},
        "solve": {"permeability": 5.5 * 0.49e-12, "pressure_drop_slip": 1.0, "pressure_drop_no_slip": 1.1},
    }
    (place / "result.json").write_text(json.dumps(found))
    (one,) = measured(tmp_path)
    assert (one.slope, one.contact, one.seed) == (0.15, "clear", 3)
    assert one.side == pytest.approx(10.0)
    assert one.spacing == pytest.approx(0.5)
    assert one.thickness == pytest.approx(20.0)
    # without slip less goes through, by the ratio of the drops
    assert one.permeability_slip == pytest.approx(5.5)
    assert one.permeability == pytest.approx(5.0)
    assert (one.coverage, one.cells) == (2.0, 900)
    assert [(each.knudsen, each.gain) for each in slipping(tmp_path)] == [(0.05, 0.06), (0.2, 0.21)]
    assert {(each.seed, each.solidity, round(each.spacing, 3)) for each in slipping(tmp_path)} == {(3, 0.06, 0.5)}


def test_the_kept_data_are_of_the_bundled_studies_and_within_the_scatter_of_random_media() -> None:
    rows = read_records(DATA, Measured)
    assert {each.study for each in rows} <= {study.stem for study in STUDIES}
    for study in STUDIES:
        read_study(study)
    # published fits and measurements of one medium differ by a factor of two and a half
    for each in rows:
        found = resistances()["Jackson and James (1986)"](each.solidity) * each.permeability / 4.0
        assert 1.0 / 3.0 < found < 3.0
        assert each.permeability_slip > each.permeability
    # thinner air slips more
    for mat in {(each.slope, each.contact, each.spacing, each.seed) for each in read_records(SLIP_DATA, Slipping)}:
        own = [
            each
            for each in read_records(SLIP_DATA, Slipping)
            if (each.slope, each.contact, each.spacing, each.seed) == mat
        ]
        assert [each.gain for each in sorted(own, key=lambda each: each.knudsen)] == sorted(each.gain for each in own)
