"""Cure the cells in which no gradient is known.

Between a fiber and a side of the duct, or in the tip of a wedge, there is room for one cell across. Its inner faces
look in two directions only, so that the gradient along the third is unknown (determinant 0). Joined with the cell
toward the open air it is a polyhedron like any other, and no air is lost. The few that would make a bad one are given
to the fibers: the air in there stands still.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.polyhedra import Polyhedra
from pipeline.mesh.engines.snappy.joining import Mask, joined, without
from pipeline.nouns.arrays import Ints
from pipeline.nouns.mesh import FaceMesh
from pipeline.openfoam.metrics import determinant, face_pyramid, face_weight, non_orthogonality, skewness, volume_ratio

_ROUNDS = 30  # each joins or drops one layer of cells; the default case takes 5

# What a joined cell must keep to, inside of what `checkMesh -allGeometry` asks for.
_LEAST_DETERMINANT = 1.1e-3
_LEANING = 65.0  # degrees
_SKEWNESS = 3.5
_FACE_WEIGHT = 0.06
_VOLUME_RATIO = 0.02
_FACE_PYRAMID = 0.005


def without_undetermined_cells(mesh: FaceMesh, patch: str) -> tuple[FaceMesh, int]:
    """Join each cell in which no gradient is known with a neighbor, or give it to a patch.

    Parameters
    ----------
    mesh : FaceMesh
    patch : str
        The last patch; only cells with a corner on it are given to it.

    Returns
    -------
    FaceMesh
    left : int
        Number of such cells that are left.
    """
    stuck = np.zeros(mesh.cells, dtype=bool)
    for _ in range(_ROUNDS):
        shape = mesh.polyhedra()
        undetermined = _undetermined(mesh, shape)
        into = _partners(mesh, shape, undetermined, stuck)
        if (into != np.arange(mesh.cells)).any():
            mesh, stuck = _soundly_joined(mesh, into, stuck)
            continue
        dropped = undetermined & _at(mesh, patch)
        if not dropped.any():
            break
        mesh = without(mesh, dropped, patch)
        stuck = np.zeros(mesh.cells, dtype=bool)
    return mesh, int(_undetermined(mesh, mesh.polyhedra()).sum())


def _undetermined(mesh: FaceMesh, shape: Polyhedra) -> Mask:
    return np.asarray(determinant(mesh, shape) < _LEAST_DETERMINANT)


def _partners(mesh: FaceMesh, shape: Polyhedra, undetermined: Mask, stuck: Mask) -> Ints:
    """Find the neighbor that sees, across the largest face, of each undetermined cell; every other cell is its own."""
    n = mesh.internal
    cell = np.concatenate([mesh.owner[:n], mesh.neighbour])
    partner = np.concatenate([mesh.neighbour, mesh.owner[:n]])
    area = np.tile(np.linalg.norm(shape.areas[:n], axis=1), 2)
    fit = np.flatnonzero(undetermined[cell] & ~stuck[cell] & ~undetermined[partner])
    order = fit[np.argsort(area[fit], kind="stable")]
    into = np.arange(mesh.cells)
    into[cell[order]] = partner[order]  # of several the last one stays
    return into


def _soundly_joined(mesh: FaceMesh, into: Ints, stuck: Mask) -> tuple[FaceMesh, Mask]:
    """Join cells, and take back what would make a bad cell; those are stuck from now on."""
    alone = np.arange(mesh.cells)
    while True:
        made, number = joined(mesh, into)
        undo = _unsound(made)[number] & (into != alone)
        if not undo.any():
            break
        stuck = stuck | undo
        into = np.where(undo, alone, into)
    still = np.zeros(made.cells, dtype=bool)
    still[number[stuck]] = True
    return made, still


def _unsound(mesh: FaceMesh) -> Mask:
    n, shape = mesh.internal, mesh.polyhedra()
    bad = (face_pyramid(mesh, shape) < _FACE_PYRAMID) | (skewness(mesh, shape) > _SKEWNESS)
    bad[:n] |= non_orthogonality(mesh, shape) > _LEANING
    bad[:n] |= face_weight(mesh, shape) < _FACE_WEIGHT
    bad[:n] |= volume_ratio(mesh, shape) < _VOLUME_RATIO
    return _cells_of(mesh, bad)


def _at(mesh: FaceMesh, patch: str) -> Mask:
    """Find the cells with a corner on a patch."""
    which = mesh.patch(patch)
    on_patch = np.zeros(len(mesh.points), dtype=bool)
    on_patch[mesh.corners[mesh.offsets[which.start] : mesh.offsets[which.stop]]] = True
    return _cells_of(mesh, np.logical_or.reduceat(on_patch[mesh.corners], mesh.offsets[:-1]))


def _cells_of(mesh: FaceMesh, face: Mask) -> Mask:
    """Find the cells that have one of some faces."""
    result = np.zeros(mesh.cells, dtype=bool)
    result[mesh.owner[face]] = True
    result[mesh.neighbour[face[: mesh.internal]]] = True
    return result
