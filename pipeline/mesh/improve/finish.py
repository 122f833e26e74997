"""Make a mesh fit for a solver: repair its worst cells, give the fibers their radius back, check."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace

import numpy as np

from pipeline.mesh.engines.flawed import FlawedMeshError
from pipeline.mesh.improve.repair import repaired
from pipeline.mesh.improve.walls import on_fibers
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.working_mesh import WorkingMesh
from pipeline.nouns.arrays import Floats
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import CYCLIC, FaceMesh
from pipeline.nouns.mesh_measures import MeshingCost, TetmeshMeasures
from pipeline.nouns.patches import FIBERS, SIDES
from pipeline.progress import Progress

_ROUNDS = 2  # the second makes good what repairing after the first moved
_CUTS = (0.35, 0.65)  # of the way from a side to the opposite one: what lies at one is away from the other


def finished(
    mesh: WorkingMesh, cost: MeshingCost, domain: FluidDomain, settings: TetmeshSettings, progress: Progress
) -> tuple[FaceMesh, TetmeshMeasures]:
    """Improve what an engine left, and check.

    Parameters
    ----------
    mesh : WorkingMesh
        As the engine leaves it.
    cost : MeshingCost
        What the engine used.
    domain : FluidDomain
    settings : TetmeshSettings
    progress : Progress

    Returns
    -------
    FaceMesh, TetmeshMeasures

    Raises
    ------
    FlawedMeshError
        If cells without volume remain.
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.adjacency import cell_volumes
    from pipeline.geometry.faces import tet_faces

    raw_error = domain.volume_error(float(cell_volumes(mesh.points, mesh.tets).sum()))
    mesh, faulty, filled = improved(mesh, progress)
    mesh = mesh.compacted()
    volume = cell_volumes(mesh.points, mesh.tets)
    _check_volumes(mesh, volume, settings)
    _check_patches(mesh, domain, settings)
    progress("numbering cells and faces", 0.9)
    faces = FaceMesh.of_triangles(mesh.points, tet_faces(mesh.tets, mesh.across), domain.patches)
    if domain.cyclic:
        sides = tuple(replace(patch, kind=CYCLIC) if patch.name in SIDES else patch for patch in faces.patches)
        faces = replace(faces, patches=sides)
    measures = TetmeshMeasures(
        points=len(faces.points),
        cells=faces.cells,
        fluid_volume=float(volume.sum()),
        volume_error=domain.volume_error(float(volume.sum())),
        raw_volume_error=raw_error,
        filled_volume=filled / domain.volume,
        faulty_cells=faulty,
        mesher_seconds=cost.seconds,
        mesher_peak_memory=cost.peak_memory,
    )
    return faces, measures


def improved(mesh: WorkingMesh, progress: Progress) -> tuple[WorkingMesh, int, float]:
    """Repair cells and move walls onto their fibers: the mesh, cells that stay faulty, and the air filled [m3]."""
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.mesh.improve.across_sides import shifted

    # sides that do not fit each other are refused where cyclic patches are written
    if mesh.freedom.cyclic and shifted(mesh, _CUTS[0]) is not None:
        return _improved_across_sides(mesh, progress)
    filled, faulty = 0.0, 0
    for turn in range(_ROUNDS):
        mesh, faulty, air = _improved_once(mesh, progress, turn / _ROUNDS)
        filled += air
    return mesh, faulty, filled


def _improved_across_sides(mesh: WorkingMesh, progress: Progress) -> tuple[WorkingMesh, int, float]:
    """Improve a mesh with cyclic sides in its duct, then put together across its sides and cut elsewhere, twice."""
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.mesh.improve.across_sides import back_in_duct, shifted, with_sides, with_sides_kept
    from pipeline.mesh.improve.smooth import faulty_cells

    freedom = mesh.freedom
    work, _, filled = _improved_once(with_sides_kept(mesh), progress, 0.0)
    mesh = with_sides(work, freedom)
    for turn, share in enumerate(_CUTS, 1):
        whole = shifted(mesh, share)
        if whole is not None:  # what was filled may leave sides that fit no more
            work, _, air = _improved_once(whole.mesh, progress, turn / (1 + len(_CUTS)))
            mesh = back_in_duct(whole, work)
            filled += air
    return mesh, int(faulty_cells(with_sides_kept(mesh)).sum()), filled


def _improved_once(mesh: WorkingMesh, progress: Progress, done: float) -> tuple[WorkingMesh, int, float]:
    progress("repairing the worst cells", 0.6 + 0.3 * done)
    mesh, faulty, air = repaired(mesh, progress)
    progress("moving the walls onto the fibers", 0.7 + 0.3 * done)
    return on_fibers(mesh), faulty, air


def _check_patches(mesh: WorkingMesh, domain: FluidDomain, settings: TetmeshSettings) -> None:
    found = set(np.unique(-1 - mesh.across[mesh.across < 0]).tolist())
    empty = [name for number, name in enumerate(domain.patches) if number not in found]
    if FIBERS in empty:
        thickest = 2.0 * float(domain.radius.max())
        raise FlawedMeshError(
            f"the mesh resolves none of the {len(domain.radius)} fibers, the thickest {thickest * 1e6:.3g} um (fiber "
            f"{int(domain.radius.argmax())} of {len(domain.radius)}), with an edge of {settings.edge:g} diameters; "
            f"{settings.mesher.truer}"
        )
    if empty:
        raise FlawedMeshError(
            f"no air of the mesh reaches {', '.join(empty)}, though the fibers' surface leaves a way there: it is "
            f"narrower than the mesh keeps; {settings.mesher.truer}, raise surface.sides, or take less solidity"
        )


def _check_volumes(mesh: WorkingMesh, volume: Floats, settings: TetmeshSettings) -> None:
    flat = np.flatnonzero(volume <= 0.0)
    if len(flat):
        place = mesh.points[mesh.tets[flat[0]]].mean(axis=0) * 1e6
        raise FlawedMeshError(
            f"{len(flat)} of {mesh.cells} tetrahedra have no volume, first at ({place[0]:.3g}, {place[1]:.3g}, "
            f"{place[2]:.3g}) um; {settings.mesher.truer}"
        )
