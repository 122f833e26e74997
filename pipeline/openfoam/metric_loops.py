"""Loops behind `pipeline.openfoam.metrics`: each fills in its metric of some faces or cells.

Compiled by numba: imported only where a mesh is measured.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import NamedTuple

from pipeline.geometry.compiled import compiled_for_threads
from pipeline.geometry.tets import Cells
from pipeline.geometry.vectors import Vector, cross, dot, length, minus, row, symmetric_determinant
from pipeline.nouns.arrays import Bools, Floats, Ints
from pipeline.openfoam.metrics import TINY


class Measured(NamedTuple):
    """A mesh with its geometry, the way that loops read it.

    Parameters
    ----------
    points, corners, offsets, owner, neighbour
        As in `pipeline.nouns.mesh.FaceMesh`.
    areas, centers, cell_centers, volumes, first, faces
        As in `pipeline.geometry.polyhedra.Polyhedra`.
    lively : (3,) bool array
        As `pipeline.openfoam.metrics.directions` gives it.
    inner : (faces,) bool array
        Whether there is a cell on both sides, be it through a cyclic patch.
    """

    points: Floats
    corners: Ints
    offsets: Ints
    owner: Ints
    neighbour: Ints
    areas: Floats
    centers: Floats
    cell_centers: Floats
    volumes: Floats
    first: Ints
    faces: Cells
    lively: Bools
    inner: Bools


@compiled_for_threads
def _between(mesh: Measured, face: int) -> Vector:
    return minus(row(mesh.cell_centers, mesh.neighbour[face]), row(mesh.cell_centers, mesh.owner[face]))


@compiled_for_threads
def non_orthogonality(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Angle between S and d."""
    for face in range(begin, end):
        between, area = _between(mesh, face), row(mesh.areas, face)
        cosine = dot(between, area) / (length(between) * length(area) + TINY)
        found[face] = math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))


