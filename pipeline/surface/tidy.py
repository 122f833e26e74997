"""Take away the splinters that a union leaves where surfaces cross: collapse short edges, flip flat triangles.

A mesher inserts every triangle it is given; those a thousand times longer than high cost it most.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from pipeline.geometry.crossings import bins, cells_of, crosses_any
from pipeline.nouns.arrays import Floats, Ints

_SHARPEST_WEDGE = -0.9  # cosine between the normals of neighbors: a wedge of 26 degrees

Bools = npt.NDArray[np.bool_]
Near = tuple[Floats, Ints, Ints, Ints, float]
"""Triangles sorted into cubes, and the cubes' size: see `bins`."""

_MOST_ROUNDS = 40
_LEAST_COSINE = 0.5  # a triangle that turns by more than 60 degrees has folded over


@njit(cache=True)  # type: ignore[untyped-decorator]
def _stars(triangles: Ints, count: int) -> tuple[Ints, Ints]:
    """Triangles at each point: point v has ``around[first[v]:first[v + 1]]``."""
    first = np.zeros(count + 1, dtype=np.int64)
    for t in range(len(triangles)):
        for k in range(3):
            first[triangles[t, k] + 1] += 1
    first = np.cumsum(first)
    place = first[:-1].copy()
    around = np.empty(first[-1], dtype=np.int64)
    for t in range(len(triangles)):
        for k in range(3):
            around[place[triangles[t, k]]] = t
            place[triangles[t, k]] += 1
    return first, around


@njit(cache=True)  # type: ignore[untyped-decorator]
def _normal(a: Floats, b: Floats, c: Floats) -> tuple[Floats, float, float]:
    """Give the unit normal, the height over the longest side, and that side's length."""
    normal = np.cross(b - a, c - a)
    double_area = np.sqrt(normal @ normal)
    longest = np.sqrt(max((b - a) @ (b - a), (c - b) @ (c - b), (a - c) @ (a - c)))
    if double_area > 0:
        normal = normal / double_area
    return normal, double_area / longest if longest > 0 else 0.0, longest


@njit(cache=True)  # type: ignore[untyped-decorator]
def _folds(
    points: Floats, triangles: Ints, first: Ints, around: Ints, corner: Ints, one: int, two: int, gone: int
) -> bool:
    """Whether a new triangle lies nearly back on back with a neighbor: in a wedge that thin they may have swapped.

    Triangles at both points `one` and `two` are about to go; `gone` is about to become `two`.
    """
    normal, _, _ = _normal(points[corner[0]], points[corner[1]], points[corner[2]])
    for j in range(4):
        at = corner[j] if j < 3 else gone
        if at < 0:
            continue
        for k in range(first[at], first[at + 1]):
            other = triangles[around[k]]
            if one in (other[0], other[1], other[2]) and two in (other[0], other[1], other[2]):
                continue
            shared = 0
            moved = np.where(other == gone, two, other)
            for v in moved:
                shared += v in (corner[0], corner[1], corner[2])
            if shared == 2:
                other_normal, _, _ = _normal(points[moved[0]], points[moved[1]], points[moved[2]])
                if normal @ other_normal < _SHARPEST_WEDGE:
                    return True
    return False


