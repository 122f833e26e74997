"""Every stop ends a mat where it says, and the mats of Figs. 11 to 13 are the paper's."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import Any

import numpy as np
import pytest

from pipeline.analytics.models.growth import predictor
from pipeline.analytics.settings import FlowSettings
from pipeline.errors import CaseError
from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.mat.settings import BoxSettings, LayeredSettings, Stop
from pipeline.mat.sums import report_stop
from pipeline.nouns.mat_measures import MatMeasures

SLOW = FlowSettings(face_velocity=0.025, preset="paper", pressure_model="davies")
"""The air of Figs. 10 to 13."""


def grown(stop: dict[str, Any], seed: int = 0, flow: FlowSettings = SLOW, **changes: Any) -> MatMeasures:
    """A mat of 0.5 um fibers in a box of 20 um."""
    asked: dict[str, Any] = {"side": 20e-6, "fiber_diameter": 0.5e-6, "relaxation_slope": 0.15, "seed": seed}
    settings = LayeredSettings.model_validate(asked | changes | {"stop": stop})
    return measure(generate(settings, predictor(settings.stop, flow)))


def agrees(values: list[float], mean: float, spread: float) -> bool:
    """Whether the mean over K seeds lies within 4 standard errors of the mean over 200."""
    return abs(float(np.mean(values)) - mean) <= 4 * spread * math.sqrt(1 / len(values) + 1 / 200)


def test_mats_grown_to_320_pascal_are_those_of_figure_11() -> None:
    mats = [grown({"pressure_drop": 320.0}, seed) for seed in range(30)]
    assert agrees([m.fibers for m in mats], 872, 21)
    assert agrees([m.segments for m in mats], 5508, 70)
    assert agrees([m.thickness * 1e6 for m in mats], 65.7, 3.6)
    assert agrees([m.solidity * 100 for m in mats], 11.46, 0.36)
    assert agrees([m.coverage for m in mats], 18.95, 0.43)


def test_mats_grown_to_hepa_efficiency_are_those_of_figure_12() -> None:
    mats = [grown({"efficiency": 0.9997, "particle_diameter": 300e-9}, seed) for seed in range(30)]
    assert agrees([m.fibers for m in mats], 605, 16)
    assert agrees([m.segments for m in mats], 3827, 60)
    assert agrees([m.thickness * 1e6 for m in mats], 45.9, 2.8)
    assert agrees([m.solidity * 100 for m in mats], 11.41, 0.43)
    pressure = predictor(Stop(pressure_drop=1.0), SLOW)
    assert pressure is not None
    assert agrees([pressure(m.solidity, m.thickness, 0.5e-6) for m in mats], 221.6, 1.1)


@pytest.mark.parametrize(
    ("diameter", "count", "solidity", "spread", "efficiency", "its_spread"),
    [(0.2e-6, 460, 9.02, 0.42, 99.63, 0.04), (0.8e-6, 116, 12.35, 0.98, 75.9, 1.4)],
)
def test_the_ends_of_figure_13_are_the_papers(
    diameter: float, count: float, solidity: float, spread: float, efficiency: float, its_spread: float
) -> None:
    predict = predictor(Stop(efficiency=0.5, particle_diameter=300e-9), SLOW)
    assert predict is not None
    mats = [grown({"coverage": 4}, seed, fiber_diameter=diameter) for seed in range(30)]
    # the count of chords for a coverage spreads by about 0.32 sqrt(N)
    assert agrees([m.fibers for m in mats], count, 0.32 * math.sqrt(count))
    assert agrees([m.solidity * 100 for m in mats], solidity, spread)
    reached = [100 * predict(m.solidity, m.thickness, diameter) for m in mats]
    assert agrees(reached, efficiency, its_spread)


@pytest.mark.parametrize(
    "stop",
    [
        {"coverage": 2.0},
        {"thickness": 8e-6},
        {"solidity": 0.02},
        {"count": 50},
        {"pressure_drop": 40.0},
        {"pressure_drop": 40.0, "model": "kuwabara"},
        {"efficiency": 0.6, "particle_diameter": 100e-9},
    ],
)
def test_the_last_fiber_and_no_earlier_one_reaches_the_stop(stop: dict[str, Any]) -> None:
    settings = Stop.model_validate(stop)
    predict = predictor(settings, SLOW)
    mat = grown(stop)
    report = report_stop(settings, mat, predict)
    assert report.reached == pytest.approx(report.target + report.overshoot)
    assert report.overshoot >= -1e-12 * report.target
    if mat.fibers > 1:
        # the same seed draws the same fibers: one less is short of the target
        assert report_stop(settings, grown({"count": mat.fibers - 1}), predict).reached < report.target


def test_a_stop_of_a_box_counts_all_fibers_in_its_slab() -> None:
    box = BoxSettings.model_validate(
        {"side": 20e-6, "thickness": 5e-6, "fiber_diameter": 0.5e-6, "stop": {"solidity": 0.1}}
    )
    mat = generate(box)
    assert mat.thickness == 5e-6
    one = math.pi * 0.25e-6**2 * math.hypot(math.sqrt(2) * 20e-6, 5e-6) / (20e-6**2 * 5e-6)
    assert 0.1 <= measure(mat).solidity < 0.1 + one


def test_a_stop_out_of_reach_says_how_far_the_mat_came() -> None:
    with pytest.raises(
        CaseError, match=r"mat.stop.solidity = 0.5 is not reached by mat.max_fibers = 100 fibers.*solid"
    ):
        grown({"solidity": 0.5}, max_fibers=100)


def test_a_predicted_stop_without_a_model_is_a_bug() -> None:
    settings = LayeredSettings.model_validate(
        {"side": 20e-6, "fiber_diameter": 1e-6, "relaxation_slope": 0.1, "stop": {"pressure_drop": 10.0}}
    )
    with pytest.raises(ValueError, match="needs a model"):
        generate(settings)
