"""Which tetrahedra meet at a face, and which at a vertex. Compiled by numba: imported only where a mesh is made."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.geometry.parts import largest_part
from pipeline.geometry.tets import FACES
from pipeline.geometry.triangles import Ints


def neighbors(tets: Ints) -> Ints:
    """Find the tetrahedron on the other side of each face.

    Parameters
    ----------
    tets : (m, 4) int array
        A conforming mesh of positive tetrahedra.

    Returns
    -------
    (m, 4) int array
        By local face as in `pipeline.geometry.tets.FACES`; -1 on the boundary.

    Raises
    ------
    ValueError
        If more than two tetrahedra share a face.

    Examples
    --------
    >>> neighbors(np.array([[0, 1, 2, 3], [1, 2, 3, 4]])).tolist()
    [[-1, -1, -1, 1], [0, -1, -1, -1]]
    """
    found, crowded = _across(np.ascontiguousarray(tets), int(tets.max(initial=-1)) + 1)
    if crowded:
        raise ValueError(f"{crowded} faces belong to more than two cells")
    return found


def largest_part_of(across: Ints) -> npt.NDArray[np.bool_]:
    """Find the cells of the largest part of a mesh, parts being joined through faces.

    Parameters
    ----------
    across : (m, 4) int array
        As `neighbors` gives it.

    Returns
    -------
    (m,) bool array
    """
    cell, side = np.nonzero(across >= 0)
    return largest_part(cell, across[cell, side], np.ones(len(across), dtype=bool))


def pairs_of(across: Ints) -> tuple[Ints, Ints]:
    """Give the two sides of each face between two tetrahedra.

    Parameters
    ----------
    across : (m, 4) int array
        As `neighbors` gives it.

    Returns
    -------
    first, second : (pairs,) int arrays
        Four times the cell plus its local face, of the cell of lower number and of the other.

    Examples
    --------
    >>> first, second = pairs_of(neighbors(np.array([[0, 1, 2, 3], [1, 2, 3, 4]])))
    >>> first.tolist(), second.tolist()
    ([3], [4])
    """
    cell, side = np.nonzero(across > np.arange(len(across))[:, None])
    other = across[cell, side]
    return 4 * cell + side, 4 * other + (across[other] == cell[:, None]).argmax(axis=1)


@compiled
def _across(tets: Ints, vertices: int) -> tuple[Ints, int]:
    """Match faces within the list of each vertex: that of a face's lowest corner has some ten faces."""
    count = len(tets)
    corners = np.empty((4 * count, 3), np.int64)
    first = np.zeros(vertices + 1, np.int64)
    for cell in range(count):
        for side in range(4):
            a, b, c = tets[cell, FACES[side, 0]], tets[cell, FACES[side, 1]], tets[cell, FACES[side, 2]]
            low, high = min(a, b, c), max(a, b, c)
            face = 4 * cell + side
            corners[face, 0], corners[face, 1], corners[face, 2] = low, a + b + c - low - high, high
            first[low + 1] += 1
    for vertex in range(vertices):
        first[vertex + 1] += first[vertex]
    filled = first[:-1].copy()
    faces = np.empty(4 * count, np.int64)
    across = np.full((count, 4), -1, np.int64)
    crowded = 0
    for face in range(4 * count):
        low = corners[face, 0]
        for place in range(first[low], filled[low]):
            other = faces[place]
            if corners[other, 1] == corners[face, 1] and corners[other, 2] == corners[face, 2]:
                crowded += across[other // 4, other % 4] >= 0
                across[face // 4, face % 4] = other // 4
                across[other // 4, other % 4] = face // 4
                break
        faces[filled[low]] = face
        filled[low] += 1
    return across, crowded


def boundary_of(tets: Ints, across: Ints) -> tuple[Ints, Ints]:
    """Give the faces without a neighbor, as `pipeline.geometry.tets.boundary` does.

    Parameters
    ----------
    tets : (m, 4) int array
    across : (m, 4) int array
        As `neighbors` gives it.

    Returns
    -------
    faces : (b, 3) int array
        Counterclockwise seen from outside.
    cell : (b,) int array
    """
    cell, side = np.nonzero(across < 0)
    return np.take_along_axis(tets[cell], FACES[side], axis=1), cell


def ring(tets: Ints, cells: npt.NDArray[np.bool_], vertices: int) -> npt.NDArray[np.bool_]:
    """Add the cells that share a vertex with given ones.

    Parameters
    ----------
    tets : (m, 4) int array
    cells : (m,) bool array
    vertices : int
        Number of vertices.

    Returns
    -------
    (m,) bool array
    """
    touched = np.zeros(vertices, dtype=bool)
    touched[tets[cells]] = True
    return np.asarray(touched[tets].any(axis=1))


def cells_at_vertices(tets: Ints, vertices: int) -> tuple[Ints, Ints]:
    """List the tetrahedra at each vertex.

    Parameters
    ----------
    tets : (m, 4) int array
    vertices : int
        Number of vertices.

    Returns
    -------
    first : (vertices + 1,) int array
    cells : (4 m,) int array
        Vertex v has ``cells[first[v]:first[v + 1]]``.
    """
    order = np.argsort(tets.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(np.bincount(tets.ravel(), minlength=vertices))])
    return first.astype(np.int64), (order // 4).astype(np.int64)
