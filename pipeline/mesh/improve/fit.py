"""Give every fiber its radius back where chords cut its corners.

The walls of a mesh are made of chords, and a chord of a circle lies inside. A percent of a fiber's volume is 1.5 % of
its pressure drop, so the walls that lie on one fiber are moved along their normals by the one distance, a few
thousandths of its diameter, that makes them stand on the true fiber on average. Air that is bridged where fibers meet
is no reason to thin a fiber elsewhere: walls there stay.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.geometry.tets import volumes
from pipeline.geometry.triangles import area_vectors, vertex_sums
from pipeline.nouns.arrays import Floats, Ints

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance

_ROUNDS = 3  # the relation is nearly linear: each round leaves some percent of the error before
_RETREATS = 12  # vertices that stay may make neighbors stay
_SMALLEST = 0.3  # share of its volume that every cell keeps, or its vertices stay where they are
_ON = 0.25  # radii from a fiber within which a vertex lies on it


def fitted(
    points: Floats, all_tets: Ints, walls: Ints, free: Floats, distance: "FiberDistance", limits: tuple[Floats, Floats]
) -> Floats:
    """Move the walls' vertices so that each fiber's walls stand on it on average.

    Parameters
    ----------
    points : (n, 3) array [m]
    all_tets : (m, 4) int array
        Positive tetrahedra.
    walls : (b, 3) int array
        Boundary triangles of the fibers, outward from the air.
    free : (n, 3) array of 0 and 1
        Along which axes a wall's vertex may move: not across the duct's planes.
    distance : FiberDistance
    limits : tuple of two (3,) arrays [m]
        Lowest and highest coordinates of the box that no vertex may leave.

    Returns
    -------
    (n, 3) array [m]
        Vertices whose move would flatten a cell, or make a sound one faulty, stay in place.
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.adjacency import neighbors, ring
    from pipeline.mesh.improve.mend import faults

    result = np.array(points)
    on_wall = np.zeros(len(points), dtype=bool)
    on_wall[walls] = True
    # only cells with a vertex on a wall change, and only faces of these can become faulty
    near = np.asarray(on_wall[all_tets].any(axis=1))
    tets = all_tets[ring(all_tets, near, len(points))]
    across = neighbors(tets)
    start = volumes(points, tets)
    sound = faults(points, tets, across) <= 1.0
    own = _own_walls(points, walls, distance)
    # a vertex moves if all the walls around it are those of one fiber
    mixed = np.zeros(len(points), dtype=bool)
    mixed[walls[~own]] = True
    movable = (on_wall & ~mixed).astype(np.float64)
    for _ in range(_ROUNDS):
        vectors = area_vectors(result, walls)
        normals = vertex_sums(walls[own], vectors[own], len(points))
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros(points.shape), where=length > 0) * free * movable[:, None]
        off = _stand_off(result, walls[own], vectors[own], distance)
        # a wall's outward normal looks into its fiber
        moved = result + off[:, None] * normals
        # beside a plane of the duct a fiber's vertex may have nothing of the mesh between itself and the outside
        movable[((moved < limits[0]) | (moved > limits[1])).any(axis=1)] = 0.0
        doubtful = np.arange(len(tets))
        for _ in range(_RETREATS):
            moved = np.where(movable[:, None] > 0, moved, result)
            found = faults(moved, tets, across, doubtful)
            harmed = (volumes(moved, tets[doubtful]) < _SMALLEST * start[doubtful]) | (sound[doubtful] & (found > 1.0))
            if not harmed.any():
                result = moved
                break
            stay = np.zeros(len(points), dtype=bool)
            stay[tets[doubtful[harmed]]] = True
            movable[stay] = 0.0
            # only the cells at these vertices change, and the faces of those that touch them
            changed = np.asarray(stay[tets].any(axis=1))
            beside = across[changed]
            changed[beside[beside >= 0]] = True
            doubtful = np.flatnonzero(changed)
    return result


def _own_walls(points: Floats, walls: Ints, distance: "FiberDistance") -> npt.NDArray[np.bool_]:
    """Tell which walls lie on one fiber with all their corners, and their middles nearest to it."""
    pieces, fiber_of = distance.field[0], distance.field[2]
    corners = points[walls]
    off, piece = distance.with_piece(corners.reshape(-1, 3))
    piece_of = np.where(piece >= 0, piece, 0).reshape(-1, 3)
    near = (np.abs(off).reshape(-1, 3) <= _ON * pieces[piece_of, 7]) & (piece.reshape(-1, 3) >= 0)
    fiber = fiber_of[piece_of]
    same = (fiber == fiber[:, :1]).all(axis=1) & near.all(axis=1)
    _, at_middle = distance.with_piece(corners.mean(axis=1))
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
