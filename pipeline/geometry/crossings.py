"""Where a triangle surface cuts through itself."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
from numba import njit

from pipeline.geometry.triangles import Floats, Ints

ROUNDING = 1e-10
"""Depth of a cut, in extents of the surface, that a union may make by rounding: manifold3d works to 1e-12 of them."""


@njit(cache=True)  # type: ignore[untyped-decorator]
def _volume(a: Floats, b: Floats, c: Floats, d: Floats) -> float:
    x0, x1, x2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    y0, y1, y2 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    z0, z1, z2 = d[0] - a[0], d[1] - a[1], d[2] - a[2]
    return float(x0 * (y1 * z2 - y2 * z1) + x1 * (y2 * z0 - y0 * z2) + x2 * (y0 * z1 - y1 * z0))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _pierces(p: Floats, q: Floats, a: Floats, b: Floats, c: Floats, depth: float) -> bool:
    """Whether the segment from p to q goes through the inside of the triangle; touching does not count."""
    if _volume(a, b, c, p) * _volume(a, b, c, q) >= 0.0:
        return False
    one, two, three = _volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)
    if not ((one > 0.0 and two > 0.0 and three > 0.0) or (one < 0.0 and two < 0.0 and three < 0.0)):
        return False
    if depth == 0.0:
        return True
    ab, bc, ca, pq = _length(a, b), _length(b, c), _length(c, a), _length(p, q)
    # each product divided by these lengths is no more than the distance that it stands for
    least = depth * ab * ca
    if min(abs(_volume(a, b, c, p)), abs(_volume(a, b, c, q))) <= least:
        return False
    return bool(abs(one) > depth * pq * ab and abs(two) > depth * pq * bc and abs(three) > depth * pq * ca)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _length(a: Floats, b: Floats) -> float:
    return float(np.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2))


@njit(cache=True)  # type: ignore[untyped-decorator]
def cross(points: Floats, one: Ints, two: Ints, depth: float = 0.0) -> bool:
    """Whether two triangles cut each other, deeper than `depth`, away from the corners that they share.

    Triangles that share an edge do not count, nor do those that only touch.
    """
    shared = 0
    for j in range(3):
        for k in range(3):
            shared += one[j] == two[k]
    if shared >= 2:
        return False
    for _turn in range(2):
        for k in range(3):
            p, q = one[k], one[(k + 1) % 3]
            meets = False
            for j in range(3):
                meets = meets or two[j] == p or two[j] == q
            if not meets and _pierces(points[p], points[q], points[two[0]], points[two[1]], points[two[2]], depth):
                return True
        one, two = two, one
    return False


@njit(cache=True)  # type: ignore[untyped-decorator]
def bins(points: Floats, triangles: Ints, size: float, pad: float) -> tuple[Floats, Ints, Ints, Ints]:
    """Sort triangles into cubes that their boxes, widened by `pad`, meet.

    Returns
    -------
    low : (3,) array
        Corner of the first cube.
    shape : (3,) int array
        Number of cubes along each axis.
    first : (cubes + 1,) int array
        Cube c holds ``member[first[c]:first[c + 1]]``.
    member : (k,) int array
        Triangles.
    """
    low, high = np.empty(3), np.empty(3)
    for axis in range(3):
        low[axis] = points[:, axis].min() - 2.0 * pad
        high[axis] = points[:, axis].max() + 2.0 * pad
    shape = ((high - low) / size).astype(np.int64) + 1
    first = np.zeros(shape[0] * shape[1] * shape[2] + 1, dtype=np.int64)
    member = np.empty(0, dtype=np.int64)
    place = first
    for sweep in range(2):
        if sweep == 1:
            first = np.cumsum(first)
            member = np.empty(first[-1], dtype=np.int64)
            place = first.copy()
        for t in range(len(triangles)):
            begin, end = cells_of(points, triangles[t], low, size, pad)
            for x in range(begin[0], end[0] + 1):
                for y in range(begin[1], end[1] + 1):
                    for z in range(begin[2], end[2] + 1):
                        cube = (x * shape[1] + y) * shape[2] + z
                        if sweep == 0:
                            first[cube + 1] += 1
                        else:
                            member[place[cube]] = t
                            place[cube] += 1
    return low, shape, first, member


@njit(cache=True)  # type: ignore[untyped-decorator]
def cells_of(points: Floats, corner: Ints, low: Floats, size: float, pad: float) -> tuple[Ints, Ints]:
    """First and last cube along each axis that a triangle's widened box meets."""
    begin, end = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for axis in range(3):
        a, b, c = points[corner[0], axis], points[corner[1], axis], points[corner[2], axis]
        begin[axis] = int((min(a, b, c) - pad - low[axis]) / size)
        end[axis] = int((max(a, b, c) + pad - low[axis]) / size)
    return begin, end


