# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import Any

import pytest

from pipeline.case import Case, validate
from pipeline.design.targets import Target, read_targets
from pipeline.design.tune import tune
from pipeline.errors import CaseError


def pile(**mat: Any) -> Case:
    settings = {"side": "40 um", "fiber_diameter": "1.4 um", "relaxation_slope": 0.15, "stop": {"coverage": 3}, **mat}
    return validate({"mat": {"generator": "layered", **settings}}, "test")


def test_solidity_and_thickness_are_met_together() -> None:
    tuned = tune(pile(), read_targets(["solidity=8 %", "thickness=30 um"]), seeds=4)
    # a fiber more or less moves the mean of four small mats by about half a percent
    assert tuned.measured["solidity"].mean == pytest.approx(0.08, rel=0.01)
    assert tuned.measured["thickness"].mean == pytest.approx(30e-6, rel=0.01)
    assert 0.05 < tuned.relaxation_slope < 0.2
    # summed volume over face area, told twice; bent fibers are a little longer than their plan
    flat = tuned.measured["coverage"].mean * math.pi * 1.4e-6 / 4
    assert pytest.approx(flat, rel=0.03) == 0.08 * 30e-6


def test_what_tune_promises_is_what_the_case_gives() -> None:
    from pipeline.mat.generate import generate
    from pipeline.mat.measures import measure

    case = pile()
    tuned = tune(case, read_targets(["solidity=8 %", "thickness=30 um"]), seeds=3)
    found = {"relaxation_slope": tuned.relaxation_slope, "spacing": f"{tuned.spacing * 1e6} um", "seed": tuned.seed}
    mat = measure(generate(pile(**found, stop={"coverage": float(f"{tuned.coverage:.4g}")}).mat))
    assert mat.thickness == pytest.approx(tuned.closest["thickness"], rel=1e-9)
    assert mat.solidity == pytest.approx(tuned.closest["solidity"], rel=1e-9)


def test_the_keys_to_paste_are_a_case_file() -> None:
    import tomllib

    tuned = tune(pile(), read_targets(["thickness=20 um"]), seeds=2)
    content = tomllib.loads(tuned.toml())["mat"]
    assert content["relaxation_slope"] == 0.15
    assert content["stop"]["coverage"] == pytest.approx(tuned.coverage, rel=1e-3)
    validate({"mat": {"generator": "layered", "side": "40 um", "fiber_diameter": "1.4 um", **content}}, "pasted")


def test_a_mat_looser_than_straight_fibers_gets_spacing() -> None:
    tuned = tune(pile(), read_targets(["solidity=1 %", "coverage=1"]), seeds=3)
    assert tuned.relaxation_slope == 0.0
    assert tuned.spacing > 0.1e-6
    assert tuned.measured["solidity"].mean == pytest.approx(0.01, rel=0.02)


def test_a_kept_slope_stays() -> None:
    tuned = tune(pile(), read_targets(["solidity=6 %", "coverage=3"]), seeds=3, keep=frozenset({"relaxation_slope"}))
    assert tuned.relaxation_slope == 0.15
    assert tuned.spacing > 0.0
    assert tuned.measured["solidity"].mean == pytest.approx(0.06, rel=0.02)


def test_pressure_drop_and_efficiency_are_met_together() -> None:
    tuned = tune(pile(), read_targets(["pressure_drop=20 Pa", "efficiency=45 %"]), seeds=3)
    assert tuned.measured["pressure_drop"].mean == pytest.approx(20.0, rel=0.02)
    assert tuned.measured["efficiency"].mean == pytest.approx(0.45, rel=0.02)


def test_a_target_out_of_reach_says_what_is_reachable() -> None:
    # at a given pressure drop a filter of these fibers holds back a third of the particles, whatever its structure
    with pytest.raises(
        CaseError,
        match=r"efficiency = 99.9 % is out of reach together with pressure_drop = 10 Pa: the "
        r"closest .* is \d.* %, at relaxation slope",
    ):
        tune(pile(), read_targets(["pressure_drop=10 Pa", "efficiency=99.9 %"]), seeds=2)


def test_more_than_all_fibers_say_how_far_they_reach() -> None:
    with pytest.raises(CaseError, match=r"out of reach of mat.max_fibers = 200 fibers: they give .* um"):
        tune(pile(max_fibers=200), (Target("thickness", 1e-3),), seeds=2)


def test_only_layered_mats_are_tuned() -> None:
    box = {"generator": "box", "side": "40 um", "thickness": "20 um", "fiber_diameter": "1 um", "stop": {"count": 9}}
    with pytest.raises(CaseError, match='"box"'):
        tune(validate({"mat": box}, "test"), (Target("solidity", 0.1),))
