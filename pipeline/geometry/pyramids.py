"""Loops over polygons and over the pyramids between them and the middles of cells.

Compiled by numba: imported only where a mesh is measured.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled, compiled_for_threads
from pipeline.geometry.tets import Cells
from pipeline.geometry.triangles import Floats, Ints
from pipeline.geometry.vectors import cross, dot, length, minus, row


@compiled
def faces_of_cells(owner: Ints, neighbour: Ints, cells: int) -> tuple[Ints, Cells]:
    """List the faces of each cell.

    Parameters
    ----------
    owner, neighbour : (faces,) and (internal,) int arrays
        As in `pipeline.nouns.mesh.FaceMesh`.
    cells : int

    Returns
    -------
    first : (cells + 1,) int array
    faces : (faces + internal,) int array
        Cell c has ``faces[first[c]:first[c + 1]]``: f where it owns face f, and then ``-1 - f`` where it is the
        neighbour.
    """
    first = np.zeros(cells + 1, np.int64)
    for face in range(len(owner)):
        first[owner[face] + 1] += 1
    for face in range(len(neighbour)):
        first[neighbour[face] + 1] += 1
    for cell in range(cells):
        first[cell + 1] += first[cell]
    following = first[:-1].copy()
    faces = np.empty(len(owner) + len(neighbour), np.int32)
    for face in range(len(owner)):
        faces[following[owner[face]]] = face
        following[owner[face]] += 1
    for face in range(len(neighbour)):
        faces[following[neighbour[face]]] = -1 - face
        following[neighbour[face]] += 1
    return first, faces


@compiled_for_threads
def measure_polygons(
    points: Floats, corners: Ints, offsets: Ints, areas: Floats, centers: Floats, begin: int, end: int
) -> None:
    """Fill in the area vectors and centers of some polygons, as `pipeline.geometry.polyhedra.polygons` gives them."""
    for face in range(begin, end):
        start, size = offsets[face], offsets[face + 1] - offsets[face]
        x = y = z = 0.0
        for k in range(size):
            corner = corners[start + k]
            x += points[corner, 0]
            y += points[corner, 1]
            z += points[corner, 2]
        middle = (x / size, y / size, z / size)
        if size == 3:
            a = row(points, corners[start])
            normal = cross(minus(row(points, corners[start + 1]), a), minus(row(points, corners[start + 2]), a))
            for axis in range(3):
                areas[face, axis] = 0.5 * normal[axis]
                centers[face, axis] = middle[axis]
            continue
        total = 0.0
        areas[face] = 0.0
        centers[face] = 0.0
        for k in range(size):
            a, b = row(points, corners[start + k]), row(points, corners[start + (k + 1) % size])
            normal = cross(minus(b, a), minus(middle, a))
            weight = length(normal)
            total += weight
            for axis in range(3):
                areas[face, axis] += 0.5 * normal[axis]
                centers[face, axis] += weight * (a[axis] + b[axis] + middle[axis])
        for axis in range(3):
            centers[face, axis] = centers[face, axis] / (3.0 * total) if total > 0.0 else middle[axis]


@compiled_for_threads
def measure_cells(
    first: Ints,
    faces: Cells,
    areas: Floats,
    centers: Floats,
    cell_centers: Floats,
    volumes: Floats,
    begin: int,
    end: int,
) -> None:
    """Fill in the centers and volumes of some cells, as `pipeline.geometry.polyhedra.polyhedra` gives them."""
    for cell in range(begin, end):
        count = max(first[cell + 1] - first[cell], 1)
        x = y = z = 0.0
        for k in range(first[cell], first[cell + 1]):
            face = faces[k] if faces[k] >= 0 else -1 - faces[k]
            x += centers[face, 0]
            y += centers[face, 1]
            z += centers[face, 2]
        middle = (x / count, y / count, z / count)
        total = 0.0
        x = y = z = 0.0
        for k in range(first[cell], first[cell + 1]):
            face, sign = (faces[k], 1.0) if faces[k] >= 0 else (-1 - faces[k], -1.0)
            center = row(centers, face)
            pyramid = sign * dot(row(areas, face), minus(center, middle))
            total += pyramid
            x += pyramid * (0.75 * center[0] + 0.25 * middle[0])
            y += pyramid * (0.75 * center[1] + 0.25 * middle[1])
            z += pyramid * (0.75 * center[2] + 0.25 * middle[2])
        volumes[cell] = total / 3.0
        moment = (x, y, z)
        for axis in range(3):
            cell_centers[cell, axis] = moment[axis] / total if total != 0.0 else middle[axis]
