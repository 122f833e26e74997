"""Solve the flow, and keep what was found."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import os
import shutil
import time
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.analytics.formulas.slip import knudsen, regime, slip_length
from pipeline.analytics.measured_errors import mesh_error, seed_spread
from pipeline.analytics.models.pressure_models import pressure_model
from pipeline.line import store
from pipeline.line.places import kept_folder, remove
from pipeline.machine import cores, peak_memory
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.exports import OpenFoamCase
from pipeline.nouns.flow import Settling, Solution, SolvingCost
from pipeline.nouns.flow_field import FLOW_FILE
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.surface import Surface
from pipeline.openfoam.environment import SOLVER, openfoam_missing
from pipeline.progress import NOTE, Progress
from pipeline.solve.bed import Bed
from pipeline.solve.paraview import write_paraview
from pipeline.solve.regime import mach, refuse_regime, reynolds
from pipeline.solve.running import seconds_spent, settling, solve

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Solve the flow."""
    surface, flow, comparison = results.read(Surface), results.case.flow.flow(), results.read(Comparison)
    model = pressure_model(results.case.flow.pressure_model)
    kn = knudsen(flow.mean_free_path, comparison.fiber_diameter)
    bed = Bed(
        face_area=surface.slab.face_area,
        thickness=surface.slab.size[2],
        pressure_factor=float(model.coefficient(comparison.solidity["mesh"], slip_length(kn))),
        fiber_length=_parallel_length(results, surface, comparison),
    )
    engine = _by_openfoam if results.case.solve.engine == "openfoam" else _by_elements
    solution, settled, cost = engine(results, into, bed, progress)
    solution = with_known_errors(solution, results)
    store.write_json(into / "solution.json", solution)
    store.write_json(into / "settling.json", settled)
    store.write_json(into / "cost.json", cost)
    store.write_json(into / "comparison.json", {**asdict(comparison), "cfd": solution.pressure_drop})
    return {
        "pressure_drop": solution.pressure_drop,
        "iterations": solution.iterations,
        "converged": solution.converged,
        "force_balance_error": solution.force_balance_error,
    }


def with_known_errors(solution: Solution, results: "Results") -> Solution:
    """Add what is known of the error without solving other meshes and other mats."""
    case, diameter = results.case, results.read(Comparison).fiber_diameter
    mesh = mesh_error(case.tetmesh.engine, solution.engine, case.tetmesh.edge, case.tetmesh.growth)
    slab = results.read(Surface).slab
    drawn = case.mat.generator in ("layered", "box")
    return replace(
        solution,
        mesh_error=None if mesh is None else (mesh.mean, mesh.low, mesh.high),
        seed_spread=seed_spread(slab.face_area / diameter**2) if drawn else None,
    )


def _by_elements(
    results: "Results", into: Path, bed: Bed, progress: Progress
) -> tuple[Solution, Settling, SolvingCost]:
    from pipeline.solve.stokes.flow_file import write_flow
    from pipeline.solve.stokes.kept import KeptSolve
    from pipeline.solve.stokes.solver import solve_stokes

    began = time.monotonic()
    case, flow = results.case, results.case.flow.flow()
    # beside the stage and not in it: a run that was stopped goes on from there, unless something changed
    whole = kept_folder(results.folder, "solve")
    place = whole / results.key[:16]
    if whole.exists() and not place.exists():
        progress(f"{NOTE}solve: what a stopped run kept is left: it is of another mesh, case or program")
        remove(whole)
    kept = KeptSolve(place, progress)
    solution, field, settled = solve_stokes(
        results.read(FaceMesh),
        results.read(FluidDomain),
        flow,
        bed,
        results.read(Comparison).solidity["mesh"],
        case.flow.fiber_wall,
        case.enclosure.sides,
        case.solve.stokes,
        progress,
        cores(),
        kept,
    )
    store.save(field, into / "flow.npz")
    write_flow(field, flow.viscosity, into / FLOW_FILE)
    write_paraview(into)
    seconds = kept.before + time.monotonic() - began
    return solution, settled, SolvingCost(seconds, cores(), peak_memory(), kept.iterations)


def _by_openfoam(
    results: "Results", into: Path, bed: Bed, progress: Progress
) -> tuple[Solution, Settling, SolvingCost]:
    case, flow = results.case, results.case.flow.flow()
    comparison, wall = results.read(Comparison), case.flow.fiber_wall
    diameter = comparison.fiber_diameter
    refuse_regime(flow, diameter, comparison.solidity["mesh"], wall)
    # beside the stage and not in it: a killed run continues from there
    work = kept_folder(results.folder, "solve")
    solution = solve(results.read(OpenFoamCase).folder, work, flow, bed, case.solve.openfoam, progress)
    # not moved: should this process be killed before the stage stands, the solver's run stays where it can go on
    shutil.copytree(work, into / "openfoam", copy_function=_linked)
    kn = float(knudsen(flow.mean_free_path, diameter))
    whole = replace(
        solution,
        fiber_wall=wall,
        pressure_drop_no_slip=solution.pressure_drop if wall == "no_slip" else None,
        pressure_drop_slip=solution.pressure_drop if wall == "slip" else None,
        inertia=True,
        reynolds=reynolds(flow, diameter),
        mach=mach(flow, flow.face_velocity),
        knudsen=kn,
        regime=regime(kn),
    )
    cost = SolvingCost(seconds_spent(work), case.solve.openfoam.cores)
    return whole, settling(work, flow, wall), cost


def _linked(source: str, target: str) -> None:
    try:
        os.link(source, target)
    except OSError:
        # not every disk has files of two names
        shutil.copy2(source, target)


def _parallel_length(results: "Results", surface: Surface, comparison: Comparison) -> float | None:
    # fibers on a symmetry plane count by half, as they do in the solidity
    if results.case.mat.generator != "array":
        return None
    return comparison.solidity["nominal"] * surface.slab.volume / (math.pi * float(surface.radius[0]) ** 2)


def obstacle(results: "Results") -> str | None:
    """Say what keeps the solver from running; None where nothing does."""
    if results.case.solve.engine != "openfoam":
        return None
    if "openfoam" not in results.case.export.formats:
        return "export.formats lacks openfoam, the format of solve.engine = openfoam"
    return openfoam_missing(results.case.solve.openfoam.cores, SOLVER[results.case.export.dialect])
