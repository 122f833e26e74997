"""Number tetrahedra and their faces as a finite-volume solver wants them. Compiled by numba."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.tets import FACES, Cells
from pipeline.geometry.triangles import Ints


@compiled
def narrow_band(across: Cells) -> Ints:
    """Order cells by reverse Cuthill-McKee, so that neighbors stand close to each other.

    Parameters
    ----------
    across : (m, 4) int32 array
        Neighbor across each face, below 0 on the boundary.

    Returns
    -------
    (m,) int array
        The cell at each place.
    """
    count = len(across)
    degree = np.zeros(count, np.int8)
    for cell in range(count):
        for side in range(4):
            degree[cell] += across[cell, side] >= 0
    order = np.empty(count, np.int64)
    reached = np.zeros(count, np.bool_)
    end = 0
    # each part begins at one of its cells with the fewest neighbors
    for fewest in range(5):
        for start in range(count):
            if reached[start] or degree[start] != fewest:
                continue
            order[end] = start
            reached[start] = True
            here = end
            end += 1
            while here < end:
                cell = order[here]
                here += 1
                begin = end
                for side in range(4):
                    other = across[cell, side]
                    if other < 0 or reached[other]:
                        continue
                    reached[other] = True
                    # those with fewer neighbors first
                    place = end
                    while place > begin and degree[order[place - 1]] > degree[other]:
                        order[place] = order[place - 1]
                        place -= 1
                    order[place] = other
                    end += 1
    return order[::-1].copy()


@compiled
def in_solver_order(tets: Cells, across: Cells, order: Ints, patches: int) -> tuple[Ints, Ints, Ints, Ints]:
    """List each face once: triangles, owner, neighbour, and the number of faces on each patch.

    Parameters
    ----------
    tets, across : (m, 4) int32 arrays
    order : (m,) int array
        The cell at each place.
    patches : int
        Number of patches; a face on number k has -1 - k across.
    """
    count = len(order)
    number = np.empty(count, np.int32)
    for place in range(count):
        number[order[place]] = place
    on_patch = np.zeros(patches, np.int64)
    for cell in range(count):
        for side in range(4):
            if across[cell, side] < 0:
                on_patch[-1 - across[cell, side]] += 1
    internal = (4 * count - on_patch.sum()) // 2
    following = internal + np.cumsum(on_patch) - on_patch
    triangles = np.empty((internal + on_patch.sum(), 3), np.int64)
    owner = np.empty(len(triangles), np.int64)
    neighbour = np.empty(internal, np.int64)
    sides = np.empty(4, np.int64)
    inner = 0
    for place in range(count):
        cell = order[place]
        higher = 0
        for side in range(4):
            other = across[cell, side]
            if other < 0:
                face = following[-1 - other]
                following[-1 - other] += 1
                owner[face] = place
                for k in range(3):
                    triangles[face, k] = tets[cell, FACES[side, k]]
            elif number[other] > place:
                at = higher
                while at > 0 and number[across[cell, sides[at - 1]]] > number[other]:
                    sides[at] = sides[at - 1]
                    at -= 1
                sides[at] = side
                higher += 1
        for n in range(higher):
            owner[inner] = place
            neighbour[inner] = number[across[cell, sides[n]]]
            for k in range(3):
                triangles[inner, k] = tets[cell, FACES[sides[n], k]]
            inner += 1
    return triangles, owner, neighbour, on_patch
