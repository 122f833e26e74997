"""Two measures of polyhedra that need loops: how concave a cell is, and how it is cut into tetrahedra."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled, compiled_for_threads
from pipeline.nouns.arrays import Floats, Ints


@compiled_for_threads
def largest_cosines(first: Ints, faces: Ints, signs: Floats, areas: Floats, centers: Floats) -> Floats:
    """Give the largest cosine between a face's normal and the way to the center of another, of each cell.

    Parameters
    ----------
    first : (cells + 1,) int array
        Cell c has the faces ``faces[first[c]:first[c + 1]]``.
    faces : (k,) int array
    signs : (k,) array
        1 where the face's area points out of the cell, else -1.
    areas, centers : (faces, 3) arrays

    Returns
    -------
    (cells,) array [1]
        Below 0 where every face's plane has the others' centers on its inner side; -1 for a cell of one face.
    """
    cells = len(first) - 1
    result = np.full(cells, -1.0)
    for cell in range(cells):
        largest = -1.0
        for i in range(first[cell], first[cell + 1]):
            face = faces[i]
            ax, ay, az = areas[face, 0], areas[face, 1], areas[face, 2]
            size = signs[i] / max(np.sqrt(ax * ax + ay * ay + az * az), 1e-300)
            for j in range(first[cell], first[cell + 1]):
                if j == i:
                    continue
                other = faces[j]
                dx = centers[other, 0] - centers[face, 0]
                dy = centers[other, 1] - centers[face, 1]
                dz = centers[other, 2] - centers[face, 2]
                way = max(np.sqrt(dx * dx + dy * dy + dz * dz), 1e-300)
                largest = max(largest, (dx * ax + dy * ay + dz * az) * size / way)
        result[cell] = largest
    return result


@compiled_for_threads
def smallest_tets(
    points: Floats,
    corners: Ints,
    offsets: Ints,
    owner: Ints,
    neighbour: Ints,
    centers: Floats,
    cell_centers: Floats,
    volumes: Floats,
) -> Floats:
    """Give the smallest volume of the tetrahedra into which the cells at a face are cut there, over a cell's volume.

    They are cut from each edge of the face to its center and the cell's; and from the cell's center to the triangles
    of a fan about a corner, the best that the face has.

    Parameters
    ----------
    points, corners, offsets, owner, neighbour
        As in `pipeline.nouns.mesh.FaceMesh`.
    centers, cell_centers : (faces, 3) and (cells, 3) arrays [m]
    volumes : (cells,) array [m3]

    Returns
    -------
    (faces,) array [1]
    """
    faces = len(owner)
    result = np.empty(faces)
    for face in range(faces):
        start, end = offsets[face], offsets[face + 1]
        size = end - start
        smallest = np.inf
        best = -np.inf
        sides = 2 if face < len(neighbour) else 1
        for side in range(sides):
            cell = owner[face] if side == 0 else neighbour[face]
            scale = (1.0 if side == 0 else -1.0) / (6.0 * max(abs(volumes[cell]), 1e-300))
            for k in range(size):
                a, b = corners[start + k], corners[start + (k + 1) % size]
                volume = scale * _six_volumes(cell_centers[cell], points[a], points[b], centers[face])
                smallest = min(smallest, volume)
        for base in range(size):
            worst = np.inf
            for step in range(1, size - 1):
                a, b = corners[start + (base + step) % size], corners[start + (base + step + 1) % size]
                for side in range(sides):
                    cell = owner[face] if side == 0 else neighbour[face]
                    scale = (1.0 if side == 0 else -1.0) / (6.0 * max(abs(volumes[cell]), 1e-300))
                    apex = cell_centers[cell]
                    worst = min(worst, scale * _six_volumes(apex, points[corners[start + base]], points[a], points[b]))
            best = max(best, worst)
            # one corner that does is enough, as for checkMesh
            if worst > 0.0:
                break
        result[face] = min(smallest, best)
    return result


@compiled
def _six_volumes(apex: Floats, a: Floats, b: Floats, c: Floats) -> float:
    """Six times the signed volume of a tetrahedron, above 0 where a, b, c go round counterclockwise seen from afar."""
    ax, ay, az = a[0] - apex[0], a[1] - apex[1], a[2] - apex[2]
    bx, by, bz = b[0] - apex[0], b[1] - apex[1], b[2] - apex[2]
    cx, cy, cz = c[0] - apex[0], c[1] - apex[1], c[2] - apex[2]
    volume: float = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return volume
