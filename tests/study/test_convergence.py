"""Observed order, extrapolation and the grid convergence index, on answers whose law is known."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.study.convergence import convergence


@given(
    order=st.floats(0.6, 3.5),
    ratios=st.tuples(st.floats(1.3, 2.0), st.floats(1.3, 2.0)),
    size=st.floats(0.01, 1.0) | st.floats(-1.0, -0.01),
)
def test_a_power_law_gives_its_order_and_its_limit(order: float, ratios: tuple[float, float], size: float) -> None:
    # the spacings' ratios differ, as they do on meshes whose cells nobody counts beforehand
    spacings = (ratios[0] * ratios[1], ratios[1], 1.0)
    coarse, middle, fine = (10.0 + size * spacing**order for spacing in spacings)
    found = convergence(spacings, (coarse, middle, fine))
    assert found.order == pytest.approx(order, rel=1e-4)
    if order <= 1.79:
        assert found.extrapolated == pytest.approx(10.0, rel=1e-5)
    # held between 0.5 and 2, the index covers the exact answer, with a factor of three or more off the formal order
    if abs(order - 2) > 0.21:
        assert found.index >= abs(fine - 10.0) / fine
        assert not found.asymptotic


def test_at_the_formal_order_the_index_is_the_error_with_a_quarter_of_safety() -> None:
    found = convergence((4.0, 2.0, 1.0), (10.16, 10.04, 10.01))
    assert found.asymptotic
    assert found.index == pytest.approx(1.25 * 0.01 / 10.01, rel=1e-9)


def test_answers_that_swing_have_no_order_and_a_wide_index() -> None:
    found = convergence((4.0, 2.0, 1.0), (9.9, 10.1, 10.0))
    assert math.isnan(found.order)
    # order 0.5 and a factor of 3 on the last change: 3 x 0.01 / (sqrt 2 - 1)
    assert found.index == pytest.approx(3 * 0.01 / (math.sqrt(2) - 1))


def test_equal_answers_leave_nothing_to_extrapolate() -> None:
    found = convergence((4.0, 2.0, 1.0), (9.9, 10.0, 10.0))
    assert (found.extrapolated, found.index) == (10.0, 0.0)


def test_spacings_that_do_not_fall_are_refused() -> None:
    with pytest.raises(ValueError, match="do not fall"):
        convergence((1.0, 2.0, 1.0), (1.0, 2.0, 3.0))


@pytest.mark.parametrize("seed", range(20))
def test_whatever_three_meshes_gave_there_is_a_limit_and_an_index(seed: int) -> None:
    # meshes that hardly differ in their spacing, and answers that hardly differ: no power tells these apart
    rng = np.random.default_rng(seed)
    fine = 0.1
    middle = fine * (1.0 + 10.0 ** rng.uniform(-6, 0))
    coarse = middle * (1.0 + 10.0 ** rng.uniform(-6, 0))
    answers = 1.0 + 10.0 ** rng.uniform(-9, -1, 3) * rng.choice([-1.0, 1.0], 3)
    found = convergence((coarse, middle, fine), (float(answers[0]), float(answers[1]), float(answers[2])))
    assert math.isfinite(found.extrapolated)
    assert 0.0 <= found.index < math.inf
    assert math.isnan(found.order) or 0.0 <= found.order <= 20.0
