"""What a growing mat is told about itself is what the paper's figures print."""

import pytest

from pipeline.analytics.predictor import predictor
from pipeline.analytics.settings import FlowSettings
from pipeline.errors import CaseError

FIG11 = 0.1117, 68.5e-6, 0.5e-6
FIG12 = 0.1198, 42.3e-6, 0.5e-6


def test_figure_11_stops_at_its_320_pascal() -> None:
    # from the rounded solidity and thickness that the figure prints
    assert predictor("pressure_drop", FlowSettings(face_velocity=0.025))(*FIG11) == pytest.approx(320.0, abs=0.5)


def test_figure_12_stops_at_its_99_97_percent() -> None:
    assert predictor("efficiency", FlowSettings(face_velocity=0.025))(*FIG12) == pytest.approx(0.9997, abs=5e-5)


def test_slip_asks_for_more_fibers_until_the_same_pressure_drop() -> None:
    stuck = predictor("pressure_drop", FlowSettings(pressure_model="kuwabara"))
    slipping = predictor("pressure_drop", FlowSettings(pressure_model="kuwabara_slip"))
    assert slipping(*FIG11) < stuck(*FIG11)


def test_a_stop_that_needs_no_prediction_is_refused() -> None:
    with pytest.raises(CaseError, match="'coverage'"):
        predictor("coverage", FlowSettings())
