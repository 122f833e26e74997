r"""Tetrahedra that fill the cubes of an octree and fit each other across its levels.

Between two cubes of one size stand the four tetrahedra of the body-centered cubic lattice, around the line between
their centers: congruent, their centers equidistant from their faces, so that a finite-volume solver sees a perfectly
orthogonal mesh. Toward a smaller or larger neighbor, and toward the box's planes, a cube ends in pyramids from its
center to its face, cut into tetrahedra that fit (Labelle & Shewchuk, Isosurface Stuffing, ACM TOG 26:57, 2007).

Corners of cubes have even coordinates on the *lattice*, whose unit is half the edge of the smallest cube: so the center
of every cube, and the middle of every face and edge, is a lattice point as well.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.keys import KeyTable, add, empty_table, row_of
from pipeline.geometry.tets import Cells
from pipeline.geometry.triangles import Floats, Ints
from pipeline.mesh.engines.lattice.octree import Octree

_CORNERS = np.array([[-1, -1], [0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0]])
"""Corners of a square and the middles of its sides, in turn, about its center."""


@dataclass(frozen=True, eq=False, slots=True)
class LatticeVertices:
    """The vertices of the tetrahedra of an octree.

    Parameters
    ----------
    places : (n, 3) int array
        Lattice coordinates.
    width : (n,) int array
        Edge of the smallest cube at each, in smallest cubes.
    center : (cubes,) int array
        Vertex at the center of each cube.
    table : KeyTable
        Vertex at a lattice point.
    """

    places: Ints
    width: Ints
    center: Ints
    table: KeyTable


def lattice_vertices(tree: Octree) -> LatticeVertices:
    """Find the corners and centers of an octree's cubes, and the centers of their faces on the box's planes.

    Parameters
    ----------
    tree : Octree

    Returns
    -------
    LatticeVertices
    """
    return LatticeVertices(*_vertices(tree.low, tree.level, tree.counts))


def lattice_tetrahedra(tree: Octree, vertices: LatticeVertices, air: Floats) -> Cells:
    """Fill the cubes with tetrahedra, but for those without air.

    Parameters
    ----------
    tree : Octree
    vertices : LatticeVertices
    air : (n,) array
        Distance of each vertex from the fibers; tetrahedra with none above 0 are left out.

    Returns
    -------
    (m, 4) int32 array
        Positive.
    """
    arguments = (tree.low, tree.level, tree.counts, vertices.places, vertices.center, vertices.table, air)
    count = _fill(*arguments, np.empty((0, 4), np.int32))
    tets = np.empty((count, 4), np.int32)
    _fill(*arguments, tets)
    return tets


@compiled
def _key(x: int, y: int, z: int, counts: Ints) -> int:
    return int((x * (2 * counts[1] + 1) + y) * (2 * counts[2] + 1) + z)


@compiled
def _vertices(low: Ints, level: Ints, counts: Ints) -> tuple[Ints, Ints, Ints, KeyTable]:
    cubes = len(low)
    table = empty_table(3 * cubes + 1000)
    places = np.empty((3 * cubes + 1000, 3), np.int64)
    width = np.empty(len(places), np.int64)
    center = np.empty(cubes, np.int64)
    count = 0
    for n in range(cubes):
        size = 1 << level[n]
        # corners, center, and the centers of faces on the box's planes
        for corner in range(15):
            if corner < 8:
                x = 2 * low[n, 0] + (2 * size if corner & 4 else 0)
                y = 2 * low[n, 1] + (2 * size if corner & 2 else 0)
                z = 2 * low[n, 2] + (2 * size if corner & 1 else 0)
            else:
                x, y, z = 2 * low[n, 0] + size, 2 * low[n, 1] + size, 2 * low[n, 2] + size
                if corner > 8:
                    axis, shift = (corner - 9) // 2, size if corner % 2 else -size
                    x, y, z = x + (axis == 0) * shift, y + (axis == 1) * shift, z + (axis == 2) * shift
                    place = x if axis == 0 else y if axis == 1 else z
                    if place != 0 and place != 2 * counts[axis]:
                        continue
            if count == len(places):
                # more of them than usual, as in a box of few cubes: a larger table
                grown = empty_table(2 * count)
                for k in range(count):
                    add(grown, _key(places[k, 0], places[k, 1], places[k, 2], counts), k)
                table = grown
                places = np.concatenate((places, np.empty_like(places)))
                width = np.concatenate((width, np.empty_like(width)))
            row = add(table, _key(x, y, z, counts), count)
            if row == count:
                places[row, 0], places[row, 1], places[row, 2] = x, y, z
                width[row] = size
                count += 1
            else:
                width[row] = min(width[row], size)
            if corner == 8:
                center[n] = row
    return places[:count].copy(), width[:count].copy(), center, table


@compiled
def _emit(tets: Cells, count: int, places: Ints, air: Floats, a: int, b: int, c: int, d: int) -> int:
    if air[a] <= 0.0 and air[b] <= 0.0 and air[c] <= 0.0 and air[d] <= 0.0:
        return count
    if len(tets):
        bx, by, bz = places[b, 0] - places[a, 0], places[b, 1] - places[a, 1], places[b, 2] - places[a, 2]
        cx, cy, cz = places[c, 0] - places[a, 0], places[c, 1] - places[a, 1], places[c, 2] - places[a, 2]
        dx, dy, dz = places[d, 0] - places[a, 0], places[d, 1] - places[a, 1], places[d, 2] - places[a, 2]
        positive = (by * cz - bz * cy) * dx + (bz * cx - bx * cz) * dy + (bx * cy - by * cx) * dz > 0
        tets[count, 0], tets[count, 1] = (a, b) if positive else (b, a)
        tets[count, 2], tets[count, 3] = c, d
    return count + 1


@compiled
def _fill(
    low: Ints, level: Ints, counts: Ints, places: Ints, center: Ints, table: KeyTable, air: Floats, tets: Cells
) -> int:
    """Write the tetrahedra at the faces of all cubes into an array with room for them; give their number."""
    is_center = np.zeros(len(places), np.bool_)
    is_center[center] = True
    around = np.empty(8, np.int64)
    count = 0
    for n in range(len(low)):
        size = 1 << level[n]
        mine = center[n]
        for axis in range(3):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            for side in (-1, 1):
                face = places[mine].copy()
                face[axis] += side * size
                outside = face[axis] == 0 or face[axis] == 2 * counts[axis]
                other = -1
                if not outside:
                    beyond = face.copy()
                    beyond[axis] += side * size
                    other = row_of(table, _key(beyond[0], beyond[1], beyond[2], counts))
                    if other >= 0 and not is_center[other]:
                        other = -1
                if other >= 0 and side < 0:
                    continue  # each pair once, from its lower cube
                for k in range(8):
                    place = face.copy()
                    place[u] += _CORNERS[k, 0] * size
                    place[v] += _CORNERS[k, 1] * size
                    around[k] = row_of(table, _key(place[0], place[1], place[2], counts))
                if other < 0:
                    # a finer neighbor has a vertex at the face's center; on the box's plane there is one too
                    other = row_of(table, _key(face[0], face[1], face[2], counts))
                if other >= 0:
                    for k in range(4):
                        first, half, last = around[2 * k], around[2 * k + 1], around[(2 * k + 2) % 8]
                        if half < 0:
                            count = _emit(tets, count, places, air, mine, other, first, last)
                        else:
                            count = _emit(tets, count, places, air, mine, other, first, half)
                            count = _emit(tets, count, places, air, mine, other, half, last)
                    continue
                # a coarser neighbor's face is four of ours: the diagonal goes to its center, whose coordinates are
                # odd multiples of our edge
                start = 0
                for k in range(4):
                    corner = places[around[2 * k]]
                    if (corner[u] // (2 * size)) % 2 == 1 and (corner[v] // (2 * size)) % 2 == 1:
                        start = k
                a, b = around[2 * start], around[(2 * start + 2) % 8]
                c, d = around[(2 * start + 4) % 8], around[(2 * start + 6) % 8]
                count = _emit(tets, count, places, air, mine, a, b, c)
                count = _emit(tets, count, places, air, mine, a, c, d)
    return count