@njit(cache=True)  # type: ignore[untyped-decorator]
def _may_collapse(
    points: Floats,
    triangles: Ints,
    first: Ints,
    around: Ints,
    gone: int,
    kept: int,
    sides: Ints,
    least: float,
    near: Near,
) -> bool:
    """Whether moving point `gone` onto `kept` leaves a surface that neither folds nor touches itself."""
    shared = 0
    ring = set()
    for k in range(first[gone], first[gone + 1]):
        for j in range(3):
            ring.add(triangles[around[k], j])
    counted = {gone, kept}
    for k in range(first[kept], first[kept + 1]):
        for j in range(3):
            other = triangles[around[k], j]
            if other in ring and other not in counted:
                counted.add(other)
                shared += 1
    if shared != 2 or first[gone + 1] - first[gone] < 4 or first[kept + 1] - first[kept] < 4:
        return False
    for k in range(first[gone], first[gone + 1]):
        corner = triangles[around[k]]
        if kept in (corner[0], corner[1], corner[2]):
            continue
        old, old_height, _ = _normal(points[corner[0]], points[corner[1]], points[corner[2]])
        moved = np.where(corner == gone, kept, corner)
        if sides[moved[0]] & sides[moved[1]] & sides[moved[2]]:
            return False  # a new piece of the flat cut, which would overlap the others unseen
        new, new_height, _ = _normal(points[moved[0]], points[moved[1]], points[moved[2]])
        if new_height < min(least, old_height) or old @ new < _LEAST_COSINE:
            return False
    skip = np.array([gone])
    for k in range(first[gone], first[gone + 1]):
        corner = triangles[around[k]]
        if kept in (corner[0], corner[1], corner[2]):
            continue
        moved = np.where(corner == gone, kept, corner)
        if crosses_any(points, triangles, moved, skip, near[0], near[1], near[2], near[3], near[4]):
            return False
        if _folds(points, triangles, first, around, moved, gone, kept, gone):
            return False
    return True


@njit(cache=True)  # type: ignore[untyped-decorator]
def _collapse(
    points: Floats,
    triangles: Ints,
    pairs: Ints,
    sides: Ints,
    crease: Ints,
    least: Floats,
    alive: Bools,
    locked: Bools,
    near: Near,
) -> int:
    """Collapse edges, none next to another one that has just gone; give how many.

    Points that are `locked` stay, and what is next to a change becomes so.
    """
    first, around = _stars(triangles, len(points))
    count = 0
    for e in range(len(pairs)):
        for turn in range(2):
            gone, kept = pairs[e, turn], pairs[e, 1 - turn]
            # a point on a side stays, or opposite sides of a periodic mat would not fit; a point on the line where
            # fibers meet stays on that line
            if sides[gone] or crease[gone] > crease[kept] or locked[gone] or locked[kept]:
                continue
            if not _may_collapse(points, triangles, first, around, gone, kept, sides, least[gone], near):
                continue
            for k in range(first[gone], first[gone + 1]):
                t = around[k]
                for j in range(3):
                    locked[triangles[t, j]] = True
                if kept in (triangles[t, 0], triangles[t, 1], triangles[t, 2]):
                    alive[t] = False
                for j in range(3):
                    if triangles[t, j] == gone:
                        triangles[t, j] = kept
            count += 1
            break
    return count


@njit(cache=True)  # type: ignore[untyped-decorator]
def _flip(points: Floats, triangles: Ints, label: Ints, sides: Ints, least: Floats, locked: Bools, near: Near) -> int:
    """Turn the longest side of triangles that have next to no height; give how many. As for `_collapse`."""
    first, around = _stars(triangles, len(points))
    nothing = np.empty(0, dtype=np.int64)
    count = 0
    for t in range(len(triangles)):
        corner = triangles[t].copy()
        _, height, _ = _normal(points[corner[0]], points[corner[1]], points[corner[2]])
        if height >= least[corner[0]] or locked[corner[0]] or locked[corner[1]] or locked[corner[2]]:
            continue
        length = np.empty(3)
        for k in range(3):
            edge = points[corner[(k + 1) % 3]] - points[corner[k]]
            length[k] = edge @ edge
        k = int(np.argmax(length))
        a, b, c = corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]
        other, d = -1, -1
        for i in range(first[b], first[b + 1]):
            for j in range(3):
                if triangles[around[i], j] == b and triangles[around[i], (j + 1) % 3] == a:
                    other, d = around[i], triangles[around[i], (j + 2) % 3]
        if other < 0 or d == c or locked[d]:
            continue
        joined = False
        for i in range(first[c], first[c + 1]):
            if d in (triangles[around[i], 0], triangles[around[i], 1], triangles[around[i], 2]):
                joined = True
        # an edge within a side stays, and no new piece of the flat cut is made
        flat = sides[a] & sides[b] | sides[a] & sides[c] & sides[d] | sides[b] & sides[c] & sides[d]
        if joined or flat:
            continue
        normal, other_height, _ = _normal(points[b], points[a], points[d])
        one, one_height, _ = _normal(points[a], points[d], points[c])
        two, two_height, _ = _normal(points[d], points[b], points[c])
        if min(one_height, two_height) <= min(height, other_height):
            continue
        if one @ normal < _LEAST_COSINE or two @ normal < _LEAST_COSINE:
            continue
        left, right = np.array([a, d, c]), np.array([d, b, c])
        if crosses_any(points, triangles, left, nothing, near[0], near[1], near[2], near[3], near[4]):
            continue
        if crosses_any(points, triangles, right, nothing, near[0], near[1], near[2], near[3], near[4]):
            continue
        if _folds(points, triangles, first, around, left, a, b, -1):
            continue
        if _folds(points, triangles, first, around, right, a, b, -1):
            continue
        triangles[t] = left
        triangles[other] = right
        label[t] = label[other]
        for v in (a, b, c, d):
            locked[v] = True
        count += 1
    return count


