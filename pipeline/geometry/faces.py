"""Tetrahedra to faces between an owner and a neighbour, in the order that a finite-volume solver wants."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.tets import Cells, Numbers
from pipeline.geometry.triangles import Floats, Ints


@dataclass(frozen=True, eq=False, slots=True)
class TetFaces:
    """Every triangle of a tetrahedral mesh once, in solver order.

    Parameters
    ----------
    triangles : (faces, 3) int array
        Counterclockwise seen from outside the owner; internal faces first, sorted by (owner, neighbour), then
        the boundary faces, patch after patch in the order of their owners.
    owner : (faces,) int array
        New number of the cell of lower number.
    neighbour : (internal,) int array
        New number of the other cell of the internal faces.
    order : (cells,) int array
        New cell k is the old tetrahedron ``order[k]``.
    patch : (patches,) int array
        Number of faces on each patch.
    """

    triangles: Ints
    owner: Ints
    neighbour: Ints
    order: Ints
    patch: Ints


def tet_faces(tets: Numbers, across: Cells | None = None) -> TetFaces:
    """List the tetrahedra's faces, and renumber the cells so that neighbours stand close to each other.

    Parameters
    ----------
    tets : (m, 4) int array
        Positive tetrahedra.
    across : (m, 4) int array, optional
        Neighbor across each face as in `pipeline.geometry.adjacency.neighbors`, -1 - k on the patch number k; matched
        here unless given.

    Returns
    -------
    TetFaces

    Raises
    ------
    ValueError
        If more than two tetrahedra share a face.

    Notes
    -----
    Reverse Cuthill-McKee (Cuthill & McKee 1969; George 1971) narrows the matrix's band, which saves a fifth to
    a quarter of the solver's time. A face keeps the vertex order of its owner, so its area vector points from the
    lower cell to the higher.

    Examples
    --------
    >>> found = tet_faces(np.array([[0, 1, 2, 3], [1, 2, 4, 3]]))
    >>> len(found.triangles), len(found.neighbour)
    (7, 1)
    """
    # numba takes half a second to load
    from pipeline.geometry.adjacency import neighbors
    from pipeline.geometry.face_order import in_solver_order, narrow_band

    cells = np.ascontiguousarray(tets, np.int32)
    beyond = neighbors(cells) if across is None else np.ascontiguousarray(across, np.int32)
    order = narrow_band(beyond)
    patches = max(0, -int(beyond.min(initial=0)))
    found = in_solver_order(cells, beyond, order, patches)
    for array in found:
        array.flags.writeable = False  # what is read-only is not copied where it is kept
    triangles, owner, neighbour, patch = found
    return TetFaces(triangles, owner, neighbour, order, patch)


def compacted(points: Floats, corners: Ints) -> tuple[Floats, Ints]:
    """Drop the points that no corner uses.

    Parameters
    ----------
    points : (n, 3) array [m]
    corners : int array of any shape

    Returns
    -------
    points : (used, 3) array [m]
    corners : int array
        The same corners by their new numbers.
    """
    used = np.zeros(len(points), bool)
    used[corners] = True
    return points[used], (np.cumsum(used) - 1)[corners]


def tets_of_faces(triangles: Ints, owner: Ints, neighbour: Ints, cells: int) -> Ints:
    """Give the tetrahedra that faces enclose: the way back from `tet_faces`.

    Parameters
    ----------
    triangles : (faces, 3) int array
        Counterclockwise seen from outside the owner.
    owner, neighbour : (faces,) and (internal,) int arrays
    cells : int

    Returns
    -------
    (cells, 4) int array
        Positive tetrahedra.

    Raises
    ------
    ValueError
        If a cell has not four faces.

    Examples
    --------
    >>> tets_of_faces(np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), np.zeros(4, int), np.empty(0, int), 1)
    array([[1, 3, 2, 0]])
    """
    faces_of = np.bincount(owner, minlength=cells) + np.bincount(neighbour, minlength=cells)
    odd = int((faces_of != 4).sum())
    if odd:
        raise ValueError(f"{odd} cells are no tetrahedra")
    # each vertex is in three of the four faces, so the sum of all corners gives the one that a face lacks
    inner = len(neighbour)
    face_sum = triangles.sum(axis=1)
    total = np.zeros(cells, np.int64)
    np.add.at(total, owner, face_sum)
    np.add.at(total, neighbour, face_sum[:inner])
    base = np.empty((cells, 3), np.int64)
    base[neighbour] = triangles[:inner]
    base[owner] = triangles[:, [0, 2, 1]]
    return np.column_stack([base, total // 3 - base.sum(axis=1)])
