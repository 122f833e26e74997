"""Center lines that are cut by a window: nothing outside it, nothing lost, and windows side by side share all."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.box import Box
from pipeline.mat.windows import cut_to, lengths_within

WHOLE = Box((0.1, 0.2, 0.3), (1.1, 0.9, 0.7))


def lines(seed: int, fibers: int = 200) -> tuple[np.ndarray[tuple[int, int], np.dtype[np.float64]], np.ndarray]:
    """Crooked lines of two to six nodes around and through the window."""
    draw = np.random.default_rng(seed)
    counts = draw.integers(2, 7, fibers)
    nodes = draw.uniform(-0.3, 1.5, (counts.sum(), 3))
    return nodes, np.concatenate([[0], np.cumsum(counts)])


def length(nodes: np.ndarray, first: np.ndarray) -> float:
    steps = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    steps[first[1:-1] - 1] = 0.0
    return float(steps.sum())


@pytest.mark.parametrize("seed", range(5))
def test_no_node_lies_outside_even_by_rounding(seed: int) -> None:
    # lines that graze an edge of the window, where one plane's cut is rounded over the other
    draw = np.random.default_rng(seed)
    low, high = np.array(WHOLE.lower), np.array(WHOLE.upper)
    place = np.where(draw.random((2000, 3)) < 0.5, low, high)
    place[:, 2] = draw.uniform(low[2], high[2], 2000)
    step = draw.normal(size=(2000, 3))
    nodes = np.stack([place - step, place + draw.uniform(0.1, 1.0, (2000, 1)) * step], axis=1).reshape(-1, 3)
    nodes, first, fiber = cut_to(WHOLE, nodes, 2 * np.arange(2001))
    assert len(fiber) == len(first) - 1 > 500
    assert (nodes >= WHOLE.lower).all()
    assert (nodes <= WHOLE.upper).all()


@pytest.mark.parametrize("seed", range(5))
def test_windows_side_by_side_hold_what_their_union_holds(seed: int) -> None:
    nodes, first = lines(seed)
    middle = 0.55
    left = Box(WHOLE.lower, (middle, *WHOLE.upper[1:]))
    right = Box((middle, *WHOLE.lower[1:]), WHOLE.upper)
    whole, one, other = (length(*cut_to(box, nodes, first)[:2]) for box in (WHOLE, left, right))
    assert one + other == pytest.approx(whole, rel=1e-12)
    # and the sums that need no cut lines agree
    starts = np.setdiff1d(np.arange(len(nodes)), first[1:] - 1)
    assert lengths_within(WHOLE, nodes[starts], nodes[starts + 1]).sum() == pytest.approx(whole, rel=1e-12)


def test_a_window_around_all_changes_nothing_and_one_beside_all_holds_nothing() -> None:
    nodes, first = lines(7)
    same, whole, fiber = cut_to(Box((-1.0,) * 3, (2.0,) * 3), nodes, first)
    assert np.array_equal(same, nodes)
    assert np.array_equal(whole, first)
    assert np.array_equal(fiber, np.arange(200))
    empty, none, of = cut_to(Box((3.0,) * 3, (4.0,) * 3), nodes, first)
    assert (len(empty), none.tolist(), len(of)) == (0, [0], 0)
    empty, none, of = cut_to(WHOLE, np.empty((0, 3)), np.array([0]))
    assert (len(empty), none.tolist(), len(of)) == (0, [0], 0)
