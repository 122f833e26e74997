"""Split cells and tell their neighbors, without matching any face again. Compiled by numba.

The corner opposite the local face s of a tetrahedron is 3 - s, whatever the cell: so a cell one of whose corners is
replaced keeps the numbers of its faces.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.geometry.tets import Cells
from pipeline.geometry.triangles import Ints
from pipeline.mesh.working_mesh import INTERFACE

_MOST = 4096  # cells around one edge; a fan of that many is no mesh


@compiled
def _slot(tets: Cells, cell: int, vertex: int) -> int:
    for k in range(4):
        if tets[cell, k] == vertex:
            return k
    return -1


@compiled
def _around(tets: Cells, across: Cells, cell: int, low: int, high: int, found: Cells) -> int:
    """List the cells around an edge; their number, or 0 where the edge lies on the interface of a part."""
    found[0] = cell
    count = 1
    start, end = _slot(tets, cell, low), _slot(tets, cell, high)
    for turn in range(2):
        # leave through the face opposite one of the two other corners, which is then behind
        here = cell
        behind = -1
        for k in range(4):
            if k != start and k != end and (behind < 0 or turn == 1):
                behind = k
        behind = tets[cell, behind]
        while True:
            beyond = across[here, 3 - _slot(tets, here, behind)]
            if beyond == cell:
                return count  # all around
            if beyond < 0:
                if beyond <= INTERFACE:
                    return 0
                break
            ahead = -1
            for k in range(4):
                vertex = tets[here, k]
                if vertex != low and vertex != high and vertex != behind:
                    ahead = vertex
            # the face in common holds `ahead`; the corner that is new lies beyond
            here, behind = beyond, ahead
            found[count] = here
            count += 1
    return count


@compiled
def chosen_edges(tets: Cells, across: Cells, cells: Ints, ends: Ints, turn: Ints) -> npt.NDArray[np.bool_]:
    """Choose edges of which no cell has two: of several, the one whose turn comes first.

    Parameters
    ----------
    tets, across : (m, 4) int32 arrays
    cells : (k,) int array
        A cell at each edge.
    ends : (k, 2) int array
        Different ones.
    turn : (k,) int array
        A permutation.

    Returns
    -------
    (k,) bool array
        False for edges on the interface of a part.
    """
    first = np.full(len(tets), len(cells), np.int32)
    found = np.empty(_MOST, np.int32)
    go = np.zeros(len(cells), np.bool_)
    for edge in range(len(cells)):
        count = _around(tets, across, cells[edge], ends[edge, 0], ends[edge, 1], found)
        for n in range(count):
            first[found[n]] = min(first[found[n]], turn[edge])
    for edge in range(len(cells)):
        count = _around(tets, across, cells[edge], ends[edge, 0], ends[edge, 1], found)
        go[edge] = count > 0
        for n in range(count):
            go[edge] &= first[found[n]] == turn[edge]
    return go


@compiled
def split_at_midpoints(tets: Cells, across: Cells, cells: Ints, ends: Ints, vertex: int) -> tuple[Cells, Cells]:
    """Split every cell around some edges into two.

    Parameters
    ----------
    tets, across : (m, 4) int32 arrays
    cells, ends : (k,) and (k, 2) int arrays
        As `chosen_edges` leaves them.
    vertex : int
        Number of the new vertex on the first edge; the others follow.

    Returns
    -------
    tets, across : (m + j, 4) int32 arrays
        The half with the first end of the edge keeps the number of its cell.
    """
    count = len(tets)
    half = np.full(count, -1, np.int32)  # number of the other half of each cell
    edge_of = np.empty(count, np.int32)
    found = np.empty(_MOST, np.int32)
    split = np.empty(64 * len(cells) + 64, np.int32)
    total = 0
    for edge in range(len(cells)):
        around = _around(tets, across, cells[edge], ends[edge, 0], ends[edge, 1], found)
        if total + around > len(split):
            split = np.concatenate((split, np.empty(len(split) + around, np.int32)))
        for n in range(around):
            cell = found[n]
            split[total] = cell
            half[cell], edge_of[cell] = count + total, edge
            total += 1
    new_tets = np.empty((count + total, 4), np.int32)
    new_across = np.empty((count + total, 4), np.int32)
    new_tets[:count], new_across[:count] = tets, across
    for n in range(total):
        cell, far = split[n], count + n
        edge = edge_of[cell]
        low, high = _slot(tets, cell, ends[edge, 0]), _slot(tets, cell, ends[edge, 1])
        for k in range(4):
            new_tets[far, k] = tets[cell, k]
        new_tets[cell, high] = vertex + edge
        new_tets[far, low] = vertex + edge
        for side in range(4):
            other = across[cell, side]
            if side == 3 - low:  # opposite the first end: the far half's own face, and between both for the near one
                new_across[cell, side] = far
                new_across[far, side] = _half_beyond(tets, across, half, edge_of, ends, cell, other)
                if other >= 0 and half[other] < 0:
                    for back in range(4):
                        if across[other, back] == cell:
                            new_across[other, back] = far
            elif side == 3 - high:
                new_across[cell, side] = _half_beyond(tets, across, half, edge_of, ends, cell, other)
                new_across[far, side] = cell
            else:
                new_across[far, side] = half[other] if other >= 0 else other
    return new_tets, new_across


@compiled
def _half_beyond(tets: Cells, across: Cells, half: Cells, edge_of: Cells, ends: Ints, cell: int, other: int) -> int:
    """Cell beyond a face that stays whole: of two halves the one that has it."""
    if other < 0 or half[other] < 0:
        return other
    low = _slot(tets, other, ends[edge_of[other], 0])
    return half[other] if across[other, 3 - low] == cell else other


@compiled
def split_at_centers(tets: Cells, across: Cells, cells: Ints, vertex: int) -> tuple[Cells, Cells]:
    """Split cells into four about a new vertex each.

    Parameters
    ----------
    tets, across : (m, 4) int32 arrays
    cells : (k,) int array
    vertex : int
        Number of the new vertex in the first cell; the others follow.

    Returns
    -------
    tets, across : (m + 3 k, 4) int32 arrays
    """
    count = len(tets)
    new_tets = np.empty((count + 3 * len(cells), 4), np.int32)
    new_across = np.empty((count + 3 * len(cells), 4), np.int32)
    new_tets[:count], new_across[:count] = tets, across
    fourth = np.empty(4, np.int32)
    for n in range(len(cells)):
        cell = cells[n]
        fourth[0] = cell
        for k in range(1, 4):
            fourth[k] = count + 3 * n + k - 1
        # the one without corner k has the face opposite it, and borders on the one without corner j opposite corner j
        outside = new_across[cell].copy()
        corner = tets[cell].copy()
        for k in range(4):
            for j in range(4):
                new_tets[fourth[k], j] = corner[j]
                new_across[fourth[k], 3 - j] = fourth[j]
            new_tets[fourth[k], k] = vertex + n
            other = outside[3 - k]
            new_across[fourth[k], 3 - k] = other
            if other >= 0:
                for back in range(4):
                    if new_across[other, back] == cell:
                        new_across[other, back] = fourth[k]
    return new_tets, new_across
