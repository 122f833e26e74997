"""Cut tetrahedra where the fibers' surface crosses them and keep what lies in the air."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.geometry.keys import KeyTable, add, empty_table, row_of
from pipeline.geometry.tets import Cells
from pipeline.geometry.triangles import Floats, Ints

Sides = npt.NDArray[np.int8]
"""1 for vertices in the air, 0 on the surface, -1 in a fiber."""

_TURNS = np.array(
    [
        [0, 1, 2, 3, 4, 5],
        [1, 2, 0, 4, 5, 3],
        [2, 0, 1, 5, 3, 4],
        [3, 4, 5, 0, 1, 2],
        [4, 5, 3, 1, 2, 0],
        [5, 3, 4, 2, 0, 1],
    ]
)
"""Corners of a prism, turned so that each of them comes first."""


def crossed_edges(tets: Cells, side: Sides) -> tuple[Ints, KeyTable]:
    """Edges from the air into a fiber.

    Parameters
    ----------
    tets : (m, 4) int array
    side : (n,) int8 array

    Returns
    -------
    edges : (k, 2) int array
        Outer and inner vertex of each, each edge once.
    table : KeyTable
        Row of the edge with the key ``outer * n + inner``.
    """
    edges, table = _crossed(tets, side)
    return edges, table


@compiled
def _crossed(tets: Cells, side: Sides) -> tuple[Ints, KeyTable]:
    both = 0
    for cell in range(len(tets)):
        lowest, highest = 1, -1
        for k in range(4):
            lowest, highest = min(lowest, side[tets[cell, k]]), max(highest, side[tets[cell, k]])
        both += lowest < 0 < highest
    table = empty_table(4 * both)
    edges = np.empty((4 * both, 2), np.int64)
    count = 0
    for cell in range(len(tets)):
        for k in range(4):
            outer = tets[cell, k]
            if side[outer] <= 0:
                continue
            for j in range(4):
                inner = tets[cell, j]
                if side[inner] < 0 and add(table, outer * len(side) + inner, count) == count:
                    edges[count, 0], edges[count, 1] = outer, inner
                    count += 1
    return edges[:count].copy(), table


@compiled
def in_air(points: Floats, tets: Cells, side: Sides, rank: Ints, edges: KeyTable, kept: npt.NDArray[np.bool_]) -> Cells:
    """Give the tetrahedra of the air: whole ones, and what the surface leaves of those it crosses.

    Parameters
    ----------
    points : (n + k, 3) array
        Vertices, then the crossing on each edge.
    tets : (m, 4) int array
    side : (n,) int8 array
    rank : (n,) int array
        A quadrilateral between two tetrahedra is cut through its corner of the lowest rank, so that both cut it alike.
    edges : KeyTable
        As `crossed_edges` gives it.
    kept : (m,) bool array
        Tetrahedra to keep though every vertex lies on the surface.

    Returns
    -------
    (j, 4) int array
        Positive.
    """
    count = 0
    room = len(tets) + 1024
    result = np.empty((room, 4), np.int32)
    corner, air, on, inner = np.empty(4, np.int64), 0, 0, 0
    prism = np.empty(6, np.int64)
    for cell in range(len(tets)):
        # vertices in the air first, then those on the surface, then those inside
        air = on = inner = 0
        for wanted in (1, 0, -1):
            for k in range(4):
                if side[tets[cell, k]] == wanted:
                    corner[air + on + inner] = tets[cell, k]
                    air += wanted == 1
                    on += wanted == 0
                    inner += wanted == -1
        if air == 0 and not kept[cell]:
            continue
        if count + 3 > room:
            result = np.concatenate((result, np.empty_like(result)))
            room = len(result)
        begin = count
        a, b, c, d = corner
        if inner == 0:
            result[count] = tets[cell]
            count += 1
            continue
        if air == 1:
            result[count, 0] = a
            for k in range(1, 4):
                result[count, k] = corner[k] if k <= on else _crossing(a, corner[k], side, edges)
            count += 1
        elif air == 2 and inner == 1:
            count = _pyramid(c, a, b, _crossing(b, d, side, edges), _crossing(a, d, side, edges), rank, result, count)
        else:
            if air == 2:
                prism[0], prism[1], prism[2] = a, _crossing(a, c, side, edges), _crossing(a, d, side, edges)
                prism[3], prism[4], prism[5] = b, _crossing(b, c, side, edges), _crossing(b, d, side, edges)
            else:
                prism[:3] = corner[:3]
                for k in range(3):
                    prism[3 + k] = _crossing(corner[k], d, side, edges)
            count = _prism(prism, rank, result, count)
        for n in range(begin, count):
            if _volume(points, result[n]) < 0.0:
                result[n, 0], result[n, 1] = result[n, 1], result[n, 0]
    return result[:count].copy()


@compiled
def _crossing(outer: np.int64, inner: np.int64, side: Sides, edges: KeyTable) -> int:
    return len(side) + row_of(edges, int(outer) * len(side) + int(inner))


@compiled
def _volume(points: Floats, tet: Cells) -> float:
    a = points[tet[0]]
    b, c, d = points[tet[1]] - a, points[tet[2]] - a, points[tet[3]] - a
    return float(
        (b[1] * c[2] - b[2] * c[1]) * d[0] + (b[2] * c[0] - b[0] * c[2]) * d[1] + (b[0] * c[1] - b[1] * c[0]) * d[2]
    )


@compiled
def _before(a: np.int64, b: np.int64, rank: Ints) -> bool:
    """Whether vertex a has the lower rank; crossings come last."""
    if a < len(rank) and b < len(rank):
        return bool(rank[a] < rank[b])
    return bool(a < b)


@compiled
def _pyramid(apex: np.int64, a: np.int64, b: np.int64, c: int, d: int, rank: Ints, result: Cells, count: int) -> int:
    """Two tetrahedra; the base a, b, c, d is cut through the corner of lowest rank, which is a or b."""
    if _before(b, a, rank):
        result[count, 0], result[count, 1], result[count, 2], result[count, 3] = apex, b, c, d
        result[count + 1, 0], result[count + 1, 1], result[count + 1, 2], result[count + 1, 3] = apex, b, d, a
    else:
        result[count, 0], result[count, 1], result[count, 2], result[count, 3] = apex, a, b, c
        result[count + 1, 0], result[count + 1, 1], result[count + 1, 2], result[count + 1, 3] = apex, a, c, d
    return count + 2


@compiled
def _prism(prism: Ints, rank: Ints, result: Cells, count: int) -> int:
    """Three tetrahedra between two triangles, each quadrilateral cut through its corner of lowest rank."""
    lowest = 0
    for k in range(1, 6):
        if _before(prism[k], prism[lowest], rank):
            lowest = k
    # turned so that the lowest corner comes first: both quadrilaterals at it are cut through it
    turn = _TURNS[lowest]
    a, b, c = prism[turn[0]], prism[turn[1]], prism[turn[2]]
    d, e, f = prism[turn[3]], prism[turn[4]], prism[turn[5]]
    # what remains is the quadrilateral b, c, f, e
    first = f if _before(f, b, rank) else b
    second = e if _before(e, c, rank) else c
    if not _before(first, second, rank):
        b, c, e, f = c, b, f, e
    result[count, 0], result[count, 1], result[count, 2], result[count, 3] = a, d, e, f
    result[count + 1, 0], result[count + 1, 1], result[count + 1, 2], result[count + 1, 3] = a, b, c, f
    result[count + 2, 0], result[count + 2, 1], result[count + 2, 2], result[count + 2, 3] = a, b, e, f
    return count + 3
