"""Cut tetrahedra where the fibers' surface crosses them and keep what lies in the air."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.tets import volumes
from pipeline.geometry.triangles import Floats, Ints


def crossed_edges(tets: Ints, side: npt.NDArray[np.int8]) -> Ints:
    """Edges from the air into a fiber.

    Parameters
    ----------
    tets : (m, 4) int array
    side : (n,) int8 array
        1 for vertices in the air, 0 on the surface, -1 in a fiber.

    Returns
    -------
    (k, 2) int array
        Outer and inner vertex of each, sorted, each edge once.
    """
    both = (side[tets] > 0).any(axis=1) & (side[tets] < 0).any(axis=1)
    pairs = tets[both][:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]].reshape(-1, 2)
    sides = side[pairs]
    pairs = pairs[sides[:, 0] * sides[:, 1] < 0]
    swap = side[pairs[:, 0]] < 0
    pairs[swap] = pairs[swap][:, ::-1]
    count = len(side)
    keys = np.unique(pairs[:, 0] * count + pairs[:, 1])
    return np.stack([keys // count, keys % count], axis=1)


def kept(points: Floats, tets: Ints, side: npt.NDArray[np.int8], edges: Ints, value: Floats) -> Ints:
    """Give the tetrahedra of the air: whole ones, and what the surface leaves of those it crosses.

    Parameters
    ----------
    points : (n + k, 3) array
        Vertices, then the crossing on each edge.
    tets : (m, 4) int array
    side : (n,) int8 array
        As in `crossed_edges`.
    edges : (k, 2) int array
        As `crossed_edges` gives them.
    value : (n,) array
        Distance of each vertex from the surface: a quadrilateral between two tetrahedra is cut through the corner
        nearest to it, so that both cut it alike, and the diagonal is the shorter one.

    Returns
    -------
    (j, 4) int array
        Positive.
    """
    rank = np.empty(len(points))
    rank[np.lexsort((np.arange(len(value)), value))] = np.arange(len(value))
    rank[len(value) :] = np.arange(len(value), len(points))
    count = len(side)
    keys = edges[:, 0] * count + edges[:, 1]

    def crossing(outer: Ints, inner: Ints) -> Ints:
        return count + np.searchsorted(keys, outer * count + inner)

    sides = side[tets]
    some_air = (sides > 0).any(axis=1)
    whole = some_air & (sides >= 0).all(axis=1)
    crossed = some_air & ~whole
    # vertices in the air first, then those on the surface, then those inside
    order = np.argsort(-sides[crossed], axis=1, kind="stable")
    rest = np.take_along_axis(tets[crossed], order, axis=1)
    sides = np.take_along_axis(sides[crossed], order, axis=1)
    air, inner = (sides > 0).sum(axis=1), (sides < 0).sum(axis=1)

    result = [tets[whole]]
    one = rest[air == 1]
    hit = sides[air == 1] < 0
    for k in (1, 2, 3):
        column = one[:, k].copy()
        column[hit[:, k]] = crossing(one[hit[:, k], 0], one[hit[:, k], k])
        one = np.column_stack([one[:, :k], column, one[:, k + 1 :]])
    result.append(one)

    a, b, on, inside = rest[(air == 2) & (inner == 1)].T
    result += _pyramids(on, np.stack([a, b, crossing(b, inside), crossing(a, inside)], axis=1), rank)
    a, b, c, d = rest[(air == 2) & (inner == 2)].T
    result += _prisms(
        np.stack([a, crossing(a, c), crossing(a, d)], axis=1),
        np.stack([b, crossing(b, c), crossing(b, d)], axis=1),
        rank,
    )
    a, b, c, inside = rest[(air == 3) & (inner == 1)].T
    result += _prisms(
        np.stack([a, b, c], axis=1),
        np.stack([crossing(a, inside), crossing(b, inside), crossing(c, inside)], axis=1),
        rank,
    )
    found = np.concatenate(result)
    inverted = volumes(points, found) < 0
    found[inverted] = found[inverted][:, [1, 0, 2, 3]]
    return found


def _pyramids(apex: Ints, base: Ints, rank: Floats) -> list[Ints]:
    """Two tetrahedra per pyramid; its base is cut through the corner of lowest rank."""
    start = rank[base].argmin(axis=1)
    rows = np.arange(len(base))
    a, b, c, d = (base[rows, (start + k) % 4] for k in range(4))
    return [np.stack([apex, a, b, c], axis=1), np.stack([apex, a, c, d], axis=1)]


def _prisms(one: Ints, two: Ints, rank: Floats) -> list[Ints]:
    """Three tetrahedra per prism between triangles `one` and `two`, each quadrilateral cut through its lowest rank."""
    corners = np.concatenate([one, two], axis=1)
    lowest = rank[corners].argmin(axis=1)
    rows = np.arange(len(one))[:, None]
    # turn each prism so that its lowest corner comes first: both quadrilaterals at it are cut through it
    turned = corners[rows, _TURNS[lowest]]
    a, b, c, d, e, f = turned.T
    # what remains is the quadrilateral b, c, f, e
    through_b = np.minimum(rank[b], rank[f]) < np.minimum(rank[c], rank[e])
    x = np.where(through_b, b, c), np.where(through_b, c, b), np.where(through_b, e, f), np.where(through_b, f, e)
    low, other, beside, opposite = x
    # low and opposite are the diagonal
    return [
        np.stack([a, d, e, f], axis=1),
        np.stack([a, low, other, opposite], axis=1),
        np.stack([a, low, beside, opposite], axis=1),
    ]


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
