"""Repair a mesh around its faulty cells, and fill the crevices where no move of a vertex can help.

Some cells in ten thousand are faulty: all work but looking for them is done on these and the cells around them.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.tets import FACES
from pipeline.mesh.improve.crevices import at_walls, beside_fibers, in_crevice
from pipeline.mesh.improve.split import split_corners, split_longest
from pipeline.mesh.working_mesh import INTERFACE, LATER, WorkingMesh
from pipeline.nouns.arrays import Bools
from pipeline.progress import Progress, silent

_FILLINGS = 8  # rounds of smoothing and filling crevices
_PATIENCE = 3  # rounds before cells that cannot be mended are filled though a vertex of theirs could move
_RINGS = 3  # of cells around the faulty ones that take part
_PASSES = 8  # over the whole mesh: what is filled may leave corners elsewhere
_WAITING = 2  # rings of cells at the rim of a piece that are repaired with the next
_NONE = np.empty(0, np.int64)


def repaired(mesh: WorkingMesh, progress: Progress = silent) -> tuple[WorkingMesh, int, float]:
    """Split, smooth and fill until no cell is faulty or nothing helps.

    Parameters
    ----------
    mesh : WorkingMesh
    progress : Progress

    Returns
    -------
    WorkingMesh
        One part that hangs together.
    faulty : int
        Cells still beyond what smoothing aims at.
    filled : float [m3]
        Air in crevices that was given to the fibers.
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.adjacency import ring
    from pipeline.mesh.improve.smooth import faulty_cells, smoothed

    # moves alone mend nearly all: what is filled or split later is looked for around the few cells that are left
    mesh, faulty = smoothed(split_corners(mesh.one_part()), _NONE)
    faulty &= ~_can_wait(mesh)
    filled = 0.0
    for _ in range(_PASSES):
        near = faulty | (mesh.boundary_faces() > 1)
        if not near.any():
            break
        progress(f"repairing what is left around {int(near.sum()):,} cells")
        for _ in range(_RINGS):
            near = ring(mesh.tets, near, len(mesh.points))
        part = mesh.part(np.flatnonzero(near))
        improved, air = _repaired_part(part.mesh)
        filled += air
        mesh, here = mesh.with_part(part, improved)
        # no cell elsewhere was faulty, and none has changed
        beside = mesh.across[here]
        here = np.union1d(here, beside[beside >= 0])
        faulty = np.zeros(mesh.cells, np.bool_)
        faulty[here] = faulty_cells(mesh, here)
        if air > 0.0:
            whole = mesh.main_cells()
            mesh, faulty = mesh.without(~whole), faulty[whole]
        faulty &= ~_can_wait(mesh)
    return mesh, int(faulty.sum()), filled


def _repaired_part(mesh: WorkingMesh) -> tuple[WorkingMesh, float]:
    """Repair a part, and give the state with the fewest faulty cells and the air that was filled until then."""
    from pipeline.geometry.adjacency import cell_volumes
    from pipeline.mesh.improve.smooth import smoothed

    filled, fewest = 0.0, mesh.cells**2
    best = (mesh, filled)
    loose = _NONE
    for filling in range(_FILLINGS):
        mesh, faulty = smoothed(split_corners(mesh), loose)
        faulty &= ~_can_wait(mesh)
        volume = cell_volumes(mesh.points, mesh.tets)
        # a flat cell is worse than any number of merely bad ones
        count = int(faulty.sum()) + mesh.cells * int((volume <= 0.0).sum())
        if count < fewest:
            fewest, best = count, (mesh, filled)
        if not faulty.any() or filling == _FILLINGS - 1:
            break
        stuck = filling >= _PATIENCE
        # away from the fibers nothing is a crevice: a filled cell at the inlet of a coarse mesh doubled a pressure drop
        crevice = in_crevice(mesh, faulty, stuck) & at_walls(mesh) & ~(mesh.across < INTERFACE).any(axis=1)
        crevice[crevice] = beside_fibers(mesh, np.flatnonzero(crevice))
        crevice &= ~_on_inner_planes(mesh)
        filled += float(volume[crevice].sum())
        loose = np.union1d(loose, mesh.tets[crevice])
        mesh, faulty = mesh.without(crevice), faulty[~crevice]
        if stuck and faulty.any():
            mesh = split_longest(mesh, faulty)
    return best


def _can_wait(mesh: WorkingMesh) -> Bools:
    """Tell the cells so near to what is repaired later that neither splitting nor filling is called for yet."""
    from pipeline.geometry.adjacency import ring

    near = (mesh.across == LATER).any(axis=1)
    if near.any():
        for _ in range(_WAITING):
            near = ring(mesh.tets, near, len(mesh.points))
    return np.asarray(near)


def _on_inner_planes(mesh: WorkingMesh) -> Bools:
    """Tell which cells have a face on a plane of the duct with air beyond it, as there is where sides are cyclic."""
    found = np.zeros(mesh.cells, np.bool_)
    for side, corners in enumerate(FACES):
        a, b, c = (mesh.planes[mesh.tets[:, corner]] for corner in corners)
        beyond = mesh.across[:, side]
        found |= ((a & b & c) > 0) & ((beyond >= 0) | (beyond <= INTERFACE))
    return found
