"""Solve the flow, and keep what was found."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import os
import shutil
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.analytics.formulas.slip import knudsen, slip_length
from pipeline.analytics.models.pressure_models import pressure_model
from pipeline.line import store
from pipeline.line.places import kept_folder
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.exports import OpenFoamCase
from pipeline.nouns.fibers import Mat
from pipeline.openfoam.environment import SOLVER, openfoam_missing
from pipeline.progress import Progress
from pipeline.solve.running import Bed, solve

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Solve the flow."""
    mat, flow, comparison = results.read(Mat), results.case.flow.flow(), results.read(Comparison)
    model = pressure_model(results.case.flow.pressure_model)
    kn = knudsen(flow.mean_free_path, comparison.fiber_diameter)
    # beside the stage and not in it: a killed run continues from there
    work = kept_folder(results.folder, "solve")
    bed = Bed(
        face_area=mat.slab.face_area,
        thickness=mat.thickness,
        pressure_factor=float(model.coefficient(comparison.solidity["mesh"], slip_length(kn))),
        fiber_length=_parallel_length(results, mat, comparison),
    )
    solution = solve(results.read(OpenFoamCase).folder, work, flow, bed, results.case.solve, progress)
    store.write_json(into / "solution.json", solution)
    store.write_json(into / "comparison.json", {**asdict(comparison), "cfd": solution.pressure_drop})
    # not moved: should this process be killed before the stage stands, the solver's run stays where it can go on
    shutil.copytree(work, into / "openfoam", copy_function=_linked)
    return {
        "pressure_drop": solution.pressure_drop,
        "iterations": solution.iterations,
        "converged": solution.converged,
        "force_balance_error": solution.force_balance_error,
    }


def _linked(source: str, target: str) -> None:
    try:
        os.link(source, target)
    except OSError:
        # not every disk has files of two names
        shutil.copy2(source, target)


def _parallel_length(results: "Results", mat: Mat, comparison: Comparison) -> float | None:
    # fibers on a symmetry plane count by half, as they do in the solidity
    if results.case.mat.generator != "array":
        return None
    return comparison.solidity["nominal"] * mat.slab.volume / (math.pi * float(mat.radius[0]) ** 2)


def obstacle(results: "Results") -> str | None:
    """Say what keeps the solver from running; None where nothing does."""
    if "openfoam" not in results.case.export.formats:
        return "export.formats lacks openfoam, the solver's format"
    return openfoam_missing(results.case.solve.cores, SOLVER[results.case.export.dialect])
