"""Give the fibers exactly the volume of their surface, by moving their walls by one distance.

Faces between points on a cylinder cut its corners, and cells that bridge a crease between two fibers fill it; both
are tenths of a percent. The same is done for tetrahedra in `pipeline.mesh.improve.walls`.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from pipeline.geometry.polyhedra import polygons
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh

_ROUNDS = 4  # the relation is nearly linear: each round leaves some percent of the error before
_SMALLEST = 0.5  # share of its volume that every cell keeps, or its points stay where they are


def fitted(mesh: FaceMesh, patch: str, free: Floats, volume: float) -> FaceMesh:
    """Move the points of a patch along their normals so that the mesh has the given volume.

    Parameters
    ----------
    mesh : FaceMesh
    patch : str
    free : (n, 3) array of 0 and 1
        Along which axes a point may move: not across the duct's planes.
    volume : float [m3]

    Returns
    -------
    FaceMesh
        Points whose move would squeeze a cell stay in place.
    """
    which = mesh.patch(patch)
    walls = mesh.offsets[which.start : which.stop + 1]
    corners = mesh.corners[walls[0] : walls[-1]]
    sizes = np.diff(walls)
    movable = np.ones(len(mesh.points))
    start = mesh.polyhedra().volumes
    for _ in range(_ROUNDS):
        vectors, _ = polygons(mesh.points, mesh.corners, walls)
        normals = np.zeros_like(mesh.points)
        for axis in range(3):
            normals[:, axis] = np.bincount(corners, np.repeat(vectors[:, axis], sizes), len(normals))
        # where two fibers touch, the faces around a point may look in opposite ways and it has no normal
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0) * free * movable[:, None]
        mean = np.add.reduceat(normals[corners], walls[:-1] - walls[0]) / sizes[:, None]
        gain = float(np.einsum("ij,ij->", mean, vectors))  # volume per distance moved
        if gain <= 0.0:
            break
        moved = replace(mesh, points=mesh.points + (volume - mesh.volume) / gain * normals)
        squeezed = moved.polyhedra().volumes < _SMALLEST * start
        if squeezed.any():
            # they stay where they are, and the others move in the next round
            movable[_points_of(mesh, squeezed)] = 0.0
            continue
        mesh = moved
    return mesh


def _points_of(mesh: FaceMesh, cells: npt.NDArray[np.bool_]) -> Ints:
    face = cells[mesh.owner]
    face[: mesh.internal] |= cells[mesh.neighbour]
    return np.unique(mesh.corners[np.repeat(face, np.diff(mesh.offsets))])
