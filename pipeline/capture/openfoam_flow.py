"""The velocity of a flow that OpenFOAM solved: from cells to nodes, with the solver's own flux through every face."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np

from pipeline.capture.cells import Cells, cells_of
from pipeline.capture.conservative import EDGES
from pipeline.errors import StageError
from pipeline.geometry.triangles import area_vectors
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS
from pipeline.openfoam.read_fields import latest_time, read_cells, read_faces


def openfoam_cells(folder: Path, mesh: FaceMesh, slip_length: float) -> tuple[Cells, tuple[Path, ...]]:
    """Reconstruct the velocity of second order in every cell from a finite-volume solution.

    Parameters
    ----------
    folder : Path
        A solved case of the run's mesh.
    mesh : FaceMesh
        Of tetrahedra.
    slip_length : float [m]
        Of the air on the fibers; 0 where it stands still on them.

    Returns
    -------
    cells : Cells
    files : tuple of Path
        What was read.

    Raises
    ------
    StageError
        If the mesh has other cells, or a field is missing or of another mesh.

    Notes
    -----
    Velocities at the vertices are means over the cells around them, weighted by the inverse of the distance; on the
    fibers they are what a slip length leaves of the nearest cell's. Between vertices they are linear. That alone loses
    air: the flux through each face is then set to the solver's, and what divergence is left within cells is taken out
    (`conservative`).
    """
    try:
        tets = mesh.tets()
    except ValueError as problem:
        raise StageError(
            "particles are followed through tetrahedra only, and this mesh has other cells; "
            'choose tetmesh.engine = "tetwild" or "lattice"'
        ) from problem
    time = latest_time(folder)
    velocity, through = read_cells(time / "U", mesh.cells, 3), read_faces(time / "phi", mesh)
    at_vertices = _at_vertices(mesh, tets, velocity, slip_length)
    ends, edge = np.unique(np.sort(tets[:, EDGES], axis=2).reshape(-1, 2), axis=0, return_inverse=True)
    nodes = np.hstack([tets, len(mesh.points) + edge.reshape(-1, 6)])
    both = [np.vstack([each, each[ends].mean(axis=1)]) for each in (mesh.points, at_vertices)]
    out = _out_of_cells(mesh, tets, through)
    return cells_of(nodes, both[0], both[1], through=out), (time / "U", time / "phi")


def _at_vertices(mesh: FaceMesh, tets: Ints, velocity: Floats, slip_length: float) -> Floats:
    middle = mesh.points[tets].mean(axis=1)
    total, weights = np.zeros_like(mesh.points), np.zeros(len(mesh.points))
    for corner in tets.T:
        weight = 1.0 / np.linalg.norm(mesh.points[corner] - middle, axis=1)
        np.add.at(weights, corner, weight)
        np.add.at(total, corner, weight[:, None] * velocity)
    found: Floats = total / weights[:, None]
    walls = next(patch for patch in mesh.patches if patch.name == FIBERS)
    rows = slice(walls.start, walls.start + walls.count)
    corners, cell = mesh.triangles()[rows], mesh.owner[rows]
    normal = area_vectors(mesh.points, corners)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    away = np.einsum("fx,fx->f", mesh.points[corners[:, 0]] - middle[cell], normal)
    along = velocity[cell] - np.einsum("fx,fx->f", velocity[cell], normal)[:, None] * normal
    slipping = along * (slip_length / (slip_length + away))[:, None]
    at_wall, count = np.zeros_like(found), np.bincount(corners.ravel(), minlength=len(found))
    np.add.at(at_wall, corners.ravel(), np.repeat(slipping, 3, axis=0))
    found[count > 0] = at_wall[count > 0] / count[count > 0, None]
    return found


def _out_of_cells(mesh: FaceMesh, tets: Ints, through: Floats) -> Floats:
    """Sort the flux of each face, positive out of its owner, to the vertex that it lies against in its cells."""
    out = np.zeros((len(tets), 4))
    triangles, inner = mesh.triangles(), len(mesh.neighbour)
    for cell, flux, faces in ((mesh.owner, through, triangles), (mesh.neighbour, -through[:inner], triangles[:inner])):
        # the vertex of the cell that its face lacks
        against = (tets[cell][:, :, None] != faces[:, None, :]).all(axis=2)
        out[cell, np.argmax(against, axis=1)] = flux
    return out
