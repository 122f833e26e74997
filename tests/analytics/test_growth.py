"""What a growing mat is told about itself is what the paper's figures print."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import pytest

from pipeline.analytics.models.growth import Predictor, predictor
from pipeline.analytics.settings import FlowSettings
from pipeline.errors import CaseError

FIG11 = 0.1117, 68.5e-6, 0.5e-6
FIG12 = 0.1198, 42.3e-6, 0.5e-6
SLOW = FlowSettings(face_velocity=0.025)


@dataclass(frozen=True)
class Stop:
    quantity: str
    model: str | None = None
    particle_diameter: float | None = None


def made(stop: Stop, settings: FlowSettings = SLOW) -> Predictor:
    predict = predictor(stop, settings)
    assert predict is not None
    return predict


def test_figure_11_stops_at_its_320_pascal() -> None:
    # from the rounded solidity and thickness that the figure prints
    assert made(Stop("pressure_drop"))(*FIG11) == pytest.approx(320.0, abs=0.5)


def test_figure_12_stops_at_its_99_97_percent() -> None:
    assert made(Stop("efficiency"))(*FIG12) == pytest.approx(0.9997, abs=5e-5)


def test_the_stop_s_own_model_and_particle_come_before_the_flow_s() -> None:
    flow = FlowSettings(face_velocity=0.025, pressure_model="kuwabara", particle_diameter=150e-9)
    assert made(Stop("pressure_drop", model="davies"), flow)(*FIG11) == made(Stop("pressure_drop"))(*FIG11)
    assert made(Stop("pressure_drop"), flow)(*FIG11) == made(Stop("pressure_drop", model="kuwabara"))(*FIG11)
    assert made(Stop("efficiency", particle_diameter=300e-9), flow)(*FIG12) == made(Stop("efficiency"))(*FIG12)
    assert made(Stop("efficiency"), flow)(*FIG12) < made(Stop("efficiency"))(*FIG12)


def test_slip_asks_for_more_fibers_until_the_same_pressure_drop() -> None:
    slipping = made(Stop("pressure_drop", model="kuwabara_slip"))
    assert slipping(*FIG11) < made(Stop("pressure_drop", model="kuwabara"))(*FIG11)


@pytest.mark.parametrize("quantity", ["coverage", "thickness", "solidity", "count"])
def test_a_stop_that_needs_no_prediction_gets_none(quantity: str) -> None:
    assert predictor(Stop(quantity), SLOW) is None


def test_an_unknown_model_is_refused_before_the_first_fiber() -> None:
    with pytest.raises(CaseError, match="'darcy'"):
        predictor(Stop("pressure_drop", model="darcy"), SLOW)
