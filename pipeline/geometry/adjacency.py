"""Which tetrahedra meet at a face, and which at a vertex. Compiled by numba: imported only where a mesh is made."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled, compiled_for_threads
from pipeline.geometry.tets import FACES, Cells, Numbers
from pipeline.geometry.threads import in_parts
from pipeline.geometry.triangles import Floats, Ints

Keys = npt.NDArray[np.int64]


def neighbors(tets: Numbers) -> Cells:
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
    cells = np.ascontiguousarray(tets, np.int32)
    vertices = int(cells.max(initial=-1)) + 1
    # a face is looked for among those whose lowest corner is the same: some twenty
    first, faces, keys = _faces_at_vertices(cells, vertices)
    across = np.full(cells.shape, -1, np.int32)
    crowded = np.zeros(vertices, np.int32)
    in_parts(lambda begin, end: _match(first, faces, keys, across, crowded, begin, end), vertices)
    if crowded.any():
        raise ValueError(f"{int(crowded.sum())} faces belong to more than two cells")
    return across


@compiled
def _faces_at_vertices(tets: Cells, vertices: int) -> tuple[Ints, Cells, Keys]:
    """Sort the faces by their lowest corner: first face of each vertex, faces, and the other two corners of each."""
    first = np.zeros(vertices + 1, np.int64)
    for cell in range(len(tets)):
        for side in range(4):
            first[min(tets[cell, FACES[side, 0]], tets[cell, FACES[side, 1]], tets[cell, FACES[side, 2]]) + 1] += 1
    for vertex in range(vertices):
        first[vertex + 1] += first[vertex]
    following = first[:-1].copy()
    faces = np.empty(4 * len(tets), np.int32)
    keys = np.empty(4 * len(tets), np.int64)
    for cell in range(len(tets)):
        for side in range(4):
            a = np.int64(tets[cell, FACES[side, 0]])
            b = np.int64(tets[cell, FACES[side, 1]])
            c = np.int64(tets[cell, FACES[side, 2]])
            low, high = min(a, b, c), max(a, b, c)
            place = following[low]
            following[low] += 1
            faces[place] = 4 * cell + side
            keys[place] = (a + b + c - low - high) * vertices + high
    return first, faces, keys


@compiled_for_threads
def _match(first: Ints, faces: Cells, keys: Keys, across: Cells, crowded: Cells, begin: int, end: int) -> None:
    """Pair the faces of some vertices that have the same other corners."""
    for vertex in range(begin, end):
        for one in range(first[vertex] + 1, first[vertex + 1]):
            for two in range(first[vertex], one):
                if keys[one] == keys[two]:
                    a, b = faces[one], faces[two]
                    crowded[vertex] += across[b // 4, b % 4] >= 0
                    across[a // 4, a % 4] = b // 4
                    across[b // 4, b % 4] = a // 4
                    break


@compiled
def largest_part_of(across: Cells) -> npt.NDArray[np.bool_]:
    """Find the cells of the largest part of a mesh, parts being joined through faces.

    Parameters
    ----------
    across : (m, 4) int array
        As `neighbors` gives it.

    Returns
    -------
    (m,) bool array
    """
    part = np.full(len(across), -1, np.int32)
    waiting = np.empty(len(across), np.int32)
    parts, best, most = 0, -1, 0
    for start in range(len(across)):
        if part[start] >= 0:
            continue
        part[start] = parts
        waiting[0] = start
        count, size = 1, 0
        while count:
            count -= 1
            cell = waiting[count]
            size += 1
            for side in range(4):
                other = across[cell, side]
                if other >= 0 and part[other] < 0:
                    part[other] = parts
                    waiting[count] = other
                    count += 1
        if size > most:
            best, most = parts, size
        parts += 1
    largest: npt.NDArray[np.bool_] = part == best
    return largest


def boundary_of(tets: Numbers, across: Cells) -> tuple[Ints, Ints]:
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
    return corners_of(tets, cell, side), cell


def corners_of(tets: Numbers, cell: Ints, side: Ints) -> Ints:
    """Give the corners of some faces, counterclockwise seen from outside their cell, (k, 3) int array."""
    return np.take_along_axis(tets[cell], FACES[side], axis=1).astype(np.int64)


def ring(tets: Cells, cells: npt.NDArray[np.bool_], vertices: int) -> npt.NDArray[np.bool_]:
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
    return touching(tets, touched)


def touching(tets: Cells, chosen: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Find the cells that have one of the chosen vertices, (m,) bool array."""
    found = np.zeros(len(tets), dtype=bool)
    in_parts(lambda begin, end: _touching(tets, chosen, found, begin, end), len(tets))
    return found


@compiled_for_threads
def _touching(tets: Cells, chosen: npt.NDArray[np.bool_], found: npt.NDArray[np.bool_], begin: int, end: int) -> None:
    for cell in range(begin, end):
        found[cell] = chosen[tets[cell, 0]] or chosen[tets[cell, 1]] or chosen[tets[cell, 2]] or chosen[tets[cell, 3]]


@compiled
def cells_at_vertices(tets: Cells, vertices: int) -> tuple[Ints, Cells]:
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
        Vertex v has ``cells[first[v]:first[v + 1]]``, in ascending order.
    """
    first = np.zeros(vertices + 1, np.int64)
    for cell in range(len(tets)):
        for k in range(4):
            first[tets[cell, k] + 1] += 1
    for vertex in range(vertices):
        first[vertex + 1] += first[vertex]
    following = first[:-1].copy()
    cells = np.empty(4 * len(tets), np.int32)
    for cell in range(len(tets)):
        for k in range(4):
            vertex = tets[cell, k]
            cells[following[vertex]] = cell
            following[vertex] += 1
    return first, cells


def cell_volumes(points: Floats, tets: Cells) -> Floats:
    """Signed volume of each tetrahedron, as `pipeline.geometry.tets.volumes` gives it, for millions of them.

    Parameters
    ----------
    points : (n, 3) array [m]
    tets : (m, 4) int array

    Returns
    -------
    (m,) array [m3]
    """
    found = np.empty(len(tets))
    in_parts(lambda begin, end: _volumes(points, tets, found, begin, end), len(tets))
    return found


@compiled_for_threads
def _volumes(points: Floats, tets: Cells, found: Floats, begin: int, end: int) -> None:
    for cell in range(begin, end):
        a, b, c, d = tets[cell, 0], tets[cell, 1], tets[cell, 2], tets[cell, 3]
        bx, by, bz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        cx, cy, cz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
        dx, dy, dz = points[d, 0] - points[a, 0], points[d, 1] - points[a, 1], points[d, 2] - points[a, 2]
        found[cell] = ((by * cz - bz * cy) * dx + (bz * cx - bx * cz) * dy + (bx * cy - by * cx) * dz) / 6.0
