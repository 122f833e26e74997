"""Which fiber each face of the wall belongs to."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.nouns.arrays import Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS


def wall_fibers(mesh: FaceMesh, domain: FluidDomain) -> Ints:
    """Find the fiber at each face of the fibers' patch: that of the nearest triangle of the duct's surface.

    Parameters
    ----------
    mesh : FaceMesh
    domain : FluidDomain
        The surface that the mesh was made from.

    Returns
    -------
    (faces of the fibers' patch,) int array
        Number of the fiber in the mat, from 0. A triangle is told by its corners and its center.
    """
    from scipy.spatial import cKDTree

    patch = next((patch for patch in mesh.patches if patch.name == FIBERS), None)
    on_fiber = domain.fiber >= 0
    if patch is None or not on_fiber.any():
        return np.empty(0, np.int64)
    triangles, fiber = domain.triangles[on_fiber], domain.fiber[on_fiber]
    corners = domain.points[triangles]
    samples = np.concatenate([corners.mean(axis=1), corners.reshape(-1, 3)])
    centers = mesh.polyhedra().centers[patch.start : patch.start + patch.count]
    _, nearest = cKDTree(samples).query(centers)
    found: Ints = np.concatenate([fiber, np.repeat(fiber, 3)])[nearest]
    return found
