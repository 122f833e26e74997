# SPDX-License-Identifier: GPL-3.0-or-later

import pytest

from pipeline.analytics.models.prediction import filter_of_mat, predict
from pipeline.analytics.settings import FlowSettings
from pipeline.design.history import history
from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.mat.settings import Constant, LayeredSettings, Stop


@pytest.fixture(scope="module", name="pile")
def _pile() -> LayeredSettings:
    return LayeredSettings(
        side=5e-5, fiber_diameter=Constant(diameter=1.4e-6), relaxation_slope=0.15, seed=5, stop=Stop(coverage=3)
    )


def test_the_end_of_the_history_is_the_mat(pile: LayeredSettings) -> None:
    mat = generate(pile)
    end, measures = history(mat), measure(mat)
    flow = FlowSettings()
    prediction = predict(filter_of_mat(mat, flow.flow()), flow)
    last = mat.fibers - 1
    for quantity in ("coverage", "solidity", "thickness"):
        assert end.value(quantity, last, flow) == pytest.approx(getattr(measures, quantity), rel=1e-12)
    assert end.value("pressure_drop", last, flow) == pytest.approx(prediction.pressure_drop["davies"], rel=1e-12)
    assert end.value("efficiency", last, flow) == pytest.approx(prediction.efficiency["total"], rel=1e-12)


def test_a_mat_that_stops_earlier_is_the_beginning_of_the_history(pile: LayeredSettings) -> None:
    whole = history(generate(pile))
    early = measure(generate(pile.model_copy(update={"stop": Stop(coverage=1.3)})))
    fiber = whole.until(1.3)
    assert fiber + 1 == early.fibers
    assert whole.thickness[fiber] == pytest.approx(early.thickness, rel=1e-12)
    assert whole.solidity[fiber] == pytest.approx(early.solidity, rel=1e-12)
