"""The height of a fiber along its chord: the upper envelope of the tents it hangs from (method, section 1).

A tent is a fiber that rests on one point and falls from there with the relaxation slope on both sides.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats, Ints

_SAME = 1e-9
"""Heights and distances closer than this, in fiber radii, count as one: no segment comes out shorter."""


@compiled
def profile(x: Floats, h: Floats, slope: float, floor: float, length: float) -> Floats:
    """Lay a fiber over supports, bending no steeper than `slope` and never below `floor`.

    Parameters
    ----------
    x, h : (supports,) array [m]
        Place along the chord, within 0 to `length`, and least height there of the fiber's axis.
    slope : float [-]
        Relaxation slope, 0 or more; 0 keeps the fiber level.
    floor : float [m]
        Height of the axis on the ground: the fiber's radius, above 0.
    length : float [m]
        Length of the chord.

    Returns
    -------
    (nodes, 2) array [m]
        Place along the chord, from exactly 0 to exactly `length`, and height of each vertex.

    Examples
    --------
    >>> profile(np.array([50.0]), np.array([1.5]), 0.15, 0.5, 100.0).round(3).tolist()
    [[0.0, 0.5], [43.333, 0.5], [50.0, 1.5], [56.667, 0.5], [100.0, 0.5]]
    """
    same = _SAME * floor
    if slope == 0.0 or len(x) == 0:
        top = floor
        for height in h:
            top = max(top, height)
        return np.array([[0.0, top], [length, top]])
    kept = _uncovered(x, h, slope, floor + same, same)
    nodes = np.empty((3 * len(kept) + 2, 2))
    count = 0
    if len(kept) == 0:
        nodes[0, 0], nodes[0, 1] = 0.0, floor
        nodes[1, 0], nodes[1, 1] = length, floor
        return nodes[:2]

    first, last = kept[0], kept[-1]
    start = h[first] - slope * x[first]
    if x[first] > same:
        nodes[count, 0], nodes[count, 1] = 0.0, max(start, floor)
        count += 1
        ground = x[first] - (h[first] - floor) / slope
        if ground > same:
            nodes[count, 0], nodes[count, 1] = ground, floor
            count += 1
        nodes[count, 0], nodes[count, 1] = x[first], h[first]
    else:
        nodes[count, 0], nodes[count, 1] = 0.0, h[first]
    count += 1

    for k in range(1, len(kept)):
        x1, h1, x2, h2 = x[kept[k - 1]], h[kept[k - 1]], x[kept[k]], h[kept[k]]
        valley = 0.5 * (h1 + h2 - slope * (x2 - x1))
        ground1, ground2 = x1 + (h1 - floor) / slope, x2 - (h2 - floor) / slope
        if ground2 - ground1 > same:
            nodes[count, 0], nodes[count, 1] = ground1, floor
            nodes[count + 1, 0], nodes[count + 1, 1] = ground2, floor
            count += 2
        else:
            nodes[count, 0] = 0.5 * (x1 + x2) + 0.5 * (h1 - h2) / slope
            nodes[count, 1] = max(valley, floor)
            count += 1
        nodes[count, 0], nodes[count, 1] = x2, h2
        count += 1

    if x[last] < length - same:
        ground = x[last] + (h[last] - floor) / slope
        if ground < length - same:
            nodes[count, 0], nodes[count, 1] = ground, floor
            count += 1
        nodes[count, 0], nodes[count, 1] = length, max(h[last] - slope * (length - x[last]), floor)
        count += 1
    else:
        nodes[count - 1, 0] = length
    return nodes[:count]


@compiled
def _uncovered(x: Floats, h: Floats, slope: float, floor: float, same: float) -> Ints:
    """List, along the chord, the indices of the supports that stand above every other one's tent."""
    order = np.argsort(x)
    kept = np.empty(len(x), np.int64)
    count = 0
    # a tent hides what is no higher than its falling side: to its right h + slope x, to its left h - slope x
    tallest = -np.inf
    for k in order:
        if h[k] > floor and h[k] + slope * x[k] > tallest + same:
            tallest = h[k] + slope * x[k]
            kept[count] = k
            count += 1
    # backward over the survivors only: over all supports, equal ones would hide each other
    tallest = -np.inf
    free = count
    for place in range(count - 1, -1, -1):
        k = kept[place]
        if h[k] - slope * x[k] > tallest + same:
            tallest = h[k] - slope * x[k]
            free -= 1
            kept[free] = k
    return kept[free:count]
