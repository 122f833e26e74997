"""Distances between straight segments in space, and all the pairs that come near each other."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import NamedTuple

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats, Ints


class NearPairs(NamedTuple):
    """Pairs of segments, ``first < second`` wherever both may come first, and their distances [m]."""

    first: Ints
    second: Ints
    distance: Floats


@compiled
def segment_distance(a: Floats, b: Floats, c: Floats, d: Floats) -> float:
    """Give the distance between the segments a-b and c-d.

    The least of the four distances from an end to the other segment and, where the common perpendicular meets
    both, of the distance along it. Exact to rounding, for parallel segments too.

    Parameters
    ----------
    a, b, c, d : (3,) array [m]
        Ends; a segment may be a point.

    Returns
    -------
    float [m]

    Examples
    --------
    >>> x, y, z = np.eye(3)
    >>> float(segment_distance(0 * x, x, 0.5 * x + y - z, 0.5 * x + y + z))
    1.0
    """
    u0, u1, u2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    v0, v1, v2 = d[0] - c[0], d[1] - c[1], d[2] - c[2]
    w0, w1, w2 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    best = min(
        min(_to_point(u0, u1, u2, w0, w1, w2), _to_point(u0, u1, u2, w0 + v0, w1 + v1, w2 + v2)),
        min(_to_point(v0, v1, v2, -w0, -w1, -w2), _to_point(v0, v1, v2, u0 - w0, u1 - w1, u2 - w2)),
    )
    # the point of a-b at which the common perpendicular n stands; the nearest point of c-d is found from it, which
    # keeps rounding out of the distance where the two run nearly parallel
    n0, n1, n2 = u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0
    nn = n0 * n0 + n1 * n1 + n2 * n2
    if nn > 0.0:
        s = ((w1 * v2 - w2 * v1) * n0 + (w2 * v0 - w0 * v2) * n1 + (w0 * v1 - w1 * v0) * n2) / nn
        if 0.0 < s < 1.0:
            best = min(best, _to_point(v0, v1, v2, s * u0 - w0, s * u1 - w1, s * u2 - w2))
    distance = float(np.sqrt(best))
    return distance


@compiled
def _to_point(u0: float, u1: float, u2: float, p0: float, p1: float, p2: float) -> float:
    """Squared distance from the point p to the segment from the origin to u."""
    uu = u0 * u0 + u1 * u1 + u2 * u2
    share = 0.0
    if uu > 0.0:
        share = min(max((p0 * u0 + p1 * u1 + p2 * u2) / uu, 0.0), 1.0)
    g0, g1, g2 = p0 - share * u0, p1 - share * u1, p2 - share * u2
    squared = g0 * g0 + g1 * g1 + g2 * g2
    return squared


def near_pairs(start: Floats, end: Floats, reach: Floats, body: Ints, active: int | None = None) -> NearPairs:
    """Find all pairs of segments of different bodies that come closer than the sum of their reaches.

    The segments are sorted into a grid of cubes, cut into pieces no longer than a cube, so that the work grows with
    the number of segments and of near pairs.

    Parameters
    ----------
    start, end : (n, 3) array [m]
    reach : (n,) array [m]
        0 or more.
    body : (n,) int array
        Segments of one body are not compared.
    active : int, optional
        Only pairs with at least one of the first `active` segments are looked for, all unless given.

    Returns
    -------
    NearPairs
        Each pair once, sorted.

    Examples
    --------
    >>> start = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 9.0]])
    >>> near_pairs(start, start + [1.0, 0, 0], np.full(3, 0.6), np.arange(3)).second.tolist()
    [1]
    """
    count = len(start)
    active = count if active is None else active
    if count == 0:
        return NearPairs(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))
    origin = np.minimum(start, end).min(axis=0)
    extent = np.maximum(start, end).max(axis=0) - origin
    size = _cube(start, end, reach, extent)
    shape = np.maximum(np.ceil(extent / size).astype(np.int64), 1)
    first, second, distance = _search(start - origin, end - origin, reach, body, active, size, shape)
    order = np.lexsort((second, first))
    return NearPairs(first[order], second[order], distance[order])


def _cube(start: Floats, end: Floats, reach: Floats, extent: Floats) -> float:
    """Edge of the grid's cubes: as long as a segment where these are short, or a few reaches."""
    lengths = np.linalg.norm(end - start, axis=1)
    size = max(2.0 * float(reach.mean()), float(np.median(lengths)))
    # no more than about eight cubes per segment
    volume = float(np.prod(np.maximum(extent, size)))
    return float(max(size, (volume / (8.0 * len(start) + 64.0)) ** (1.0 / 3.0)))


