"""A mat compared from three solidities: the parts add up, and equal mats look equal."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import math
from typing import Literal

import numpy as np
import pytest

from pipeline.analytics.formulas.diameters import mat_diameters
from pipeline.analytics.formulas.pressure_drop import davies, drag_from_coefficient, effective_fiber_diameter
from pipeline.analytics.formulas.slip import knudsen, kuwabara_slip, slip_length
from pipeline.analytics.models.comparison import compare, nominal_solidity
from pipeline.analytics.models.prediction import filter_of_comparison, filter_of_mat, predict
from pipeline.analytics.models.pressure_models import MODELS
from pipeline.analytics.settings import FlowSettings
from pipeline.analytics.tables.rows import comparison_tables
from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.mat.array import array
from pipeline.mat.measures import measure
from pipeline.mat.settings import ArraySettings
from pipeline.nouns.fibers import Mat
from tests.surface.mats import CROSSING

SIDE, THICKNESS = 20e-6, 10e-6
SETTINGS = FlowSettings(face_velocity=0.025)
FLOW = SETTINGS.flow()


def straight(diameters: list[float]) -> Mat:
    """Fibers across the whole side, one beside the other."""
    ys = (np.arange(len(diameters)) + 0.5) / len(diameters) * SIDE
    nodes = np.array([[x, y, THICKNESS / 2] for y in ys for x in (0.0, SIDE)])
    return Mat(
        nodes=nodes,
        first=np.arange(len(diameters) + 1) * 2,
        radius=np.array(diameters) / 2,
        slab=Box((0.0, 0.0, 0.0), (SIDE, SIDE, THICKNESS)),
        seed=-1,
        origin="test",
    )


EQUAL = straight([1.4e-6] * 12)
MIXED = straight([0.5e-6] * 8 + [2e-6] * 4)


def test_the_nominal_solidity_is_the_cylinders_volume_over_the_slab() -> None:
    exact = 12 * math.pi * (0.7e-6) ** 2 * SIDE / (SIDE * SIDE * THICKNESS)
    assert nominal_solidity(EQUAL) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("arrangement", ["square", "hexagonal"])
@pytest.mark.parametrize("rows", [1, 2, 3, 6])
@pytest.mark.parametrize("solidity", [0.01, 0.1, 0.3])
def test_an_array_has_the_solidity_that_it_was_asked_for(
    arrangement: Literal["square", "hexagonal"], rows: int, solidity: float
) -> None:
    # fibers in a symmetry plane count by half: counted whole, three rows of a hexagonal array had five thirds of it
    mat = array(ArraySettings(arrangement=arrangement, solidity=solidity, fiber_diameter=1e-6, rows=rows))
    assert nominal_solidity(mat) == pytest.approx(solidity, rel=1e-12)
    assert measure(mat).solidity == pytest.approx(solidity, rel=1e-12)
    # and so the length per row, which the drag per length is told of, is the slab's depth
    length = nominal_solidity(mat) * mat.slab.volume / (math.pi * float(mat.radius[0]) ** 2)
    assert length == pytest.approx(rows * mat.slab.size[1], rel=1e-12)


def test_half_fibers_weigh_half_in_every_mean() -> None:
    # one of 1 um within, two halves of 3 um in the sides: by length 2 um, as if whole ones of each stood alternately
    line = [(5e-6, 0, 5e-6), (5e-6, 1e-5, 5e-6), (0, 0, 5e-6), (0, 1e-5, 5e-6), (1e-5, 0, 5e-6), (1e-5, 1e-5, 5e-6)]
    slab = Box((0.0, 0.0, 0.0), (1e-5, 1e-5, 1e-5))
    mat = Mat(np.array(line), np.array([0, 2, 4, 6]), np.array([0.5e-6, 1.5e-6, 1.5e-6]), slab, -1, "test")
    assert mat_diameters(mat, FLOW, 0.1)["count"] == pytest.approx(2e-6, rel=1e-12)
    assert measure(mat).diameters.length_weighted == pytest.approx(2e-6, rel=1e-12)
    assert measure(mat).coverage == pytest.approx(0.4, rel=1e-12)


@pytest.mark.parametrize("name", list(MODELS))
def test_overlap_and_meshing_lead_from_the_nominal_pressure_drop_to_the_mesh_s(name: str) -> None:
    row = compare(EQUAL, 0.085, 0.083, FLOW).models[name]
    assert row.nominal + row.overlap + row.meshing == pytest.approx(row.mesh, rel=1e-12)
    assert row.overlap < 0
    assert row.meshing < 0


def test_one_percent_of_solidity_is_one_and_a_half_percent_of_davies_pressure_drop() -> None:
    # method.md: d ln(dP) / d ln(a) = 1.5 + 168 a^3 / (1 + 56 a^3)
    share, change = 0.09, 0.001
    exponent = 1.5 + 168 * share**3 / (1 + 56 * share**3)
    attribution = compare(EQUAL, share, share * (1 - change), FLOW).attribution
    assert attribution["meshing"] == pytest.approx(-change * exponent, rel=2e-3)


def test_the_models_spread_is_that_of_those_in_their_range() -> None:
    comparison = compare(EQUAL, 0.0924, 0.0924, FLOW)
    assert comparison.attribution["overlap"] == pytest.approx(0.0, abs=1e-3)
    assert comparison.attribution["meshing"] == 0.0
    within = {
        name: row.mesh for name, row in comparison.models.items() if not any("solidity" in note for note in row.notes)
    }
    assert "jackson_james" not in within
    own = comparison.models["davies"].mesh
    assert comparison.attribution["model_low"] == pytest.approx(min(within.values()) / own - 1, rel=1e-12)
    assert comparison.attribution["model_high"] == pytest.approx(max(within.values()) / own - 1, rel=1e-12)
    # correlations for random media spread by a factor of 2.5 at 0.1, says method.md
    assert max(within.values()) / min(within.values()) == pytest.approx(2.2, abs=0.3)


def test_the_comparison_writes_the_keys_that_others_build_on() -> None:
    written = json.loads(json.dumps(dataclasses.asdict(compare(EQUAL, 0.09, 0.089, FLOW)), allow_nan=False))
    assert set(written["solidity"]) == {"nominal", "surface", "mesh"}
    assert written["thickness"] == THICKNESS
    for name in MODELS:
        assert {"nominal", "surface", "mesh"} <= set(written["models"][name])
    assert written["models"]["davies"]["mesh"] == pytest.approx(
        davies(0.089) * FLOW.viscosity * 0.025 * THICKNESS / 1.4e-6**2, rel=1e-12
    )


def test_a_finished_run_predicts_what_its_comparison_says() -> None:
    comparison = compare(EQUAL, 0.09, 0.089, FLOW)
    prediction = predict(filter_of_comparison(dataclasses.asdict(comparison)), SETTINGS)
    for name, row in comparison.models.items():
        assert prediction.pressure_drop[name] == pytest.approx(row.mesh, rel=1e-12)


def test_a_mat_predicts_with_its_nominal_solidity() -> None:
    medium = filter_of_mat(EQUAL, FLOW)
    assert medium.thickness == THICKNESS
    assert medium.fiber_diameter == pytest.approx(1.4e-6, rel=1e-12)
    assert medium.solidity == pytest.approx(nominal_solidity(EQUAL), rel=1e-12)


def test_a_mat_fuller_than_full_is_refused() -> None:
    with pytest.raises(CaseError, match="of the slab"):
        filter_of_mat(straight([9e-6] * 40), FLOW)


def test_means_of_equal_fibers_are_their_diameter_and_slip_makes_the_effective_one_larger() -> None:
    means = mat_diameters(EQUAL, FLOW, 0.09)
    for name in ("count", "volume", "surface"):
        assert means[name] == pytest.approx(1.4e-6, rel=1e-12)
    # A33 turned around: without slip the drag of the slipping fibers would be that of thicker ones
    s = slip_length(knudsen(FLOW.mean_free_path, 1.4e-6))
    drop = float(kuwabara_slip(0.09, s)) * FLOW.viscosity * 0.025 * THICKNESS / 1.4e-6**2
    back = effective_fiber_diameter(kuwabara_slip(0.09, 0.0), FLOW.viscosity, 0.025, THICKNESS, drop)
    assert means["effective"] == pytest.approx(float(back), rel=1e-12)
    assert means["effective"] > 1.4e-6


def test_means_of_unequal_fibers_keep_what_they_are_named_for() -> None:
    means = mat_diameters(MIXED, FLOW, 0.09)
    diameter = 2 * MIXED.radius
    assert means["count"] < means["volume"] < means["surface"]
    assert 12 * means["count"] == pytest.approx(diameter.sum(), rel=1e-12)  # coverage
    assert 12 * means["volume"] ** 2 == pytest.approx((diameter**2).sum(), rel=1e-12)  # volume
    # volume over surface, d / 4 for a cylinder
    assert means["surface"] == pytest.approx((diameter**2).sum() / diameter.sum(), rel=1e-12)


def test_the_volume_mean_gives_the_summed_drag_without_slip() -> None:
    # F* depends on the solidity alone, so the drag of all fibers is F* eta U times their length
    still = FlowSettings(mean_free_path=1e-15).flow()
    share = nominal_solidity(MIXED)
    comparison = compare(MIXED, share, share, still)
    length = MIXED.segment_lengths().sum()
    drag = float(drag_from_coefficient(davies(share), share)) * still.viscosity * still.face_velocity * length
    assert comparison.models["davies"].nominal == pytest.approx(drag / SIDE**2, rel=1e-9)
    assert comparison.fiber_diameters["effective"] == pytest.approx(comparison.fiber_diameter, rel=1e-6)


def test_the_tables_tell_each_model_and_each_part() -> None:
    by_model, parts, means = comparison_tables(compare(EQUAL, 0.09, 0.089, FLOW))
    assert [row[0] for row in by_model.rows] == [model.title for model in MODELS.values()]
    assert all(len(row) == len(by_model.columns) for row in by_model.rows)
    assert [row[0].split(" ")[0] for row in parts.rows] == ["overlap", "meshing", "choice"]
    assert [row[0] for row in means.rows] == ["count", "volume", "surface", "effective"]
    # equal fibers have one mean diameter, and it gives the model's own pressure drop
    assert {row[1:] for row in means.rows[:3]} == {
        ("1.4 um", f"{compare(EQUAL, 0.09, 0.089, FLOW).models['davies'].mesh:.4g}")
    }


def test_a_model_beyond_its_pole_is_left_out_and_the_others_stay() -> None:
    # Jackson and James have no answer above a solidity of exp(-0.931) = 0.394
    dense = compare(CROSSING, 0.45, 0.45, FlowSettings().flow())
    assert "jackson_james" not in dense.models
    assert {"davies", "kuwabara", "happel"} <= dense.models.keys()
    for row in dense.models.values():
        assert math.isfinite(row.mesh)
