"""Write the mesh in every format that the case asks for."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT
from pipeline.export.formats.format import Order
from pipeline.export.formats.openfoam.slip import FiberSlip, fiber_radius
from pipeline.export.formats.registry import held
from pipeline.export.write import FormatsFailedError, write_all
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import CellFields
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Write the files; a format that cannot hold what it should is told in the counts, and others are written."""
    wanted = results.case.export.formats
    things: dict[type, object] = {of: results.read(of) for of in (FaceMesh, *held(wanted))}
    try:
        written = write_all(wanted, things, into, order_of(results, wanted, progress))
    except FormatsFailedError as problem:
        if not problem.written:
            raise
        return {
            "formats": list(problem.written),
            "failed": [f"{name}: {reason}" for name, reason in problem.failed.items()],
        }
    return {"formats": list(written)}


def order_of(results: "Results", formats: Iterable[str], progress: Progress) -> Order:
    """Collect what formats of a run may need beside what they hold."""
    case, formats = results.case, tuple(formats)
    flow = case.flow.flow()
    shown = results.get(CellFields) if "vtk" in formats else None
    slip = None
    if case.flow.fiber_wall == "slip" and "openfoam" in formats:
        radius = fiber_radius(results.read(FaceMesh), results.read(FluidDomain).radius)
        slip = FiberSlip(SLIP_COEFFICIENT * flow.mean_free_path, radius)
    fields = shown.by_name() if shown is not None else {}
    mesh = case.tetmesh
    return Order(case.export, flow, case.enclosure.sides, fields, slip, progress, mesh.engine, mesh.edge, mesh.growth)
