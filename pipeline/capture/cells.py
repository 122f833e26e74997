"""The air in tetrahedra with its velocity at ten nodes each: from cell to cell by faces, and the velocity in one."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import NamedTuple

import numpy as np

from pipeline.capture.conservative import EDGES, conserved
from pipeline.geometry.cells import matched_pairs
from pipeline.geometry.compiled import compiled
from pipeline.geometry.tets import FACES, volumes
from pipeline.nouns.arrays import Bools, Floats, Ints

_OPPOSITE = np.array([3, 2, 1, 0])
"""The vertex that lies against each of `FACES`."""

_OUTSIDE = -1e-9
"""A barycentric coordinate below this lies behind the face; above it rounding alone may have put it there."""


_TURNS = 4  # cells with bent faces that a place is looked for in


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
    flux : (m, 10, 3) array
        At the nodes of each cell: the velocity [m/s] where it is straight, the flux density [m3/s] of `Conserved` where
        it is curved; free of divergence.
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
    flux: Floats
    size: Floats
    near: Ints
    lower: Floats
    cube: Floats


def cells_of(
    nodes: Ints, position: Floats, velocity: Floats, through: Floats | None = None, opening: Bools | None = None
) -> Cells:
    """Prepare a mesh and the velocity at its nodes for tracking.

    Parameters
    ----------
    nodes : (m, 10) int array
        As in `Cells`; the tetrahedra of the vertices are positive.
    position, velocity : (n, 3) arrays [m], [m/s]
    through : (m, 4) array [m3/s], optional
        Flux out of the face against each vertex, where it is known.
    opening : (n,) bool array, optional
        Nodes of the openings that take the air which the velocity lacks; those of highest z unless given.

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
    middle = 0.5 * (position[nodes[:, EDGES[:, 0]]] + position[nodes[:, EDGES[:, 1]]])
    size = (6.0 * math.sqrt(2.0) * volumes(position, tets)) ** (1.0 / 3.0)
    off = np.linalg.norm(position[nodes[:, 4:]] - middle, axis=2).max(axis=1)
    triangles = tets[:, FACES].reshape(-1, 3)
    first, second = matched_pairs(triangles)
    flat = np.full(4 * len(tets), -1)
    flat[first], flat[second] = second // 4, first // 4
    neighbor = np.empty((len(tets), 4), np.int64)
    neighbor[:, _OPPOSITE] = flat.reshape(-1, 4)
    if opening is None:
        low, high = position[tets, 2].min(), position[tets, 2].max()
        opening = position[:, 2] >= high - 1e-9 * (high - low)
    at_opening = opening[tets]
    free = (at_opening.sum(axis=1, keepdims=True) - at_opening == 3) & (neighbor < 0)
    wall = (neighbor < 0) & ~free & ~_on_planes(position[tets])
    flux = conserved(nodes, position, velocity, neighbor, free, wall, through).flux
    curved = off > 1e-6 * size
    straight = sides[~curved]
    flux[~curved] = flux[~curved] @ straight / np.linalg.det(straight)[:, None, None]
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
        curved=curved,
        flux=flux,
        size=size,
        near=np.ascontiguousarray(near, dtype=np.int64),
        lower=lower,
        cube=cube,
    )


def _on_planes(corners: Floats) -> Bools:
    """Whether the face against each vertex lies on a plane of the box around all, (m, 4)."""
    lower, upper = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    near = 1e-9 * (upper - lower)
    found = np.zeros(corners.shape[:2], bool)
    for on in (corners <= lower + near, corners >= upper - near):
        found |= (on.sum(axis=1, keepdims=True) - on == 3).any(axis=2)
    return found


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
    if not cells.curved[cell]:
        a, b, c, d = _clipped(a, b, c, d)
        return _blended(cells.flux[cell], a, b, c, d)
    for _ in range(_TURNS):
        b, c, d = _nearer(x, y, z, cell, cells, b, c, d)
        a = 1.0 - b - c - d
        # a bent face is not where the straight cell has it
        face, least = 0, a
        for other, share in ((1, b), (2, c), (3, d)):
            if share < least:
                face, least = other, share
        following = cells.neighbor[cell, face]
        if least >= -1e-6 or following < 0 or not cells.curved[following]:
            break
        cell = following
        a, b, c, d = shares(x, y, z, cell, cells)
    a, b, c, d = _clipped(a, b, c, d)
    u, v, w = _blended(cells.flux[cell], a, b, c, d)
    xx, xy, xz, yx, yy, yz, zx, zy, zz = _columns(cell, cells, b, c, d)
    size = xx * (yy * zz - yz * zy) + xy * (yz * zx - yx * zz) + xz * (yx * zy - yy * zx)
    return (xx * u + yx * v + zx * w) / size, (xy * u + yy * v + zy * w) / size, (xz * u + yz * v + zz * w) / size


