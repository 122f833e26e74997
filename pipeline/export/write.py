"""Every format that a case asks for, each in a folder of its own."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Mapping
from pathlib import Path

from pipeline.errors import StageError
from pipeline.export.formats.exchange import SUFFIXES, write_exchange
from pipeline.export.formats.fluent import write_fluent
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.formats.openfoam.slip import FiberSlip
from pipeline.export.formats.su2 import write_su2
from pipeline.export.formats.vtk import write_vtk
from pipeline.export.settings import ExportSettings
from pipeline.nouns.arrays import Floats
from pipeline.nouns.flow import Flow
from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import Progress, silent

_TETRAHEDRA_ONLY = {*SUFFIXES, "su2"}


def export(
    mesh: FaceMesh,
    folder: Path,
    settings: ExportSettings,
    flow: Flow,
    sides: str,
    progress: Progress = silent,
    fields: Mapping[str, Floats] | None = None,
    slip: FiberSlip | None = None,
) -> tuple[str, ...]:
    """Write the mesh in every format of `settings` into ``folder/<format>``.

    Parameters
    ----------
    mesh : FaceMesh
    folder : Path
        Made if it is not there.
    settings : ExportSettings
    flow : Flow
    sides : "symmetry", "slip" or "cyclic"
        What the duct's sides are to a solver.
    progress : Progress
    fields : mapping of name to (cells,) array, optional
        Shown on the cells by VTK.
    slip : FiberSlip, optional
        How far the air slips along the fibers; needed just where ``settings.fiber_wall`` is ``"slip"``.

    Returns
    -------
    tuple of str
        The formats written.

    Raises
    ------
    StageError
        If a format cannot hold what it is asked to.
    """
    if not mesh.tetrahedral:
        unfit = [name for name in settings.formats if name in _TETRAHEDRA_ONLY]
        if unfit:
            raise StageError(
                f"{', '.join(unfit)} holds tetrahedra only, and the mesh has other cells: take openfoam, vtk or fluent "
                "in export.formats, or a tetmesh.engine that makes tetrahedra"
            )
    for name in settings.formats:
        place = folder / name
        if name == "openfoam":
            write_openfoam(mesh, place, flow, sides, settings, progress, slip)
        elif name == "vtk":
            write_vtk(mesh, place, fields or {}, progress)
        elif name == "fluent":
            write_fluent(mesh, place / "mesh.msh", sides, progress)
        elif name == "su2":
            write_su2(mesh, place / "mesh.su2", progress)
        else:
            write_exchange(mesh, place / f"mesh{SUFFIXES[name]}", name, progress)
    return settings.formats
