"""Send particles through a run's solved flow, and keep what was caught."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT
from pipeline.analytics.settings import FilterSettings
from pipeline.capture.capture import Caught, Medium, capture
from pipeline.capture.cells import Cells, cells_of
from pipeline.capture.openfoam_flow import openfoam_cells
from pipeline.errors import StageError
from pipeline.line import store
from pipeline.line.places import kept_folder, remove
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Count what the filter catches."""
    case, domain, solution = results.case, results.read(FluidDomain), results.read(Solution)
    comparison = results.read(Comparison)
    cells, source, solver = _flow(results, progress)
    medium = Medium(
        mat=results.read(Mat),
        pieces=domain.pieces,
        box=domain.box,
        wraps=case.enclosure.sides == "cyclic",
        cells=cells,
        pressure_drop=solution.pressure_drop,
        solver=solver,
        model=FilterSettings(
            solidity=comparison.solidity["mesh"],
            thickness=comparison.thickness,
            fiber_diameter=comparison.fiber_diameter,
        ),
    )
    # beside the stage and not in it: a killed run goes on from its finished batches, unless something changed
    whole = kept_folder(results.folder, "capture")
    key = store.digest([results.key, source])
    kept = whole / key[:16]
    if whole.exists() and not kept.exists():
        remove(whole)
    found, caught = capture(medium, case.capture, case.flow, progress, kept)
    store.write_json(into / "capture.json", found)
    write_caught(caught, into / "captured.vtp")
    worst = found.most_penetrating["cfd"]
    return {
        "particles": sum(found.released),
        "most_penetrating": worst.diameter,
        "least_efficiency": min(found.efficiency),
        "timed_out": sum(found.timed_out),
    }


def obstacle(results: "Results") -> str | None:
    """Say why nothing is caught: a medium that is there as a surface has no fibers to stick to."""
    if results.case.mat.generator == "surface":
        return "captures need the fibers' axes, and a medium that is there as a surface has none"
    return None


def _flow(results: "Results", progress: Progress) -> tuple[Cells, str, str]:
    """Read the velocity, the digest of what it was read from, and the name of the solver."""
    progress("capture: reading the flow")
    field = results.get(FlowField)
    if field is not None:
        cells = cells_of(field.cells, field.positions, field.velocity)
        return cells, store.file_digest(results.path(FlowField)), "stokes"
    folder = results.path(Solution).parent / "openfoam"
    if not folder.is_dir():
        raise StageError("the solved flow has no velocity to follow; solve it again with --force solve")
    air = results.case.flow
    length = SLIP_COEFFICIENT * air.flow().mean_free_path if air.fiber_wall == "slip" else 0.0
    cells, files = openfoam_cells(folder, results.read(FaceMesh), length)
    return cells, store.digest([store.file_digest(file) for file in files]), "openfoam"


def write_caught(caught: Caught, path: Path) -> None:
    """Write where particles stick for ParaView: one point each, with its diameter [m], fiber and time [s]."""
    import numpy as np
    import pyvista

    points = pyvista.PolyData(np.ascontiguousarray(caught.place)) if len(caught.place) else pyvista.PolyData()
    for name in ("particle_diameter", "fiber", "time"):
        points.point_data[name] = getattr(caught, name)
    points.save(path)
