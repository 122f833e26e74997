r"""Split the tetrahedra that sit in a corner of the boundary.

A tetrahedron with two or three faces on the boundary hangs on its neighbors by two faces or one: the gradient at its
center is not determined (OpenFOAM's cell determinant is 0), and `checkMesh -allGeometry` refuses the mesh. ::

        c                    c
       /|\                  /|\        boundary: abc and abd, which share ab
      / | \                / | \       the edge opposite ab is cd: a point m on it parts the cell into two
     a--+--b     ->       a--+--b      with one boundary face each, and each cell around cd into two as well
      \ | /                \ m /
       \|/                  \|/
        d                    d
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.cells import rows_of
from pipeline.geometry.tets import FACES
from pipeline.nouns.arrays import Floats, Ints

_EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
_ROUNDS = 20  # neighboring corners take turns; on real mats three rounds were the most


def split_corners(
    points: Floats, tets: Ints, seam: Ints | None = None, keep_edges: bool = False
) -> tuple[Floats, Ints]:
    """Split cells until none has more than one boundary face.

    Parameters
    ----------
    points : (n, 3) array
    tets : (m, 4) int array
        Positive tetrahedra.
    seam : (k, 3) int array, optional
        Faces behind which the mesh goes on, each with ascending corners: they are no boundary, and stay whole. A corner
        whose edge lies on one stays too.
    keep_edges : bool
        Split cells about their centers alone: the boundary keeps its triangles, at the price of flatter cells.

    Returns
    -------
    points : (n + k, 3) array
    tets : (m + j, 4) int array
        Positive; they fill the same space.
    """
    for _ in range(_ROUNDS):
        faces, cell = true_boundary(tets, seam)
        on_boundary = np.bincount(cell, minlength=len(tets))
        three = np.flatnonzero(on_boundary >= (2 if keep_edges else 3))
        two = np.flatnonzero(on_boundary == 2)
        if len(three):
            points, tets = _with_centers(points, tets, three)
        elif len(two):
            before = len(tets)
            points, tets = _with_midpoints(points, tets, _opposite_edges(tets, faces, cell, two), seam)
            if len(tets) == before:  # all of them at the seam
                break
        else:
            break
    return points, tets


def true_boundary(tets: Ints, seam: Ints | None = None) -> tuple[Ints, Ints]:
    """Find the faces of one cell only, but for those of a seam: faces (b, 3) and the cell of each (b,)."""
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.adjacency import boundary_of, neighbors

    faces, cell = boundary_of(tets, neighbors(tets))
    if seam is None or len(seam) == 0:
        return faces, cell
    true = rows_of(np.sort(faces, axis=1), seam) < 0
    return faces[true], cell[true]


def split_longest(
    points: Floats, tets: Ints, chosen: npt.NDArray[np.bool_], seam: Ints | None = None
) -> tuple[Floats, Ints]:
    """Split the longest edge of some cells, which gives the mender a vertex more to move there.

    Parameters
    ----------
    points : (n, 3) array
    tets : (m, 4) int array
        Positive tetrahedra.
    chosen : (m,) bool array
    seam : (k, 3) int array, optional
        Faces behind which the mesh goes on: no edge of theirs is split, or a vertex would hang there.

    Returns
    -------
    points : (n + k, 3) array
    tets : (m + j, 4) int array
        Positive; they fill the same space. Of neighboring edges only one is split.
    """
    ends = tets[chosen][:, _EDGES]
    lengths = np.linalg.norm(points[ends[..., 1]] - points[ends[..., 0]], axis=2)
    longest = ends[np.arange(len(ends)), lengths.argmax(axis=1)]
    return _with_midpoints(points, tets, np.sort(longest, axis=1), seam)


def _with_centers(points: Floats, tets: Ints, chosen: Ints) -> tuple[Floats, Ints]:
    center = len(points) + np.arange(len(chosen))
    parts = np.concatenate([np.column_stack([tets[chosen][:, FACES[side][::-1]], center]) for side in range(4)])
    return (
        np.concatenate([points, points[tets[chosen]].mean(axis=1)]),
        np.concatenate([np.delete(tets, chosen, axis=0), parts]),
    )


def _opposite_edges(tets: Ints, faces: Ints, owner: Ints, cells: Ints) -> Ints:
    order = np.argsort(owner, kind="stable")
    owner, faces = owner[order], faces[order]
    pair = faces[np.searchsorted(owner, cells)[:, None] + np.arange(2)]  # (cells, 2 faces, 3 corners)
    corners = tets[cells]
    # the opposite edge joins the two corners that lie on one of the two boundary faces only
    shared = (corners[:, :, None] == pair[:, 0][:, None, :]).any(axis=2) & (
        corners[:, :, None] == pair[:, 1][:, None, :]
    ).any(axis=2)
    return np.sort(corners[~shared].reshape(-1, 2), axis=1)


def _with_midpoints(points: Floats, tets: Ints, edges: Ints, seam: Ints | None) -> tuple[Floats, Ints]:
    count = len(points)
    keys = np.unique(edges[:, 0] * count + edges[:, 1])
    if seam is not None:
        low, high = np.sort(seam[:, [[0, 1], [0, 2], [1, 2]]].reshape(-1, 2), axis=1).T
        keys = np.setdiff1d(keys, low * count + high)
    if len(keys) == 0:
        return points, tets
    of_tets = np.sort(tets[:, _EDGES], axis=2)
    tet_keys = of_tets[..., 0] * count + of_tets[..., 1]
    place = np.minimum(np.searchsorted(keys, tet_keys), len(keys) - 1)
    wanted = keys[place] == tet_keys
    # a cell takes one split a round, and of several edges one goes first, the others wait: in an order by chance, since
    # along a rim edges with ascending numbers would wait for each other one by one
    turn = np.random.default_rng(0).permutation(len(keys))
    turns = np.where(wanted, turn[place], len(keys))
    first = turns.min(axis=1, keepdims=True)
    keys = np.setdiff1d(keys, tet_keys[wanted & (turns != first)])
    hit = np.isin(tet_keys, keys)
    cell, edge = np.nonzero(hit)
    middle = count + np.searchsorted(keys, tet_keys[cell, edge])
    low, high = of_tets[cell, edge].T
    near = np.where(tets[cell] == high[:, None], middle[:, None], tets[cell])
    far = np.where(tets[cell] == low[:, None], middle[:, None], tets[cell])
    ends = points[np.column_stack([keys // count, keys % count])]
    return (
        np.concatenate([points, ends.mean(axis=1)]),
        np.concatenate([np.delete(tets, cell, axis=0), near, far]),
    )
