"""Cells of the usual kinds, or any polyhedra, to faces between an owner and a neighbour."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.tets import FACES
from pipeline.geometry.triangles import Ints

KINDS = {
    "tetra": FACES,
    "pyramid": np.array([[0, 3, 2, 1], [0, 1, 4, -1], [1, 2, 4, -1], [2, 3, 4, -1], [3, 0, 4, -1]]),
    "wedge": np.array([[0, 2, 1, -1], [3, 4, 5, -1], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]),
    "hexahedron": np.array(
        [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    ),
    "pentagonal prism": np.array(
        [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9], *([k, (k + 1) % 5, 5 + (k + 1) % 5, 5 + k, -1] for k in range(5))]
    ),
    "hexagonal prism": np.array(
        [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11],
         *([k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k, -1, -1] for k in range(6))]
    ),
}  # fmt: skip
"""Faces of each kind by its local corners, counterclockwise seen from outside, -1 where a face has three."""


@dataclass(frozen=True, eq=False, slots=True)
class CellFaces:
    """Every polygon of a mesh once.

    Parameters
    ----------
    polygons : (faces, width) int array
        Corners, counterclockwise seen from outside the owner, filled up with -1; internal faces first, sorted by
        (owner, neighbour), then the boundary by owner.
    owner : (faces,) int array
    neighbour : (internal,) int array
    """

    polygons: Ints
    owner: Ints
    neighbour: Ints


def polygons_of(kind: str, cells: Ints) -> Ints:
    """Give the faces of cells of one kind.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    cells : (m, corners) int array

    Returns
    -------
    (m * faces of the kind, width) int array
        The faces of a cell stand together; filled up with -1.

    Examples
    --------
    >>> polygons_of("wedge", np.array([[10, 11, 12, 13, 14, 15]])).tolist()[0]
    [10, 12, 11, -1]
    """
    table = KINDS[kind]
    faces = np.where(table >= 0, cells[:, table], -1)
    return faces.reshape(-1, table.shape[1])


def cell_faces(polygons: Ints, cell: Ints) -> CellFaces:
    """Put the polygons of all cells into a solver's order, those of two cells once.

    Parameters
    ----------
    polygons : (k, width) int array
        Faces of all cells, filled up with -1.
    cell : (k,) int array
        The cell that each belongs to.

    Returns
    -------
    CellFaces

    Raises
    ------
    ValueError
        If more than two cells share a face, or one cell has a face twice.
    """
    first, second = matched_pairs(polygons)
    swap = cell[first] > cell[second]
    ours, theirs = np.where(swap, second, first), np.where(swap, first, second)
    twice = int((cell[ours] == cell[theirs]).sum())
    if twice:
        raise ValueError(f"{twice} cells have the same face twice")
    order = np.lexsort((cell[theirs], cell[ours]))
    ours, theirs = ours[order], theirs[order]
    single = np.ones(len(polygons), bool)
    single[first] = single[second] = False
    outside = np.flatnonzero(single)
    outside = outside[np.argsort(cell[outside], kind="stable")]
    faces = np.concatenate([ours, outside])
    return CellFaces(polygons[faces], cell[faces], cell[theirs])


def matched_pairs(polygons: Ints) -> tuple[Ints, Ints]:
    """Find the polygons that have the same corners, in whatever order.

    Parameters
    ----------
    polygons : (k, width) int array
        Filled up with -1.

    Returns
    -------
    first, second : (pairs,) int arrays
        Rows of `polygons`.

    Raises
    ------
    ValueError
        If three have the same corners.

    Examples
    --------
    >>> matched_pairs(np.array([[4, 7, 9], [1, 2, 3], [9, 4, 7]]))
    (array([0]), array([2]))
    """
    corners = np.sort(polygons, axis=1).T
    order = np.lexsort(corners)
    sorted_corners = corners[:, order]
    same = (sorted_corners[:, 1:] == sorted_corners[:, :-1]).all(axis=0)
    crowded = int((same[1:] & same[:-1]).sum())
    if crowded:
        raise ValueError(f"{crowded} faces belong to more than two cells")
    return order[:-1][same], order[1:][same]


def rows_of(polygons: Ints, among: Ints) -> Ints:
    """Find each polygon among others of the same corners, whatever corner either starts with.

    Parameters
    ----------
    polygons, among : (k, width) and (m, width) int arrays
        Filled up with -1; neither has a polygon twice.

    Returns
    -------
    (k,) int array
        Row of `among`, -1 where there is none.

    Examples
    --------
    >>> rows_of(np.array([[3, 1, 2], [1, 2, 4]]), np.array([[7, 8, 9], [1, 2, 3]]))
    array([ 1, -1])
    """
    first, second = matched_pairs(np.concatenate([among, polygons]))
    rows = np.full(len(polygons), -1)
    rows[second - len(among)] = first
    return rows
