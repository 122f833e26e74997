"""The table of permeability: the fit, the intervals over seeds, and the published fits that it is held against."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import math
import random
from pathlib import Path

import pytest

from pipeline.study.settings import read_study
from validation.permeability import (
    DATA,
    STUDIES,
    Measured,
    fit,
    interval,
    kinds,
    kinds_table,
    measured,
    models_table,
    resistances,
)
from validation.records import read_records


def mats(noise: float = 0.0) -> list[Measured]:
    """Mats whose resistance is 30 solidity^1.4, with a scatter."""
    drawn = random.Random(1)
    rows = []
    for spacing, solidity in ((0.0, 0.15), (0.3, 0.1), (1.0, 0.06), (2.0, 0.03)):
        for seed in range(1, 6):
            own = solidity * (1.0 + 0.01 * seed)
            k = 4.0 / (30.0 * own**1.4) * math.exp(noise * drawn.gauss(0.0, 1.0))
            rows.append(Measured("some", 10.0, 0.15, "clear", spacing, seed, own, 12.0, k, 0.09, 1.1 * k))
    return rows


def test_a_power_law_is_found_again_and_its_scatter_too() -> None:
    exact = fit(mats())
    assert exact.factor == pytest.approx(30.0)
    assert exact.power == pytest.approx(1.4)
    assert exact.scatter == pytest.approx(0.0, abs=1e-9)
    assert exact.mats == 20
    # twenty draws know their standard deviation to a sixth
    assert fit(mats(0.1)).scatter == pytest.approx(0.1, rel=0.5)


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
    set_ = ['mat.side="14 um"', 'mat.contact="clear"', 'mat.spacing="0.7 um"', "mat.seed=3"]
    (place / "manifest.json").write_text(json.dumps({"set": set_}))
    found = {
        "mat": {"thickness": 28e-6},
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
