"""Whether places lie within a closed surface. Compiled by numba: imported only where a mesh is made."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats, Ints

_PER_COLUMN = 4.0  # triangles, about


def crossings_above(points: Floats, triangles: Ints, places: Floats) -> Ints:
    """Count the triangles that a ray from each place along +z meets.

    Parameters
    ----------
    points : (n, 3) array
    triangles : (m, 3) int array
    places : (k, 3) array
        None exactly below an edge: rounding would decide.

    Returns
    -------
    (k,) int array
        Odd within a closed surface, even outside.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> crossings_above(corners, faces, np.array([[0.2, 0.3, 0.1], [0.2, 0.3, -1.0], [0.9, 0.8, 0.1]])).tolist()
    [1, 2, 0]
    """
    if not len(triangles) or not len(places):
        return np.zeros(len(places), np.int64)
    lower, upper = points[triangles].min(axis=(0, 1)), points[triangles].max(axis=(0, 1))
    extent = np.maximum((upper - lower)[:2], 1e-300)
    width = float(np.sqrt(extent.prod() / max(1.0, len(triangles) / _PER_COLUMN)))
    counts = np.clip(np.ceil(extent / width), 1, 4096).astype(np.int64)
    found: Ints = _count(points, triangles, places, lower[:2], extent / counts, counts)
    return found


@compiled
def _count(points: Floats, triangles: Ints, places: Floats, lower: Floats, width: Floats, counts: Ints) -> Ints:
    # the triangles over each column of a grid across z
    first = np.zeros(counts[0] * counts[1] + 1, np.int64)
    following = first[:-1].copy()
    members = np.empty(0, np.int64)
    for filling in range(2):
        for t in range(len(triangles)):
            low, high = np.empty(2, np.int64), np.empty(2, np.int64)
            for axis in range(2):
                a, b, c = points[triangles[t, 0], axis], points[triangles[t, 1], axis], points[triangles[t, 2], axis]
                last = counts[axis] - 1
                low[axis] = min(max(int((min(a, b, c) - lower[axis]) / width[axis]), 0), last)
                high[axis] = min(max(int((max(a, b, c) - lower[axis]) / width[axis]), 0), last)
            for i in range(low[0], high[0] + 1):
                for j in range(low[1], high[1] + 1):
                    if filling:
                        members[following[i * counts[1] + j]] = t
                        following[i * counts[1] + j] += 1
                    else:
                        first[i * counts[1] + j + 1] += 1
        if not filling:
            first = np.cumsum(first)
            following = first[:-1].copy()
            members = np.empty(first[-1], np.int64)
    result = np.zeros(len(places), np.int64)
    for n in range(len(places)):
        x, y, z = places[n]
        i, j = int((x - lower[0]) // width[0]), int((y - lower[1]) // width[1])
        if i < 0 or j < 0 or i >= counts[0] or j >= counts[1]:
            continue
        for m in range(first[i * counts[1] + j], first[i * counts[1] + j + 1]):
            a, b, c = (
                points[triangles[members[m], 0]],
                points[triangles[members[m], 1]],
                points[triangles[members[m], 2]],
            )
            one = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
            two = (c[0] - b[0]) * (y - b[1]) - (c[1] - b[1]) * (x - b[0])
            three = (a[0] - c[0]) * (y - c[1]) - (a[1] - c[1]) * (x - c[0])
            total = one + two + three
            if total == 0.0 or min(one, two, three) * max(one, two, three) < 0.0:
                continue
            if (two * a[2] + three * b[2] + one * c[2]) / total > z:
                result[n] += 1
    return result