@compiled
def _search(
    start: Floats, end: Floats, reach: Floats, body: Ints, active: int, size: float, shape: Ints
) -> tuple[Ints, Ints, Floats]:
    # the cubes of each segment, as linked lists
    head = np.full(shape[0] * shape[1] * shape[2], -1)
    following = np.empty(len(start) * 4 + 16, np.int64)
    member = np.empty(len(start) * 4 + 16, np.int64)
    entries = 0
    widest = reach.max()
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    for k in range(len(start)):
        pieces = _pieces(start[k], end[k], size)
        for piece in range(pieces):
            _cells(start[k], end[k], piece, pieces, 0.0, size, shape, low, high)
            for i in range(low[0], high[0] + 1):
                for j in range(low[1], high[1] + 1):
                    for m in range(low[2], high[2] + 1):
                        cell = (i * shape[1] + j) * shape[2] + m
                        if head[cell] >= 0 and member[head[cell]] == k:
                            continue
                        if entries == len(member):
                            following, member = np.append(following, following), np.append(member, member)
                        following[entries], member[entries] = head[cell], k
                        head[cell] = entries
                        entries += 1

    first, second, distance = np.empty(256, np.int64), np.empty(256, np.int64), np.empty(256)
    found = 0
    seen = np.full(len(start), -1)
    for k in range(active):
        pieces = _pieces(start[k], end[k], size)
        for piece in range(pieces):
            _cells(start[k], end[k], piece, pieces, reach[k] + widest, size, shape, low, high)
            for i in range(low[0], high[0] + 1):
                for j in range(low[1], high[1] + 1):
                    for m in range(low[2], high[2] + 1):
                        entry = head[(i * shape[1] + j) * shape[2] + m]
                        while entry >= 0:
                            other = member[entry]
                            entry = following[entry]
                            # newest first: the others in this cube come before k and have met it already
                            if other <= k:
                                break
                            if seen[other] == k:
                                continue
                            seen[other] = k
                            if body[other] == body[k]:
                                continue
                            allowed = reach[k] + reach[other]
                            if _apart(start[k], end[k], start[other], end[other], allowed):
                                continue
                            gap = segment_distance(start[k], end[k], start[other], end[other])
                            if gap < allowed:
                                if found == len(first):
                                    first, second = np.append(first, first), np.append(second, second)
                                    distance = np.append(distance, distance)
                                first[found], second[found], distance[found] = k, other, gap
                                found += 1
    return first[:found], second[:found], distance[:found]


@compiled
def _pieces(start: Floats, end: Floats, size: float) -> int:
    longest = 0.0
    for axis in range(3):
        longest = max(longest, abs(end[axis] - start[axis]))
    return int(longest / size) + 1


@compiled
def _cells(
    start: Floats,
    end: Floats,
    piece: int,
    pieces: int,
    margin: float,
    size: float,
    shape: Ints,
    low: Ints,
    high: Ints,
) -> None:
    """Put the first and last cube along each axis that a piece, widened by `margin`, may meet into `low`, `high`."""
    for axis in range(3):
        step = (end[axis] - start[axis]) / pieces
        a, b = start[axis] + piece * step, start[axis] + (piece + 1) * step
        # a hair more, for what rounding moves
        hair = margin + 1e-9 * size
        low[axis] = min(max(int(np.floor((min(a, b) - hair) / size)), 0), shape[axis] - 1)
        high[axis] = min(max(int(np.floor((max(a, b) + hair) / size)), 0), shape[axis] - 1)


@compiled
def _apart(a: Floats, b: Floats, c: Floats, d: Floats, allowed: float) -> bool:
    """Whether the boxes around two segments are further apart than `allowed` along some axis."""
    for axis in range(3):
        if min(c[axis], d[axis]) - max(a[axis], b[axis]) > allowed:
            return True
        if min(a[axis], b[axis]) - max(c[axis], d[axis]) > allowed:
            return True
    return False
