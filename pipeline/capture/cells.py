"""The air in tetrahedra with its velocity at ten nodes each: from cell to cell by faces, and the velocity in one."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import NamedTuple

import numpy as np

from pipeline.geometry.cells import matched_pairs
from pipeline.geometry.compiled import compiled
from pipeline.geometry.tets import FACES, volumes
from pipeline.nouns.arrays import Bools, Floats, Ints

_OPPOSITE = np.array([3, 2, 1, 0])
"""The vertex that lies against each of `FACES`."""

_EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
"""Ends of the edge that nodes 4 to 9 of a tetrahedron stand on, as VTK orders them."""

_OUTSIDE = -1e-9
"""A barycentric coordinate below this lies behind the face; above it rounding alone may have put it there."""


class Cells(NamedTuple):
    """Tetrahedra of second order as the walk and the velocity need them.

    Parameters
    ----------
    inverse : (m, 3, 3) array [1/m]
        Barycentric coordinates 1 to 3 of a place are this times its way from vertex 0.
    origin : (m, 3) array [m]
        Vertex 0.
    neighbor : (m, 4) int array
        Cell behind the face against each vertex; -1 where there is none.
    nodes : (m, 10) int array
        Four vertices, then the middles of the edges 01, 12, 02, 03, 13, 23.
    position : (n, 3) array [m]
        Of the nodes; those of curved edges lie on the true fibers.
    curved : (m,) bool array
        Whether an edge's middle is not halfway between its ends.
    velocity : (n, 3) array [m/s]
    size : (m,) array [m]
        Edge of the regular tetrahedron of the same volume.
    near : (i, j, k) int array
        A cell near each cube of a grid over the box.
    lower : (3,) array [m]
        Corner of the grid.
    cube : (3,) array [m]
        Extent of a cube.
    """

    inverse: Floats
    origin: Floats
    neighbor: Ints
    nodes: Ints
    position: Floats
    curved: Bools
    velocity: Floats
    size: Floats
    near: Ints
    lower: Floats
    cube: Floats


def cells_of(nodes: Ints, position: Floats, velocity: Floats) -> Cells:
    """Prepare a mesh and the velocity at its nodes for tracking.

    Parameters
    ----------
    nodes : (m, 10) int array
        As in `Cells`; the tetrahedra of the vertices are positive.
    position, velocity : (n, 3) arrays [m], [m/s]

    Returns
    -------
    Cells
    """
    from scipy.spatial import cKDTree

    tets = nodes[:, :4]
    corners = position[tets]
    sides = corners[:, 1:] - corners[:, :1]
    # rows are the sides: a place is origin + sides^T (l1, l2, l3)
    inverse = np.linalg.inv(np.swapaxes(sides, 1, 2))
    middle = 0.5 * (position[nodes[:, _EDGES[:, 0]]] + position[nodes[:, _EDGES[:, 1]]])
    size = (6.0 * math.sqrt(2.0) * volumes(position, tets)) ** (1.0 / 3.0)
    off = np.linalg.norm(position[nodes[:, 4:]] - middle, axis=2).max(axis=1)
    triangles = tets[:, FACES].reshape(-1, 3)
    first, second = matched_pairs(triangles)
    flat = np.full(4 * len(tets), -1)
    flat[first], flat[second] = second // 4, first // 4
    neighbor = np.empty((len(tets), 4), np.int64)
    neighbor[:, _OPPOSITE] = flat.reshape(-1, 4)
    lower, upper = position[tets].min(axis=(0, 1)), position[tets].max(axis=(0, 1))
    shape = _grid_shape(upper - lower, len(tets))
    cube = (upper - lower) / shape
    centers = np.stack(np.meshgrid(*(np.arange(n) + 0.5 for n in shape), indexing="ij"), axis=-1) * cube + lower
    near = cKDTree(corners.mean(axis=1)).query(centers.reshape(-1, 3))[1].reshape(shape)
    return Cells(
        inverse=np.ascontiguousarray(inverse),
        origin=np.ascontiguousarray(corners[:, 0]),
        neighbor=neighbor,
        nodes=np.ascontiguousarray(nodes),
        position=np.ascontiguousarray(position),
        curved=off > 1e-6 * size,
        velocity=np.ascontiguousarray(velocity),
        size=size,
        near=np.ascontiguousarray(near, dtype=np.int64),
        lower=lower,
        cube=cube,
    )


def _grid_shape(extent: Floats, cells: int) -> Ints:
    edge = (float(np.prod(extent)) / cells) ** (1.0 / 3.0)
    shape: Ints = np.maximum(np.round(extent / (2.0 * edge)), 1).astype(np.int64)
    return shape


@compiled
def near_cell(x: float, y: float, z: float, cells: Cells) -> int:
    """Give a cell near a place, from which the walk to it starts."""
    i = min(max(int((x - cells.lower[0]) / cells.cube[0]), 0), cells.near.shape[0] - 1)
    j = min(max(int((y - cells.lower[1]) / cells.cube[1]), 0), cells.near.shape[1] - 1)
    k = min(max(int((z - cells.lower[2]) / cells.cube[2]), 0), cells.near.shape[2] - 1)
    return int(cells.near[i, j, k])


@compiled
def shares(x: float, y: float, z: float, cell: int, cells: Cells) -> tuple[float, float, float, float]:
    """Give the barycentric coordinates of a place in a cell with straight edges."""
    m, o = cells.inverse[cell], cells.origin[cell]
    dx, dy, dz = x - o[0], y - o[1], z - o[2]
    b = m[0, 0] * dx + m[0, 1] * dy + m[0, 2] * dz
    c = m[1, 0] * dx + m[1, 1] * dy + m[1, 2] * dz
    d = m[2, 0] * dx + m[2, 1] * dy + m[2, 2] * dz
    return 1.0 - b - c - d, b, c, d


@compiled
def walked(x: float, y: float, z: float, cell: int, cells: Cells) -> tuple[int, bool]:
    """Walk from a cell to the one that holds a place.

    Returns
    -------
    cell : int
        The one that holds it; where none is reached, the last one on the way, at the mesh's wall.
    inside : bool
    """
    for _ in range(1000):
        a, b, c, d = shares(x, y, z, cell, cells)
        least = min(min(a, b), min(c, d))
        if least >= _OUTSIDE:
            return cell, True
        following, worst = -1, 0.0
        for face in range(4):
            share = a if face == 0 else (b if face == 1 else (c if face == 2 else d))
            if share < min(_OUTSIDE, worst) and cells.neighbor[cell, face] >= 0:
                following, worst = cells.neighbor[cell, face], share
        if following < 0:
            return cell, False
        cell = following
    return cell, False


@compiled
def velocity_in(x: float, y: float, z: float, cell: int, cells: Cells) -> tuple[float, float, float]:
    """Give the air's velocity at a place of a cell, by its ten nodes; outside the cell, that at its nearest side."""
    a, b, c, d = shares(x, y, z, cell, cells)
    if cells.curved[cell]:
        a, b, c, d = _in_curved(x, y, z, cell, cells, b, c, d)
    if min(min(a, b), min(c, d)) < 0.0:
        a, b, c, d = max(a, 0.0), max(b, 0.0), max(c, 0.0), max(d, 0.0)
        total = a + b + c + d
        a, b, c, d = a / total, b / total, c / total, d / total
    return _blended(cells.velocity, cells.nodes[cell], a, b, c, d)


