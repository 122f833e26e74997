"""Give the fibers the volume back that the mesher's envelope took.

fTetWild cuts corners: its boundary is made of chords within the envelope, and a chord of a circle lies inside. A
percent of the fibers' volume is 1.5 % of the pressure drop, so the fibers' vertices are moved along their normals by
the one distance that restores the volume, a few thousandths of a diameter.
"""

import numpy as np

from pipeline.data import Floats, Ints
from pipeline.geometry.tets import volumes
from pipeline.geometry.triangles import area_vectors

_ROUNDS = 4  # the relation is nearly linear: each round leaves some percent of the error before
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
        All volumes stay positive; vertices whose move would flatten a cell stay in place.
    """
    result = np.array(points)
    movable = np.ones(len(points))
    on_wall = np.zeros(len(points), dtype=bool)
    on_wall[walls] = True
    # no other cell changes
    tets = all_tets[on_wall[all_tets].any(axis=1)]
    start = volumes(points, tets)
    wanted = fluid_volume - (float(volumes(points, all_tets).sum()) - float(start.sum()))
    for _ in range(_ROUNDS):
        vectors = area_vectors(result, walls)
        normals = np.stack(
            [sum(np.bincount(walls[:, k], vectors[:, axis], len(points)) for k in range(3)) for axis in range(3)],
            axis=1,
        )
        # where two fibers touch, the faces around a vertex look in opposite ways and it has no normal
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0) * free * movable[:, None]
        gain = float(np.einsum("ij,ij->", normals[walls].mean(axis=1), vectors))  # volume per distance moved
        if gain <= 0.0:
            break
        step = (wanted - float(volumes(result, tets).sum())) / gain
        moved = result + step * normals
        # beside a plane of the duct a fiber's vertex may have nothing of the mesh between itself and the outside
        outside = (moved < limits[0]) | (moved > limits[1])
        movable[outside.any(axis=1)] = 0.0
        moved = np.where(movable[:, None] > 0, moved, result)
        squeezed = volumes(moved, tets) < _SMALLEST * start
        while squeezed.any():
            movable[np.unique(tets[squeezed])] = 0.0
            moved = np.where(movable[:, None] > 0, moved, result)
            squeezed = volumes(moved, tets) < _SMALLEST * start
            if (movable[np.unique(tets[squeezed])] == 0).all():
                break
        if (volumes(moved, tets) <= 0).any():
            break
        result = moved
    return result
