"""The hand-checked polylines of the method, and laws of the upper envelope."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.geometry.triangles import Floats
from pipeline.mat.profile import profile


def laid(x: list[float], h: list[float], slope: float = 0.15) -> Floats:
    """A fiber of diameter 1 over a chord of 100."""
    return profile(np.array(x, dtype=float), np.array(h, dtype=float), slope, 0.5, 100.0)


def test_one_support_makes_one_tent() -> None:
    # from 1.5 down to 0.5 at slope 0.15 takes 6.667 on both sides
    expected = [(0, 0.5), (50 - 1 / 0.15, 0.5), (50, 1.5), (50 + 1 / 0.15, 0.5), (100, 0.5)]
    assert laid([50], [1.5]) == pytest.approx(np.array(expected))


def test_two_supports_meet_in_a_valley() -> None:
    expected = [(0, 0.5), (26.6667, 0.5), (40, 2.5), (48.3333, 1.25), (60, 3), (76.6667, 0.5), (100, 0.5)]
    assert laid([40, 60], [2.5, 3]) == pytest.approx(np.array(expected), abs=1e-4)


def test_supports_under_the_tents_of_others_are_left_out() -> None:
    # the eight supports of the method: 5, 30, 70 and 92 carry the fiber, in eight segments
    nodes = laid([5, 12, 30, 35, 42, 55, 70, 92], [4.6, 3.2, 8, 6, 4.5, 4.2, 6.5, 3.9])
    assert len(nodes) - 1 == 8
    assert {5, 30, 70, 92} <= set(nodes[:, 0].tolist())
    assert nodes[0, 1] == pytest.approx(3.85)
    assert nodes[-1, 1] == pytest.approx(2.70)


def test_a_stiff_fiber_lies_level_on_the_highest_support() -> None:
    assert laid([20, 50, 70], [2, 4, 3], slope=0.0).tolist() == [[0, 4], [100, 4]]


def test_a_fiber_without_supports_lies_on_the_ground() -> None:
    assert laid([], []).tolist() == [[0, 0.5], [100, 0.5]]


def test_equal_supports_do_not_hide_each_other() -> None:
    # both lie exactly on each other's tent: with <= in both passes over all of them, none would be left
    nodes = laid([40, 50], [2.5, 1.0])
    assert nodes[:, 1].max() == 2.5
    assert laid([50, 50], [2, 2]) == pytest.approx(laid([50], [2]))


supports = st.lists(st.tuples(st.floats(0, 100), st.floats(0, 30)), max_size=40)


@given(supports, st.floats(0, 1))
@settings(deadline=None)  # the first call compiles
def test_the_profile_is_the_least_one_above_all_supports(points: list[tuple[float, float]], slope: float) -> None:
    x, h = (np.array([p[k] for p in points], dtype=float) for k in (0, 1))
    nodes = profile(x, h, slope, 0.5, 100.0)
    assert nodes[0, 0] == 0
    assert nodes[-1, 0] == 100
    steps = np.diff(nodes, axis=0)
    assert (steps[:, 0] > 0).all()
    # rounding of places near 100 over steps as short as 1e-9
    assert (np.abs(steps[:, 1]) <= slope * steps[:, 0] + 1e-12).all()
    at = np.linspace(0, 100, 57)
    envelope = np.maximum(0.5, (h - slope * np.abs(at[:, None] - x)).max(axis=1, initial=0.5))
    assert np.interp(at, nodes[:, 0], nodes[:, 1]) == pytest.approx(envelope, abs=1e-8)
