"""Center lines of a larger medium, cut where they leave a window of it."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.box import Box
from pipeline.geometry.triangles import Floats, Ints


def cut_to(window: Box, nodes: Floats, first: Ints) -> tuple[Floats, Ints, Ints]:
    """Keep the parts of center lines that lie within a box.

    Parameters
    ----------
    window : Box [m]
    nodes : (n, 3) array [m]
    first : (fibers + 1,) int array
        As in `pipeline.nouns.fibers.Mat`.

    Returns
    -------
    nodes : (m, 3) array [m]
        An end that a plane of the box made lies exactly on it.
    first : (pieces + 1,) int array
    fiber : (pieces,) int array
        Fiber that each piece is a part of; one that leaves and comes back has several. What only touches the box is
        left out.

    Examples
    --------
    >>> line = np.array([[-1.0, 0.5, 0.5], [0.5, 0.5, 0.5], [2.0, 0.5, 0.5]])
    >>> cut_to(Box((0, 0, 0), (1, 1, 1)), line, np.array([0, 3]))[0].tolist()
    [[0.0, 0.5, 0.5], [0.5, 0.5, 0.5], [1.0, 0.5, 0.5]]
    """
    starts = np.ones(len(nodes), dtype=bool)
    starts[first[1:] - 1] = False
    segment = np.flatnonzero(starts)
    owner = np.repeat(np.arange(len(first) - 1), np.diff(first) - 1)
    enter, leave, ends = _within(window, nodes[segment], nodes[segment + 1])
    kept = np.flatnonzero(enter < leave)
    enter, leave, owner, segment, ends = enter[kept], leave[kept], owner[kept], segment[kept], ends[kept]
    # a piece goes on where the segment before it was kept up to their common node
    goes_on = np.zeros(len(kept), dtype=bool)
    goes_on[1:] = (segment[1:] == segment[:-1] + 1) & (leave[:-1] == 1.0) & (enter[1:] == 0.0)
    begins = np.flatnonzero(~goes_on)
    stops = np.append(begins, len(kept))[1:]
    pieces = [np.concatenate([ends[a, :1], ends[a:b, 1]]) for a, b in zip(begins, stops, strict=True)]
    count = np.cumsum([0, *(len(piece) for piece in pieces)])
    return np.concatenate([np.empty((0, 3)), *pieces]), count, owner[begins]


def lengths_within(window: Box, start: Floats, end: Floats) -> Floats:
    """Give the length of each segment within a box, (segments,) array [m].

    Examples
    --------
    >>> ends = np.array([[-1.0, 0.5, 0.5]]), np.array([[1.0, 0.5, 0.5]])
    >>> lengths_within(Box((0, 0, 0), (1, 1, 1)), *ends).tolist()
    [1.0]
    """
    enter, leave, _ = _within(window, start, end)
    lengths: Floats = np.maximum(leave - enter, 0.0) * np.linalg.norm(end - start, axis=1)
    return lengths


def _within(window: Box, start: Floats, end: Floats) -> tuple[Floats, Floats, Floats]:
    """Shares of each segment at which it enters and leaves the box (enter >= leave: never), and its ends there."""
    step = end - start
    enter, leave = np.zeros(len(step)), np.ones(len(step))
    ends = np.stack([start, end], axis=1)
    plane: list[Ints] = [np.full(len(step), -1), np.full(len(step), -1)]
    for axis in range(3):
        for k, place in enumerate((window.lower[axis], window.upper[axis])):
            inward = step[:, axis] if k == 0 else -step[:, axis]
            depth = start[:, axis] - place if k == 0 else place - start[:, axis]
            with np.errstate(divide="ignore", invalid="ignore"):
                share = -depth / inward
            into = (inward > 0) & (share > enter)
            out = (inward < 0) & (share < leave)
            enter, leave = np.where(into, share, enter), np.where(out, share, leave)
            plane[0][into], plane[1][out] = 2 * axis + k, 2 * axis + k
            leave[(inward == 0) & (depth < 0)] = -1.0
    for n, share in enumerate((enter, leave)):
        cut = np.flatnonzero(plane[n] >= 0)
        ends[cut, n] = start[cut] + share[cut, None] * step[cut]
        across, upper = plane[n][cut] // 2, plane[n][cut] % 2
        ends[cut, n, across] = np.where(upper == 1, np.array(window.upper)[across], np.array(window.lower)[across])
    # what rounding moves over another plane comes back
    return enter, leave, np.clip(ends, window.lower, window.upper)
