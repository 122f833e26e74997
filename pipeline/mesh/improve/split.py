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

An edge on the interface of a part stays whole, since the cells behind it do not know what happens here: a cell whose
only edge to split lies there stays too.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace

import numpy as np

from pipeline.geometry.tets import Cells
from pipeline.mesh.freedom import Planes
from pipeline.mesh.working_mesh import WorkingMesh, on_boundary
from pipeline.nouns.arrays import Bools, Floats, Ints

_EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
_ROUNDS = 20  # neighboring corners take turns; on real mats three rounds were the most


def split_corners(mesh: WorkingMesh) -> WorkingMesh:
    """Split cells until none has more than one boundary face."""
    for _ in range(_ROUNDS):
        faces = mesh.boundary_faces()
        three = np.flatnonzero(faces >= 3)
        two = np.flatnonzero(faces == 2)
        if len(three):
            mesh = _with_centers(mesh, three)
        elif len(two):
            before = mesh.cells
            mesh = _with_midpoints(mesh, two, _opposite_edges(mesh, two))
            if mesh.cells == before:  # all of them at the interface
                break
        else:
            break
    return mesh


def split_longest(mesh: WorkingMesh, chosen: Bools) -> WorkingMesh:
    """Split the longest edge of some cells, which gives smoothing a vertex more to move there.

    Parameters
    ----------
    mesh : WorkingMesh
    chosen : (m,) bool array

    Returns
    -------
    WorkingMesh
        Of neighboring edges only one is split.
    """
    cells = np.flatnonzero(chosen)
    ends = mesh.tets[cells][:, _EDGES]
    lengths = np.linalg.norm(mesh.points[ends[..., 1]] - mesh.points[ends[..., 0]], axis=2)
    return _with_midpoints(mesh, cells, _EDGES[lengths.argmax(axis=1)])


def _opposite_edges(mesh: WorkingMesh, cells: Ints) -> Ints:
    """Local ends of the edge opposite the one that a cell's two boundary faces share, (k, 2) int array."""
    # the corner opposite local face s is 3 - s, and the edge joins the two corners that lie on one of both faces only
    _, side = np.nonzero(on_boundary(mesh.across[cells]))
    return 3 - side.reshape(-1, 2)


def _with_centers(mesh: WorkingMesh, cells: Ints) -> WorkingMesh:
    """Split cells into four about their centers."""
    from pipeline.mesh.improve.cell_splits import split_at_centers

    points = np.concatenate([mesh.points, mesh.points[mesh.tets[cells]].mean(axis=1)])
    tets, across = split_at_centers(mesh.tets, mesh.across, cells, len(mesh.points))
    return _with_new(mesh, points, np.zeros(len(cells), np.uint8), tets, across)


def _with_midpoints(mesh: WorkingMesh, cells: Ints, local_ends: Ints) -> WorkingMesh:
    """Split edges, given by a cell each and its local ends, and all the cells around them."""
    from pipeline.mesh.improve.cell_splits import chosen_edges, split_at_midpoints

    ends = np.sort(np.take_along_axis(mesh.tets[cells], local_ends, axis=1), axis=1).astype(np.int64)
    keys, row = np.unique(ends[:, 0] * len(mesh.points) + ends[:, 1], return_index=True)
    # a cell takes one split a round, and of several edges one goes first, the others wait: in an order by chance, since
    # along a rim edges with ascending numbers would wait for each other one by one
    turn = np.random.default_rng(0).permutation(len(keys))
    ends, cells = ends[row], cells[row]
    go = chosen_edges(mesh.tets, mesh.across, cells, ends, turn)
    ends, cells = ends[go], cells[go]
    if not len(ends):
        return mesh
    points = np.concatenate([mesh.points, mesh.points[ends].mean(axis=1)])
    tets, across = split_at_midpoints(mesh.tets, mesh.across, cells, ends, len(mesh.points))
    return _with_new(mesh, points, mesh.planes[ends[:, 0]] & mesh.planes[ends[:, 1]], tets, across)


def _with_new(mesh: WorkingMesh, points: Floats, planes: Planes, tets: Cells, across: Cells) -> WorkingMesh:
    return replace(mesh, points=points, planes=np.concatenate([mesh.planes, planes]), tets=tets, across=across)
