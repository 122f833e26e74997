"""Find the crevices that no mesh resolves.

Where a fiber grazes a side of the duct, or two fibers touch, the air ends in a wedge without thickness. The cells in
its tip have all their vertices on the boundary, so that none can be moved, and no shape of theirs suits a solver.
The air in them stands still: they are given to the fibers, a few millionths of the air.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.mesh.working_mesh import WorkingMesh, on_boundary
from pipeline.nouns.arrays import Bools, Ints

_BESIDE = 0.25  # diameters: air that thick between a fiber and a side it touches is half a diameter from the contact


def in_crevice(mesh: WorkingMesh, faulty: Bools, stuck: bool) -> Bools:
    """Find the faulty cells that lie in the tip of a wedge.

    Parameters
    ----------
    mesh : WorkingMesh
    faulty : (m,) bool array
        Cells that a solver would find fault with.
    stuck : bool
        Whether smoothing has given up: then every faulty cell with a face on the boundary is in a tip; before, only
        those whose every vertex lies on the boundary too.

    Returns
    -------
    (m,) bool array
    """
    tip: Bools = faulty & on_boundary(mesh.across).any(axis=1)
    if not stuck:
        outside = np.zeros(len(mesh.points), dtype=bool)
        outside[mesh.boundary()[0]] = True
        tip &= outside[mesh.tets].all(axis=1)
    return tip


def beside_fibers(mesh: WorkingMesh, cells: Ints) -> Bools:
    """Tell which cells lie beside fibers with all their vertices, as the tip of a wedge does: (cells,) bool array.

    Where nobody knows the axes of the fibers every cell may.
    """
    corners = mesh.tets[cells]
    distance, diameter = (found.reshape(corners.shape) for found in mesh.freedom.nearest(mesh.points[corners.ravel()]))
    # no number is at most another that is none
    return np.asarray((distance <= _BESIDE * diameter).all(axis=1) | np.isnan(diameter).all(axis=1))


def at_walls(mesh: WorkingMesh) -> Bools:
    """Find the cells that touch a fiber, if only with a vertex, (m,) bool array."""
    on_fibers = np.zeros(len(mesh.points), dtype=bool)
    on_fibers[mesh.walls()] = True
    return np.asarray(on_fibers[mesh.tets].any(axis=1))
