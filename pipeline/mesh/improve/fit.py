"""Give the fibers the volume back that the mesher's envelope took.

fTetWild cuts corners: its boundary is made of chords within the envelope, and a chord of a circle lies inside. A
percent of the fibers' volume is 1.5 % of the pressure drop, so the fibers' vertices are moved along their normals by
the one distance that restores the volume, a few thousandths of a diameter.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.tets import volumes
from pipeline.geometry.triangles import area_vectors, vertex_sums
from pipeline.nouns.arrays import Floats, Ints

_ROUNDS = 4  # the relation is nearly linear: each round leaves some percent of the error before
_RETREATS = 12  # vertices that stay may make neighbors stay
_SMALLEST = 0.3  # share of its volume that every cell keeps, or its vertices stay where they are


def fitted(
    points: Floats, all_tets: Ints, walls: Ints, free: Floats, fluid_volume: float, limits: tuple[Floats, Floats]
) -> Floats:
    """Move the walls' vertices so that the tetrahedra fill the given volume.

    Parameters
    ----------
    points : (n, 3) array [m]
    all_tets : (m, 4) int array
        Positive tetrahedra.
    walls : (b, 3) int array
        Boundary triangles of the fibers, outward from the fluid.
    free : (n, 3) array of 0 and 1
        Along which axes a wall's vertex may move: not across the duct's planes.
    fluid_volume : float [m3]
        The volume to reach.
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
    movable = np.ones(len(points))
    on_wall = np.zeros(len(points), dtype=bool)
    on_wall[walls] = True
    # only cells with a vertex on a wall change, and only faces of these can become faulty
    near = np.asarray(on_wall[all_tets].any(axis=1))
    tets = all_tets[ring(all_tets, near, len(points))]
    across = neighbors(tets)
    start = volumes(points, tets)
    sound = faults(points, tets, across) <= 1.0
    wanted = fluid_volume - (float(volumes(points, all_tets).sum()) - float(start.sum()))
    for _ in range(_ROUNDS):
        vectors = area_vectors(result, walls)
        normals = vertex_sums(walls, vectors, len(points))
        # where two fibers touch, the faces around a vertex look in opposite ways and it has no normal
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0) * free * movable[:, None]
        gain = float(np.einsum("ij,ij->", normals[walls].mean(axis=1), vectors))  # volume per distance moved
        if gain <= 0.0:
            break
        step = (wanted - float(volumes(result, tets).sum())) / gain
        moved = result + step * normals
        # beside a plane of the duct a fiber's vertex may have nothing of the mesh between itself and the outside
        movable[((moved < limits[0]) | (moved > limits[1])).any(axis=1)] = 0.0
        for _ in range(_RETREATS):
            moved = np.where(movable[:, None] > 0, moved, result)
            harmed = (volumes(moved, tets) < _SMALLEST * start) | (sound & (faults(moved, tets, across) > 1.0))
            if not harmed.any():
                result = moved
                break
            movable[np.unique(tets[harmed])] = 0.0
    return result
