"""Give every fiber its radius back where chords cut its corners.

The walls of a mesh are made of chords, and a chord of a circle lies inside. A percent of a fiber's volume is 1.5 % of
its pressure drop, so the walls that lie on one fiber are moved along their normals by the one distance, a few
thousandths of its diameter, that makes them stand on the true fiber on average. Air that is bridged where fibers meet
is no reason to thin a fiber elsewhere: walls there stay.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np

from pipeline.geometry.triangles import area_vectors, vertex_sums
from pipeline.mesh.working_mesh import WorkingMesh
from pipeline.nouns.arrays import Bools, Floats, Ints

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance

_ROUNDS = 3  # the relation is nearly linear: each round leaves some percent of the error before
_RETREATS = 12  # vertices that stay may make neighbors stay
_SMALLEST = 0.3  # share of its volume that every cell keeps, or its vertices stay where they are
_ON = 0.25  # radii from a fiber within which a vertex lies on it


def on_fibers(mesh: WorkingMesh) -> WorkingMesh:
    """Move the walls' vertices so that each fiber's walls stand on it on average.

    Parameters
    ----------
    mesh : WorkingMesh
        Of positive tetrahedra.

    Returns
    -------
    WorkingMesh
        Vertices whose move would flatten a cell, or make a sound one faulty, stay in place, as do those that would
        leave the duct or one of its planes.
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.adjacency import cell_volumes, touching
    from pipeline.mesh.improve.smooth import faulty_cells

    walls, distance, limits = mesh.walls(), mesh.freedom.distance, mesh.freedom.limits
    own = _own_walls(mesh.points, walls, distance)
    # a vertex moves if all the walls around it are those of one fiber
    movable = np.zeros(len(mesh.points), dtype=bool)
    movable[walls] = True
    movable[walls[~own]] = False
    movable &= ~mesh.held_vertices()
    free = mesh.freedom.free_axes(mesh.planes)
    # only cells with a vertex that moves change, and only faces of these can become faulty
    near = _with_neighbors(mesh, touching(mesh.tets, movable))
    start = cell_volumes(mesh.points, mesh.tets[near])
    sound = ~faulty_cells(mesh, near)
    row = np.full(mesh.cells, -1, np.int32)
    row[near] = np.arange(len(near))
    for _ in range(_ROUNDS):
        vectors = area_vectors(mesh.points, walls)
        normals = vertex_sums(walls[own], vectors[own], len(mesh.points))
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros(mesh.points.shape), where=length > 0) * free
        off = _stand_off(mesh.points, walls[own], vectors[own], distance)
        # a wall's outward normal looks into its fiber
        points = mesh.points + off[:, None] * normals
        # beside a plane of the duct a fiber's vertex may have nothing of the mesh between itself and the outside
        movable &= ((points >= limits[0]) & (points <= limits[1])).all(axis=1)
        doubtful = near
        for _ in range(_RETREATS):
            moved = mesh.moved(np.where(movable[:, None], points, mesh.points))
            flat = cell_volumes(moved.points, moved.tets[doubtful]) < _SMALLEST * start[row[doubtful]]
            harmed = doubtful[flat | (sound[row[doubtful]] & faulty_cells(moved, doubtful))]
            if not len(harmed):
                mesh = moved
                break
            stay = np.zeros(len(points), dtype=bool)
            stay[mesh.tets[harmed]] = True
            movable &= ~stay
            # only the cells at these vertices change, and the faces of those that touch them
            doubtful = _with_neighbors(mesh, touching(mesh.tets, stay))
            doubtful = doubtful[row[doubtful] >= 0]
    return mesh


def _with_neighbors(mesh: WorkingMesh, cells: Bools) -> Ints:
    """Numbers of cells and of those behind their faces, ascending."""
    chosen = cells.copy()
    beside = mesh.across[cells]
    chosen[beside[beside >= 0]] = True
    return np.flatnonzero(chosen)


def _own_walls(points: Floats, walls: Ints, distance: "FiberDistance") -> Bools:
    """Tell which walls lie on one fiber with all their corners, and their middles nearest to it."""
    pieces, fiber_of = distance.field[0], distance.field[2]
    on_wall, corner = np.unique(walls, return_inverse=True)
    off, piece = distance.with_piece(points[on_wall])
    near = (piece >= 0) & (np.abs(off) <= _ON * pieces[piece, 7])
    fiber = np.where(near, fiber_of[piece], -1)[corner.reshape(-1, 3)]
    same = (fiber >= 0).all(axis=1) & (fiber == fiber[:, :1]).all(axis=1)
    _, at_middle = distance.with_piece(points[walls].mean(axis=1))
    same &= (at_middle >= 0) & (fiber_of[np.maximum(at_middle, 0)] == fiber[:, 0])
    return np.asarray(same)


def _stand_off(points: Floats, walls: Ints, vectors: Floats, distance: "FiberDistance") -> Floats:
    """Mean distance of the walls around each vertex from their fiber, above 0 outside, (n,) array."""
    corners = points[walls]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    off = distance.at(middles.reshape(-1, 3)).reshape(-1, 3).mean(axis=1)
    area = np.linalg.norm(vectors, axis=1)
    total = np.bincount(walls.ravel(), np.repeat(area, 3), len(points))
    found = np.bincount(walls.ravel(), np.repeat(area * off, 3), len(points))
    return np.divide(found, total, out=np.zeros(len(points)), where=total > 0.0)