@compiled_for_threads
def skewness(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Offset of f from where d pierces the face, over the face's extent that way."""
    for face in range(begin, end):
        area, center = row(mesh.areas, face), row(mesh.centers, face)
        to_face = minus(center, row(mesh.cell_centers, mesh.owner[face]))
        if face < len(mesh.neighbour):
            between = _between(mesh, face)
            share = 0.2
        else:
            size = length(area) + TINY
            normal = (area[0] / size, area[1] / size, area[2] / size)
            height = dot(normal, to_face)
            between = (height * normal[0], height * normal[1], height * normal[2])
            share = 0.4
        reach = dot(area, to_face) / (dot(area, between) + TINY)
        aside = minus(to_face, (reach * between[0], reach * between[1], reach * between[2]))
        size = length(aside)
        along = (aside[0] / (size + TINY), aside[1] / (size + TINY), aside[2] / (size + TINY))
        extent = share * length(between) + TINY
        for k in range(mesh.offsets[face], mesh.offsets[face + 1]):
            extent = max(extent, abs(dot(along, minus(row(mesh.points, mesh.corners[k]), center))))
        found[face] = size / extent


@compiled_for_threads
def face_weight(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Distance of the nearer cell's center from the face over the sum of both."""
    for face in range(begin, end):
        area, center = row(mesh.areas, face), row(mesh.centers, face)
        own = abs(dot(area, minus(center, row(mesh.cell_centers, mesh.owner[face]))))
        other = abs(dot(area, minus(row(mesh.cell_centers, mesh.neighbour[face]), center)))
        found[face] = min(own, other) / (own + other + TINY)


@compiled_for_threads
def volume_ratio(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Smaller over larger volume of the two cells of a face."""
    for face in range(begin, end):
        own, other = abs(mesh.volumes[mesh.owner[face]]), abs(mesh.volumes[mesh.neighbour[face]])
        found[face] = min(own, other) / (max(own, other) + TINY)


@compiled_for_threads
def face_area(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Area."""
    for face in range(begin, end):
        found[face] = length(row(mesh.areas, face))


@compiled_for_threads
def face_pyramid(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Smaller volume of the pyramids from a face to its cells' centers, over V."""
    for face in range(begin, end):
        area, center, own = row(mesh.areas, face), row(mesh.centers, face), mesh.owner[face]
        share = dot(area, minus(center, row(mesh.cell_centers, own))) / (3.0 * (abs(mesh.volumes[own]) + TINY))
        if face < len(mesh.neighbour):
            other = mesh.neighbour[face]
            beyond = dot(area, minus(row(mesh.cell_centers, other), center))
            share = min(share, beyond / (3.0 * (abs(mesh.volumes[other]) + TINY)))
        found[face] = share


@compiled_for_threads
def _sum_of_areas(mesh: Measured, cell: int) -> Vector:
    x = y = z = 0.0
    for k in range(mesh.first[cell], mesh.first[cell + 1]):
        area = row(mesh.areas, _face(mesh, k))
        x += abs(area[0])
        y += abs(area[1])
        z += abs(area[2])
    return (x, y, z)


@compiled_for_threads
def _face(mesh: Measured, k: int) -> int:
    face: int = mesh.faces[k]
    return face if face >= 0 else -1 - face


@compiled_for_threads
def aspect_ratio(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Larger of a_max / a_min and (a_x + a_y + a_z) / (6 V^(2/3)); of a flat mesh a_max / a_min."""
    flat = not (mesh.lively[0] and mesh.lively[1] and mesh.lively[2])
    for cell in range(begin, end):
        total = _sum_of_areas(mesh, cell)
        largest, smallest = 0.0, math.inf
        for axis in range(3):
            if mesh.lively[axis]:
                largest, smallest = max(largest, total[axis]), min(smallest, total[axis])
        if smallest == math.inf:
            found[cell] = 1.0
            continue
        sides = largest / (smallest + TINY)
        surface = (total[0] + total[1] + total[2]) / 6.0 / max(mesh.volumes[cell], TINY) ** (2.0 / 3.0)
        found[cell] = sides if flat else max(sides, surface)


@compiled_for_threads
def openness(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Largest component of the sum of S over that of abs(S)."""
    for cell in range(begin, end):
        x = y = z = 0.0
        for k in range(mesh.first[cell], mesh.first[cell + 1]):
            sign, area = 1.0 if mesh.faces[k] >= 0 else -1.0, row(mesh.areas, _face(mesh, k))
            x += sign * area[0]
            y += sign * area[1]
            z += sign * area[2]
        total = _sum_of_areas(mesh, cell)
        found[cell] = max(abs(x) / (total[0] + TINY), abs(y) / (total[1] + TINY), abs(z) / (total[2] + TINY))


@compiled_for_threads
def determinant(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """``det(sum(S S) / (mean of |S|)^2) / 8`` over a cell's internal faces."""
    flat = not (mesh.lively[0] and mesh.lively[1] and mesh.lively[2])
    for cell in range(begin, end):
        xx = xy = xz = yy = yz = zz = size = 0.0
        count = 0
        for k in range(mesh.first[cell], mesh.first[cell + 1]):
            face = _face(mesh, k)
            if not mesh.inner[face]:
                continue
            x, y, z = row(mesh.areas, face)
            xx += x * x
            xy += x * y
            xz += x * z
            yy += y * y
            yz += y * z
            zz += z * z
            size += length((x, y, z))
            count += 1
        scale = (size / max(count, 1)) ** 2 + TINY
        xx, xy, xz, yy, yz, zz = xx / scale, xy / scale, xz / scale, yy / scale, yz / scale, zz / scale
        if flat and count:
            # the one direction that the mesh lacks
            xx = xx if mesh.lively[0] else 1.0
            yy = yy if mesh.lively[1] else 1.0
            zz = zz if mesh.lively[2] else 1.0
        found[cell] = abs(symmetric_determinant(xx, xy, xz, yy, yz, zz)) / 8.0


@compiled_for_threads
def concavity(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Largest cosine between a face's normal and the way to the center of another; -1 for a cell of one face."""
    for cell in range(begin, end):
        largest = -1.0
        for i in range(mesh.first[cell], mesh.first[cell + 1]):
            face = _face(mesh, i)
            area, center = row(mesh.areas, face), row(mesh.centers, face)
            size = (1.0 if mesh.faces[i] >= 0 else -1.0) / max(length(area), 1e-300)
            for j in range(mesh.first[cell], mesh.first[cell + 1]):
                if j != i:
                    way = minus(row(mesh.centers, _face(mesh, j)), center)
                    largest = max(largest, dot(way, area) * size / max(length(way), 1e-300))
        found[cell] = largest


@compiled_for_threads
def face_tets(mesh: Measured, found: Floats, begin: int, end: int) -> None:
    """Smallest of the tetrahedra that the cells at a face are cut into there, over a cell's volume.

    They are cut from each edge of the face to its center and the cell's; and from the cell's center to the triangles
    of a fan about a corner, the best that the face has.
    """
    for face in range(begin, end):
        start, size = mesh.offsets[face], mesh.offsets[face + 1] - mesh.offsets[face]
        center = row(mesh.centers, face)
        own, inner = mesh.owner[face], face < len(mesh.neighbour)
        other = mesh.neighbour[face] if inner else own
        apexes = row(mesh.cell_centers, own), row(mesh.cell_centers, other)
        # beyond the face the same triangle goes round the other way; on the boundary there is only one cell
        scales = _over_volume(mesh.volumes[own]), -_over_volume(mesh.volumes[other]) if inner else 0.0
        smallest, best = math.inf, -math.inf
        a = row(mesh.points, mesh.corners[start + size - 1])
        for k in range(start, start + size):
            b = row(mesh.points, mesh.corners[k])
            smallest = min(smallest, _smaller_tet(apexes, scales, a, b, center))
            a = b
        for base in range(size):
            corner, worst = row(mesh.points, mesh.corners[start + base]), math.inf
            for step in range(1, size - 1):
                one, two = base + step, base + step + 1
                a = row(mesh.points, mesh.corners[start + (one if one < size else one - size)])
                b = row(mesh.points, mesh.corners[start + (two if two < size else two - size)])
                worst = min(worst, _smaller_tet(apexes, scales, corner, a, b))
            best = max(best, worst)
            # one corner that does is enough, as for checkMesh
            if worst > 0.0:
                break
        found[face] = min(smallest, best)


@compiled_for_threads
def _over_volume(volume: float) -> float:
    return 1.0 / (6.0 * max(abs(volume), 1e-300))


@compiled_for_threads
def _smaller_tet(apexes: tuple[Vector, Vector], scales: tuple[float, float], a: Vector, b: Vector, c: Vector) -> float:
    """Smaller tetrahedron between a triangle of a face and the centers of its cells, over the cell's volume."""
    smaller = scales[0] * _six_volumes(apexes[0], a, b, c)
    return min(smaller, scales[1] * _six_volumes(apexes[1], a, b, c)) if scales[1] != 0.0 else smaller


@compiled_for_threads
def _six_volumes(apex: Vector, a: Vector, b: Vector, c: Vector) -> float:
    """Six times the signed volume of a tetrahedron, above 0 where a, b, c go round counterclockwise seen from afar."""
    return dot(minus(a, apex), cross(minus(b, apex), minus(c, apex)))