def _cube(points: Floats, triangles: Ints, edge: float) -> float:
    """Size of cubes as large as a usual triangle, but no more than about eight of them per triangle."""
    extent = np.maximum(np.ptp(points[triangles[:, 0]], axis=0), edge)
    return max(edge, math.cbrt(float(np.prod(extent)) / (8.0 * len(triangles))))


def _near(points: Floats, triangles: Ints, edge: float, pad: float) -> Near:
    size = _cube(points, triangles, edge)
    return (*bins(points, triangles, size, pad), size)


def tidied(
    points: Floats, triangles: Ints, fiber: Ints, radius: Floats, sides: Ints, tolerance: float
) -> tuple[Floats, Ints, Ints]:
    """Collapse edges shorter than the tolerance and flip triangles a tenth of it high.

    Nothing is done that would fold the surface or make it cut through itself. Each round looks only at what lies near
    the changes of the one before.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        A closed surface.
    fiber : (m,) int array
    radius : (fibers,) array [m]
    sides : (n,) int array
        Bit per side of the plan that a point lies on: such points stay where they are.
    tolerance : float
        In diameters of the thinnest fiber at a point; no point moves farther.

    Returns
    -------
    points, triangles, fiber
        The closed surface that is left.
    """
    edge = float(np.median(np.linalg.norm(points[triangles[:, 0]] - points[triangles[:, 1]], axis=1)))
    done: list[tuple[Ints, Ints]] = []
    fresh, rim = np.ones(len(points), dtype=np.bool_), np.zeros(len(points), dtype=np.bool_)
    for _ in range(_MOST_ROUNDS):
        crease, short, bad = _marks(points, triangles, fiber, radius, sides, tolerance, fresh & ~rim)
        if not bad.any():
            break
        pad = float(short[bad].max())
        inside = _region(points, triangles, bad, _cube(points, triangles, edge), pad)
        done.append((triangles[~inside], fiber[~inside]))
        rim[triangles[~inside]] = True
        triangles, fiber = triangles[inside], fiber[inside]
        near = _near(points, triangles, edge, pad)
        alive = np.ones(len(triangles), dtype=np.bool_)
        fresh = rim.copy()
        pairs = _short_edges(points, triangles, short)
        changed = _collapse(points, triangles, pairs, sides, crease, 0.1 * short, alive, fresh, near)
        triangles, fiber = triangles[alive], fiber[alive]
        if changed:
            near = _near(points, triangles, edge, 0.0)
        turned = rim.copy()
        changed += _flip(points, triangles, fiber, sides, 0.1 * short, turned, near)
        fresh |= turned
        if changed == 0:
            break
    triangles = np.concatenate([triangles, *(part for part, _ in done)])
    fiber = np.concatenate([fiber, *(owner for _, owner in done)])
    used, corner = np.unique(triangles, return_inverse=True)
    return points[used], corner.reshape(triangles.shape), fiber


