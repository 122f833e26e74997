"""From the air's closed surface to the cells of snappyHexMesh: write the case, run it, read it, mend and check."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np

from pipeline.child_process import Limits
from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.geometry.polyhedra import polygons
from pipeline.geometry.triangles import area_vectors
from pipeline.machine import memory_allowed
from pipeline.mesh.boundary import free_axes, planes
from pipeline.mesh.engines.snappy.case import write_case
from pipeline.mesh.engines.snappy.engine import SnappySettings
from pipeline.mesh.engines.snappy.fit import fitted
from pipeline.mesh.engines.snappy.running import run_case
from pipeline.mesh.engines.snappy.undetermined import without_undetermined_cells
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.nouns.patches import FIBERS, PATCHES
from pipeline.openfoam.read import read_openfoam
from pipeline.progress import Progress, silent
from pipeline.scratch import scratch_folder

_PLANE_ERROR = 0.02  # of a plane's area: a section of a fiber is a polygon of few corners


def snapped(
    domain: FluidDomain, settings: TetmeshSettings, progress: Progress = silent, folder: Path | None = None
) -> tuple[FaceMesh, TetmeshMeasures]:
    """Fill the air with hexahedra that are split near the fibers and moved onto them.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    progress : Progress
    folder : Path, optional
        Where the case is kept: its dictionaries, surface, scripts and logs, without the mesh.

    Returns
    -------
    FaceMesh, TetmeshMeasures

    Raises
    ------
    StageError
        If OpenFOAM is missing or fails, or the mesh does not keep the duct's planes.
    """
    with scratch_folder("snappy") if folder is None else contextlib.nullcontext(folder) as case:
        progress("snappyHexMesh, writing its case", 0.0)
        write_case(domain, settings, case)
        own = settings.own(SnappySettings)
        limits = Limits(own.time_limit, memory_allowed(settings.memory_limit))
        used = run_case(case, own.cores, limits, progress)
        progress("reading the mesh", 0.95)
        mesh = _on_planes(read_openfoam(case), domain.box)
        # the mesh is the stage's own result
        shutil.rmtree(case / "constant" / "polyMesh")
    _check_planes(mesh, domain)
    raw = mesh
    progress("joining cells in which no gradient is known")
    mesh, faulty = without_undetermined_cells(mesh, FIBERS)
    filled = 1.0 - mesh.volume / raw.volume
    progress("restoring the fibers' volume")
    mesh = fitted(mesh, FIBERS, free_axes(mesh.points, domain.box), domain.volume)
    measures = TetmeshMeasures(
        points=len(mesh.points),
        cells=mesh.cells,
        fluid_volume=mesh.volume,
        volume_error=domain.volume_error(mesh.volume),
        raw_volume_error=domain.volume_error(raw.volume),
        filled_volume=filled,
        faulty_cells=faulty,
        mesher_seconds=used.seconds,
        mesher_peak_memory=used.peak_memory,
    )
    return mesh, measures


def _on_planes(mesh: FaceMesh, box: Box) -> FaceMesh:
    """Put each plane's points exactly on it; snappyHexMesh leaves them off by rounding."""
    names = tuple(patch.name for patch in mesh.patches)
    if names != PATCHES:
        raise StageError(
            f"snappyHexMesh gave the patches {', '.join(names)} instead of {', '.join(PATCHES)}; "
            "make the mesh finer: lower tetmesh.edge"
        )
    points = np.array(mesh.points)
    for plane in planes(box):
        which = mesh.patch(PATCHES[plane.patch])
        points[mesh.corners[mesh.offsets[which.start] : mesh.offsets[which.stop]], plane.axis] = plane.value
    return replace(mesh, points=points)


def _check_planes(mesh: FaceMesh, domain: FluidDomain) -> None:
    areas = np.linalg.norm(polygons(mesh.points, mesh.corners, mesh.offsets)[0], axis=1)
    wanted = np.linalg.norm(area_vectors(domain.points, domain.triangles), axis=1)
    for number, name in enumerate(domain.patches):
        if name == FIBERS:
            continue
        error = float(areas[mesh.patch(name)].sum() / wanted[domain.patch == number].sum() - 1.0)
        if abs(error) > _PLANE_ERROR:
            raise StageError(
                f"snappyHexMesh left the area of the patch {name} off by {error:+.2%} (allowed: {_PLANE_ERROR:.0%}); "
                "make the mesh finer: lower tetmesh.edge"
            )