@compiled
def _clipped(a: float, b: float, c: float, d: float) -> tuple[float, float, float, float]:
    if min(min(a, b), min(c, d)) >= 0.0:
        return a, b, c, d
    a, b, c, d = max(a, 0.0), max(b, 0.0), max(c, 0.0), max(d, 0.0)
    total = a + b + c + d
    return a / total, b / total, c / total, d / total


@compiled
def velocities(places: Floats, cells: Cells) -> Floats:
    """Give the air's velocity at places [m] of the mesh, (n, 3) array [m/s]."""
    result = np.empty((len(places), 3))
    for n in range(len(places)):
        x, y, z = places[n, 0], places[n, 1], places[n, 2]
        cell, _ = walked(x, y, z, near_cell(x, y, z, cells), cells)
        result[n, 0], result[n, 1], result[n, 2] = velocity_in(x, y, z, cell, cells)
    return result


@compiled
def _blended(values: Floats, a: float, b: float, c: float, d: float) -> tuple[float, float, float]:
    shares = (
        a * (2.0 * a - 1.0), b * (2.0 * b - 1.0), c * (2.0 * c - 1.0), d * (2.0 * d - 1.0),
        4.0 * a * b, 4.0 * b * c, 4.0 * a * c, 4.0 * a * d, 4.0 * b * d, 4.0 * c * d,
    )  # fmt: skip
    u, v, w = 0.0, 0.0, 0.0
    for n in range(10):
        u += shares[n] * values[n, 0]
        v += shares[n] * values[n, 1]
        w += shares[n] * values[n, 2]
    return u, v, w


# the three derivatives of a place by barycentric coordinates 1 to 3
_Columns = tuple[float, float, float, float, float, float, float, float, float]


@compiled
def _columns(cell: int, cells: Cells, b: float, c: float, d: float) -> _Columns:
    a = 1.0 - b - c - d
    nodes, position = cells.nodes[cell], cells.position
    xx, xy, xz, yx, yy, yz, zx, zy, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    by = (
        (1.0 - 4.0 * a, 1.0 - 4.0 * a, 1.0 - 4.0 * a), (4.0 * b - 1.0, 0.0, 0.0), (0.0, 4.0 * c - 1.0, 0.0),
        (0.0, 0.0, 4.0 * d - 1.0), (4.0 * (a - b), -4.0 * b, -4.0 * b), (4.0 * c, 4.0 * b, 0.0),
        (-4.0 * c, 4.0 * (a - c), -4.0 * c), (-4.0 * d, -4.0 * d, 4.0 * (a - d)), (4.0 * d, 0.0, 4.0 * b),
        (0.0, 4.0 * d, 4.0 * c),
    )  # fmt: skip
    for n in range(10):
        x, y, z = position[nodes[n], 0], position[nodes[n], 1], position[nodes[n], 2]
        one, two, three = by[n]
        xx, xy, xz = xx + one * x, xy + one * y, xz + one * z
        yx, yy, yz = yx + two * x, yy + two * y, yz + two * z
        zx, zy, zz = zx + three * x, zy + three * y, zz + three * z
    return xx, xy, xz, yx, yy, yz, zx, zy, zz


@compiled
def _held(share: float) -> float:
    return min(max(share, -0.3), 1.3)


@compiled
def _nearer(
    x: float, y: float, z: float, cell: int, cells: Cells, b: float, c: float, d: float
) -> tuple[float, float, float]:
    """Barycentric coordinates of a place in a curved cell, by Newton's method from a guess."""
    nodes, position = cells.nodes[cell], cells.position
    b, c, d = _held(b), _held(c), _held(d)
    for _ in range(3):
        a = 1.0 - b - c - d
        shares = (
            a * (2.0 * a - 1.0), b * (2.0 * b - 1.0), c * (2.0 * c - 1.0), d * (2.0 * d - 1.0),
            4.0 * a * b, 4.0 * b * c, 4.0 * a * c, 4.0 * a * d, 4.0 * b * d, 4.0 * c * d,
        )  # fmt: skip
        dx, dy, dz = x, y, z
        for n in range(10):
            dx -= shares[n] * position[nodes[n], 0]
            dy -= shares[n] * position[nodes[n], 1]
            dz -= shares[n] * position[nodes[n], 2]
        xx, xy, xz, yx, yy, yz, zx, zy, zz = _columns(cell, cells, b, c, d)
        size = xx * (yy * zz - yz * zy) + xy * (yz * zx - yx * zz) + xz * (yx * zy - yy * zx)
        b += (dx * (yy * zz - yz * zy) + dy * (yz * zx - yx * zz) + dz * (yx * zy - yy * zx)) / size
        c += (dx * (zy * xz - zz * xy) + dy * (zz * xx - zx * xz) + dz * (zx * xy - zy * xx)) / size
        d += (dx * (xy * yz - xz * yy) + dy * (xz * yx - xx * yz) + dz * (xx * yy - xy * yx)) / size
        # far outside the map may fold: the cell's surroundings are enough
        b, c, d = _held(b), _held(c), _held(d)
    return b, c, d
