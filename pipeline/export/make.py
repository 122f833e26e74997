"""Write the mesh in every format that the case asks for."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT
from pipeline.export.formats.openfoam.slip import FiberSlip, fiber_radius
from pipeline.export.write import export
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import CellFields
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Write the files."""
    mesh, case = results.read(FaceMesh), results.case
    shown = results.get(CellFields) if "vtk" in case.export.formats else None
    flow = case.flow.flow()
    slip = None
    if case.flow.fiber_wall == "slip":
        slip = FiberSlip(SLIP_COEFFICIENT * flow.mean_free_path, fiber_radius(mesh, results.read(FluidDomain)))
    fields = shown.by_name() if shown is not None else {}
    written = export(mesh, into, case.export, flow, case.enclosure.sides, progress, fields, slip)
    return {"formats": list(written)}