@njit(cache=True)  # type: ignore[untyped-decorator]
def crosses_any(
    points: Floats,
    triangles: Ints,
    corner: Ints,
    skip: Ints,
    low: Floats,
    shape: Ints,
    first: Ints,
    member: Ints,
    size: float,
) -> bool:
    """Whether a triangle cuts one of the sorted ones, except those that have a corner in `skip`."""
    begin, end = cells_of(points, corner, low, size, 0.0)
    for x in range(begin[0], end[0] + 1):
        for y in range(begin[1], end[1] + 1):
            for z in range(begin[2], end[2] + 1):
                cube = (x * shape[1] + y) * shape[2] + z
                for k in range(first[cube], first[cube + 1]):
                    other = triangles[member[k]]
                    skipped = False
                    for point in skip:
                        skipped = skipped or other[0] == point or other[1] == point or other[2] == point
                    if not skipped and cross(points, corner, other):
                        return True
    return False


@njit(cache=True)  # type: ignore[untyped-decorator]
def _one_side(points: Floats, one: Ints, two: Ints) -> bool:
    """Whether all corners of a triangle lie on one side of the other's plane, or on it."""
    a, b, c = points[two[0]], points[two[1]], points[two[2]]
    first = _volume(a, b, c, points[one[0]])
    second = _volume(a, b, c, points[one[1]])
    third = _volume(a, b, c, points[one[2]])
    return bool(min(first, second, third) >= 0.0 or max(first, second, third) <= 0.0)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _pairs(points: Floats, triangles: Ints, size: float, depth: float) -> Ints:
    low, shape, first, member = bins(points, triangles, size, 0.0)
    boxes = np.empty((len(triangles), 2, 3))
    for t in range(len(triangles)):
        for axis in range(3):
            a, b, c = (points[triangles[t, 0], axis], points[triangles[t, 1], axis], points[triangles[t, 2], axis])
            boxes[t, 0, axis], boxes[t, 1, axis] = min(a, b, c), max(a, b, c)
    seen = np.full(len(triangles), -1)
    found = np.empty((64, 2), dtype=np.int64)
    count = 0
    for t in range(len(triangles)):
        begin, end = cells_of(points, triangles[t], low, size, 0.0)
        for x in range(begin[0], end[0] + 1):
            for y in range(begin[1], end[1] + 1):
                for z in range(begin[2], end[2] + 1):
                    cube = (x * shape[1] + y) * shape[2] + z
                    # members of a cube ascend: each pair is met once, from its greater triangle
                    for k in range(first[cube], first[cube + 1]):
                        other = member[k]
                        if other >= t:
                            break
                        if seen[other] == t:
                            continue
                        seen[other] = t
                        apart = False
                        for axis in range(3):
                            apart = apart or boxes[t, 0, axis] > boxes[other, 1, axis]
                            apart = apart or boxes[other, 0, axis] > boxes[t, 1, axis]
                        if apart or _one_side(points, triangles[t], triangles[other]):
                            continue
                        if _one_side(points, triangles[other], triangles[t]):
                            continue
                        if cross(points, triangles[t], triangles[other], depth):
                            if count == len(found):
                                found = np.concatenate((found, np.empty_like(found)))
                            found[count, 0], found[count, 1] = other, t
                            count += 1
    return found[:count]


def crossing_pairs(points: Floats, triangles: Ints) -> Ints:
    """Find the pairs of triangles that cut through each other.

    An edge that goes through the inside of a triangle counts; touching does not, nor do triangles that share an edge,
    nor cuts less deep than `ROUNDING` of the surface's extent.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array

    Returns
    -------
    (k, 2) int array
        Two different triangles each, the lesser first; each pair once.

    Examples
    --------
    >>> flat = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.2, -1], [0.2, 0.2, 1], [0.3, 5, 0.0]])
    >>> crossing_pairs(flat, np.array([[0, 1, 2], [3, 4, 5]])).tolist()
    [[0, 1]]
    """
    # triple products of micrometers are 1e-18: no harm, but cubes as large as a usual triangle
    edge = float(np.median(np.linalg.norm(points[triangles[:, 0]] - points[triangles[:, 1]], axis=1)))
    longest = float(np.ptp(points, axis=0).max())
    size = max(edge, longest / 200.0)
    pairs: Ints = _pairs(np.ascontiguousarray(points), np.ascontiguousarray(triangles), size, ROUNDING * longest)
    return pairs


def self_intersections(points: Floats, triangles: Ints) -> Ints:
    """Find the triangles that cut through another one, as `crossing_pairs` sees them; their indices, (k,) int array."""
    return np.unique(crossing_pairs(points, triangles))
