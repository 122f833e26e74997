"""Which fiber each face of the wall stands for."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.polyhedra import polygons
from pipeline.mesh.distance import fiber_distance
from pipeline.nouns.arrays import Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fidelity import NEAREST
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS


def wall_fibers(mesh: FaceMesh, domain: FluidDomain) -> Ints:
    """Find the fiber of each face of the fibers' patch: the one whose surface is nearest to the face's center.

    Parameters
    ----------
    mesh : FaceMesh
    domain : FluidDomain
        What it was made of.

    Returns
    -------
    (faces of the fibers' patch,) int array
        Number of the fiber in the mat, from 0; -1 where none is near.
    """
    which = mesh.patch(FIBERS)
    _, centers = polygons(mesh.points, mesh.corners, mesh.offsets[which.start : which.stop + 1])
    if len(domain.pieces) == 0:
        # a medium that is there as a surface is one fiber, whose axis nobody knows
        return np.zeros(len(centers), np.int64)
    distance = fiber_distance(domain, NEAREST * 2.0 * domain.radius)
    _, piece = distance.with_piece(centers)
    fiber: Ints = np.where(piece >= 0, distance.field[2][piece], -1)
    return fiber
