r"""Tetrahedra that fill the cubes of an octree and fit each other across its levels.

Between two cubes of one size stand the four tetrahedra of the body-centered cubic lattice, around the line between
their centers: congruent, their centers equidistant from their faces, so that a finite-volume solver sees a perfectly
orthogonal mesh. Toward a smaller or larger neighbor, and toward the box's planes, a cube ends in pyramids from its
center to its face, cut into tetrahedra that fit (Labelle & Shewchuk, Isosurface Stuffing, ACM TOG 26:57, 2007).
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.triangles import Ints
from pipeline.mesh.engines.lattice.octree import Octree


def lattice_tets(tree: Octree) -> tuple[Ints, Ints]:
    """Fill the cubes with tetrahedra.

    Parameters
    ----------
    tree : Octree

    Returns
    -------
    places : (n, 3) int array
        Lattice coordinates of the vertices: twice those in smallest cubes.
    tets : (m, 4) int array
        Positive.
    """
    shape = np.array(tree.counts) * 2 + 1
    corner = np.zeros(shape, dtype=bool)
    top = int(tree.level.max())
    cubes = [tree.cubes(level) for level in range(top + 1)]
    for level, low in enumerate(cubes):
        for offset in np.ndindex(2, 2, 2):
            corner[tuple((2 * (low + np.array(offset) * (1 << level))).T)] = True
    keys: list[Ints] = []
    for level, low in enumerate(cubes):
        if len(low):
            keys += _tets_of_level(tree, corner, level, low)
    found, tets = np.unique(np.concatenate(keys), return_inverse=True)
    places = np.stack(np.unravel_index(found, tuple(shape)), axis=1).astype(np.int64)
    tets = tets.reshape(-1, 4).astype(np.int64)
    return places, _positive(places, tets)


def _positive(places: Ints, tets: Ints) -> Ints:
    a, b, c, d = (places[tets[:, k]] for k in range(4))
    inverted = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    tets[inverted] = tets[inverted][:, [1, 0, 2, 3]]
    return tets


def _tets_of_level(tree: Octree, corner: np.ndarray, level: int, low: Ints) -> list[Ints]:
    """Tetrahedra at the faces of all cubes of a level, as (k, 4) arrays of lattice keys."""
    shape = corner.shape
    size = 1 << level
    counts = np.array(tree.counts)
    center = 2 * low + size
    result: list[Ints] = []

    def key(place: Ints) -> Ints:
        return np.asarray(np.ravel_multi_index(tuple(np.moveaxis(place, -1, 0)), shape), np.int64)

    for axis in range(3):
        u, v = ((axis + 1) % 3, (axis + 2) % 3)
        for side in (-1, 1):
            beside = low.copy()
            beside[:, axis] += size if side > 0 else -1
            outside = (beside[:, axis] < 0) | (beside[:, axis] >= counts[axis])
            other = tree.level[tuple(np.clip(beside, 0, counts - 1).T)].astype(np.int64)
            other[outside] = -1
            # the four corners of the face and the middles of its edges, around its center
            middle = center.copy()
            middle[:, axis] += side * size
            around = np.zeros((8, 3), dtype=np.int64)
            for k, (s, t) in enumerate([(-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)]):
                around[k, u], around[k, v] = s * size, t * size
            ring = middle[:, None, :] + around
            split = corner[tuple(np.moveaxis(ring[:, 1::2], -1, 0))]  # (cubes, 4): edges with a vertex in the middle

            same = other == level
            if side > 0:  # each pair once, from its lower cube
                across = center.copy()
                across[:, axis] += 2 * size
                result += _around(key(center[same]), key(across[same]), key(ring[same]), split[same])
            # a finer neighbor has a vertex at the face's center; at the box's plane it is made
            fan = outside | ((other >= 0) & (other < level))
            result += _around(key(center[fan]), key(middle[fan]), key(ring[fan]), split[fan])
            # a coarser neighbor's face is four of ours: the diagonal goes to its center
            half = other > level
            result += _halves(key(center[half]), key(ring[half][:, ::2]), ring[half][:, ::2], (u, v), size)
    return [tets for tets in result if len(tets)]


def _around(one: Ints, two: Ints, ring: Ints, split: np.ndarray) -> list[Ints]:
    """Tetrahedra around the line from `one` to `two`: one per edge of the face, or two where the edge is split."""
    found = []
    for k in range(4):
        first, half, last = ring[:, 2 * k], ring[:, 2 * k + 1], ring[:, (2 * k + 2) % 8]
        cut, whole = split[:, k], ~split[:, k]
        found.append(np.stack([one, two, first, last], axis=1)[whole])
        found.append(np.stack([one, two, first, half], axis=1)[cut])
        found.append(np.stack([one, two, half, last], axis=1)[cut])
    return found


def _halves(one: Ints, corners: Ints, places: Ints, plane: tuple[int, int], size: int) -> list[Ints]:
    """Two half pyramids; their common diagonal ends in the coarser face's center."""
    # the coarser cube is aligned: its center is the corner whose coordinates are odd multiples of our edge
    odd = (places[..., plane] // (2 * size)) % 2 == 1
    start = odd.all(axis=2).argmax(axis=1)
    rows = np.arange(len(corners))
    a, b, c, d = (corners[rows, (start + k) % 4] for k in range(4))
    return [np.stack([one, a, b, c], axis=1), np.stack([one, a, c, d], axis=1)]