@compiled
def inflow(places: Floats, cells: Cells) -> Floats:
    """Give the air's velocity along z at places [m] of the mesh, (n,) array [m/s]."""
    result = np.empty(len(places))
    for n in range(len(places)):
        x, y, z = places[n, 0], places[n, 1], places[n, 2]
        cell, _ = walked(x, y, z, near_cell(x, y, z, cells), cells)
        result[n] = velocity_in(x, y, z, cell, cells)[2]
    return result


@compiled
def _blended(values: Floats, nodes: Ints, a: float, b: float, c: float, d: float) -> tuple[float, float, float]:
    u, v, w = 0.0, 0.0, 0.0
    for n in range(10):
        if n == 0:
            share = a * (2.0 * a - 1.0)
        elif n == 1:
            share = b * (2.0 * b - 1.0)
        elif n == 2:
            share = c * (2.0 * c - 1.0)
        elif n == 3:
            share = d * (2.0 * d - 1.0)
        elif n == 4:
            share = 4.0 * a * b
        elif n == 5:
            share = 4.0 * b * c
        elif n == 6:
            share = 4.0 * a * c
        elif n == 7:
            share = 4.0 * a * d
        elif n == 8:
            share = 4.0 * b * d
        else:
            share = 4.0 * c * d
        node = nodes[n]
        u += share * values[node, 0]
        v += share * values[node, 1]
        w += share * values[node, 2]
    return u, v, w


@compiled
def _in_curved(
    x: float, y: float, z: float, cell: int, cells: Cells, b: float, c: float, d: float
) -> tuple[float, float, float, float]:
    # edges bend by a few hundredths of their length: the straight cell's inverse serves as the slope
    m = cells.inverse[cell]
    for _ in range(4):
        px, py, pz = _blended(cells.position, cells.nodes[cell], 1.0 - b - c - d, b, c, d)
        dx, dy, dz = x - px, y - py, z - pz
        b += m[0, 0] * dx + m[0, 1] * dy + m[0, 2] * dz
        c += m[1, 0] * dx + m[1, 1] * dy + m[1, 2] * dz
        d += m[2, 0] * dx + m[2, 1] * dy + m[2, 2] * dz
    return 1.0 - b - c - d, b, c, d