@njit(cache=True)  # type: ignore[untyped-decorator]
def _marks(
    points: Floats, triangles: Ints, fiber: Ints, radius: Floats, sides: Ints, tolerance: float, fresh: Bools
) -> tuple[Ints, Floats, Bools]:
    """Mark the points.

    Returns
    -------
    crease : (n,) int array
        1 where fibers meet.
    short : (n,) array [m]
        Length that counts as short at each point.
    bad : (n,) bool array
        Ends of short edges that may be collapsed, and corners of triangles without height that may be flipped, each
        with a fresh point at least.
    """
    owner, crease = np.full(len(points), -1), np.zeros(len(points), dtype=np.int64)
    short = np.full(len(points), np.inf)
    for t in range(len(triangles)):
        for k in range(3):
            v = triangles[t, k]
            if owner[v] >= 0 and owner[v] != fiber[t]:
                crease[v] = 1
            owner[v] = fiber[t]
            short[v] = min(short[v], 2.0 * tolerance * radius[fiber[t]])
    bad = np.zeros(len(points), dtype=np.bool_)
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        if not (fresh[a] or fresh[b] or fresh[c]):
            continue
        for p, q in ((a, b), (b, c), (c, a)):
            edge = points[p] - points[q]
            if not (sides[p] and sides[q]) and np.sqrt(edge @ edge) < min(short[p], short[q]):
                bad[p] = True
                bad[q] = True
        _, height, _ = _normal(points[a], points[b], points[c])
        if height < 0.1 * short[a] and not sides[a] & sides[b] & sides[c]:
            bad[a] = True
            bad[b] = True
            bad[c] = True
    return crease, short, bad


def _short_edges(points: Floats, triangles: Ints, short: Floats) -> Ints:
    """Edges, (k, 2), that are short for both of their ends, the shortest first."""
    pairs = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    pairs = pairs[pairs[:, 0] < pairs[:, 1]]
    length = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    chosen = length < np.minimum(short[pairs[:, 0]], short[pairs[:, 1]])
    ordered: Ints = pairs[chosen][np.argsort(length[chosen], kind="stable")]
    return ordered


@njit(cache=True)  # type: ignore[untyped-decorator]
def _region(points: Floats, triangles: Ints, bad: Bools, size: float, pad: float) -> Bools:
    """Find the triangles that may come near what changes when the bad points and their neighbors are treated."""
    for _ring in range(2):
        wider = bad.copy()
        for t in range(len(triangles)):
            if bad[triangles[t, 0]] or bad[triangles[t, 1]] or bad[triangles[t, 2]]:
                for k in range(3):
                    wider[triangles[t, k]] = True
        bad = wider
    low, high = np.empty(3), np.empty(3)
    for axis in range(3):
        low[axis], high[axis] = points[:, axis].min() - 2.0 * pad, points[:, axis].max() + 2.0 * pad
    shape = ((high - low) / size).astype(np.int64) + 1
    cubes = np.zeros((shape[0], shape[1], shape[2]), dtype=np.bool_)
    inside = np.zeros(len(triangles), dtype=np.bool_)
    for sweep in range(2):
        for t in range(len(triangles)):
            if sweep == 0 and not (bad[triangles[t, 0]] or bad[triangles[t, 1]] or bad[triangles[t, 2]]):
                continue
            begin, end = cells_of(points, triangles[t], low, size, pad)
            for x in range(begin[0], end[0] + 1):
                for y in range(begin[1], end[1] + 1):
                    for z in range(begin[2], end[2] + 1):
                        if sweep == 0:
                            cubes[x, y, z] = True
                        elif cubes[x, y, z]:
                            inside[t] = True
    return inside
