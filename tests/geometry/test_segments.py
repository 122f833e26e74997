"""Segment distances against closed forms and an independent minimizer; pairs against all pairs."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from pipeline.geometry.segments import near_pairs, segment_distance
from pipeline.geometry.triangles import Floats

X, Y, Z = np.eye(3)
O = np.zeros(3)  # noqa: E741


@pytest.mark.parametrize(
    ("a", "b", "c", "d", "expected"),
    [
        (O, X, 0.5 * X - Y + Z, 0.5 * X + Y + Z, 1.0),  # skew, crossing in plan
        (O, X, Y, X + Y, 1.0),  # side by side
        (O, X, 2 * X, 3 * X, 1.0),  # one after the other on one line
        (O, X, 0.5 * X, 2 * X, 0.0),  # overlapping on one line
        (O, X, 2 * X + Y, 2 * X + 2 * Y, 2**0.5),  # end to end
        (O, X, 0.5 * X + Y, 0.5 * X + 3 * Y, 1.0),  # end to inside
        (O, O, X, X, 1.0),  # two points
        (O, O, X - Y, X + Y, 1.0),  # a point and a segment
        (O, X, 0.5 * X - Y, 0.5 * X + Y, 0.0),  # meeting
    ],
)
def test_distances_of_plain_pairs(a: Floats, b: Floats, c: Floats, d: Floats, expected: float) -> None:
    assert segment_distance(a, b, c, d) == pytest.approx(expected, abs=1e-15)
    assert segment_distance(d, c, a, b) == pytest.approx(expected, abs=1e-15)


coordinate = st.floats(-1, 1).map(lambda value: round(value, 6))
point = st.tuples(coordinate, coordinate, coordinate).map(np.array)


@given(point, point, point, point)
@settings(deadline=None)  # the first call compiles
def test_distance_is_that_of_a_bounded_least_squares_solver(a: Floats, b: Floats, c: Floats, d: Floats) -> None:
    found = lsq_linear(np.column_stack([b - a, c - d]), c - a, bounds=(0, 1), method="bvls")
    assert segment_distance(a, b, c, d) == pytest.approx((2 * found.cost) ** 0.5, abs=1e-7)


@given(st.floats(1e-12, 1e-2))
@settings(deadline=None)
def test_nearly_parallel_segments_that_cross_keep_their_gap(tilt: float) -> None:
    # they cross in plan in their middles, one above the other
    c, d = np.array([0.0, -tilt, 0.3]), np.array([100.0, tilt, 0.3])
    assert segment_distance(O, 100 * X, c, d) == pytest.approx(0.3, rel=1e-12)


@pytest.mark.parametrize("longest", [0.02, 0.3, 3.0])
def test_the_grid_finds_the_pairs_that_comparing_all_finds(longest: float) -> None:
    rng = np.random.default_rng(5)
    start = rng.random((120, 3)) * (1, 1, 0.2)
    end = start + rng.normal(size=(120, 3)) * longest
    reach = rng.uniform(0, 0.05, 120)
    body = rng.integers(0, 60, 120)
    found = near_pairs(start, end, reach, body)
    expected = [
        (i, j)
        for i in range(120)
        for j in range(i + 1, 120)
        if body[i] != body[j] and segment_distance(start[i], end[i], start[j], end[j]) < reach[i] + reach[j]
    ]
    assert len(expected) > 5
    assert list(zip(found.first.tolist(), found.second.tolist(), strict=True)) == expected


def test_only_pairs_with_an_active_segment_are_looked_for() -> None:
    start = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 2.0]])
    found = near_pairs(start, start + X, np.full(3, 0.6), np.arange(3), active=1)
    assert list(zip(found.first.tolist(), found.second.tolist(), strict=True)) == [(0, 1)]
