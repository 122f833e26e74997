"""Small random mats on meshes of several edges, meshers and solvers: what each leaves of error, and what it costs."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import os
import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from pipeline.analytics.measured_errors import EdgeError, SeedSpread
from pipeline.case import Case
from pipeline.line.run import Run, run
from pipeline.mat.settings import LayeredSettings
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.flow import Solution
from pipeline.nouns.mat_measures import MatMeasures
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.progress import Progress, silent
from pipeline.solve.settings import SolveSettings

REFINED = range(1, 6)
"""Seeds that are solved on every mesh."""
SEEDS = range(1, 11)
"""Seeds that are solved on the usual mesh of both meshers."""
USUAL = 0.6
MESHES = (
    ("tetwild", 1.0, 1.0, False),
    ("tetwild", 0.8, 1.0, False),
    ("tetwild", 0.6, 1.0, True),
    ("tetwild", 0.4, 1.0, True),
    ("tetwild", 0.3, 1.0, True),
    ("tetwild", 0.4, 0.67, True),
    ("tetwild", 0.3, 0.5, True),
    ("lattice", 0.8, 1.0, False),
    ("lattice", 0.6, 1.0, True),
    ("lattice", 0.4, 1.0, True),
    ("snappy", 0.6, 1.0, True),
    ("snappy", 0.4, 1.0, True),
    ("snappy", 0.3, 1.0, True),
    ("snappy", 0.2, 1.0, True),
)
"""Mesher, edge in fiber diameters, growth, and whether finite volumes are solved on it too."""
FINE_ENOUGH = 0.4
"""Edge of fTetWild's meshes from which on elements stand for a mat's limit: the finest of each mat is taken."""


@dataclass(frozen=True, slots=True)
class MatRun:
    """One mat on one mesh, with slip as a case has it.

    Parameters
    ----------
    seed : int
    mesher : str
    edge : float [-]
        Edge length at the fibers in fiber diameters, as asked for.
    growth : float [-]
        How much longer edges become per distance from the fibers.
    cells : int
    length : float [-]
        Of all fibers, in fiber diameters.
    solidity : float [-]
        Of the mesh.
    elements, volumes : float [Pa]
        Pressure drop by second-order elements and by simpleFoam; nan where that was not solved.
    mesh_seconds, elements_seconds, volumes_seconds : float [s]
        Of processor time: the line up to the mesh and its report, and each solver with the files that it needs.
    """

    seed: int
    mesher: str
    edge: float
    growth: float
    cells: int
    length: float
    solidity: float
    elements: float
    volumes: float
    mesh_seconds: float
    elements_seconds: float
    volumes_seconds: float


def mat_case(case: Case, seed: int, mesher: str, edge: float, growth: float = 1.0) -> Case:
    """Give a case of a random mat another seed, and another mesh."""
    mesh = {"engine": mesher, "edge": edge, "growth": growth}
    return case.model_copy(
        update={
            "mat": case.mat.model_copy(update={"seed": seed}),
            "tetmesh": type(case.tetmesh).model_validate(mesh),
        }
    )


def solved(case: Case, folder: Path, volumes: bool, progress: Progress = silent) -> MatRun:
    """Run a case of a random mat, and solve it with elements where they take the mesh, and with volumes if asked.

    Raises
    ------
    StageError
        If a stage fails.
    """
    elements = case.tetmesh.engine != "snappy"
    drops, seconds = {"stokes": math.nan, "openfoam": math.nan}, {"stokes": math.nan, "openfoam": math.nan}
    meshing = _seconds(case, folder, "compare", frozenset({"report", "export"}), progress)
    for engine, asked in (("stokes", elements), ("openfoam", volumes)):
        if asked:
            this = case.model_copy(update={"solve": SolveSettings.model_validate({"engine": engine})})
            without = {"report"} if engine == "openfoam" else {"report", "export"}
            seconds[engine] = _seconds(this, folder, "solve", frozenset(without), progress)
            drops[engine] = Run(this, folder).read(Solution).pressure_drop
    results = Run(case, folder)
    return MatRun(
        seed=int(getattr(case.mat, "seed")),  # noqa: B009 - not every generator draws
        mesher=case.tetmesh.engine,
        edge=case.tetmesh.edge,
        growth=case.tetmesh.growth,
        cells=results.read(TetmeshMeasures).cells,
        length=results.read(MatMeasures).total_length / results.read(Comparison).fiber_diameter,
        solidity=results.read(Comparison).solidity["mesh"],
        elements=drops["stokes"],
        volumes=drops["openfoam"],
        mesh_seconds=meshing,
        elements_seconds=seconds["stokes"],
        volumes_seconds=seconds["openfoam"],
    )


def _seconds(case: Case, folder: Path, until: str, without: frozenset[str], progress: Progress) -> float:
    began = os.times()
    run(case, folder, until, progress=progress, without=without)
    return sum(os.times()[:4]) - sum(began[:4])


def mat_runs(case: Case, folder: Path, progress: Progress = silent) -> Iterator[Callable[[], MatRun]]:
    """Give every run of the study."""
    for seed in SEEDS:
        for mesher, edge, growth, volumes in MESHES:
            if seed in REFINED or (edge == USUAL and mesher != "snappy"):
                place = folder / f"{mesher}_{edge:g}_{growth:g}_{seed}"
                yield partial(solved, mat_case(case, seed, mesher, edge, growth), place, volumes, progress)


def limits(runs: Sequence[MatRun]) -> dict[int, tuple[float, MatRun | None]]:
    """Give for every seed the pressure drop [Pa] that stands for its limit, and the run that it was taken from.

    It is that of elements on the finest of fTetWild's meshes; where a mat has none that is fine enough, that on the
    usual mesh less the mean error which the usual mesh has on the others.
    """
    own = [each for each in runs if each.mesher == "tetwild" and each.growth == 1.0 and math.isfinite(each.elements)]
    found: dict[int, tuple[float, MatRun | None]] = {}
    for each in sorted(own, key=lambda each: -each.edge):
        if each.edge <= FINE_ENOUGH:
            found[each.seed] = each.elements, each
    usual = {each.seed: each.elements for each in own if each.edge == USUAL}
    both = [usual[seed] / found[seed][0] for seed in usual if seed in found]
    if both:
        for seed in usual.keys() - found.keys():
            found[seed] = usual[seed] / statistics.fmean(both), None
    return found


def edge_errors(runs: Sequence[MatRun]) -> list[EdgeError]:
    """Tell, for every mesher, solver and edge, the errors against each mat's limit."""
    limit, found = limits(runs), []
    for mesher, edge, growth, _ in MESHES:
        mesh = mesher, edge, growth
        group = [each for each in runs if (each.mesher, each.edge, each.growth) == mesh and each.seed in limit]
        for solver, drop, spent in (
            ("stokes", "elements", "elements_seconds"),
            ("openfoam", "volumes", "volumes_seconds"),
        ):
            rows = [each for each in group if math.isfinite(getattr(each, drop))]
            if (solver, mesher) == ("stokes", "tetwild") and growth == 1.0:
                # no mesh is held against itself
                rows = [each for each in rows if limit[each.seed][1] not in (each, None)]
            if rows:
                errors = [getattr(each, drop) / limit[each.seed][0] - 1.0 for each in rows]
                found.append(
                    EdgeError(
                        mesher, solver, edge, growth, len(errors), statistics.fmean(errors), min(errors), max(errors),
                        statistics.fmean(each.cells / each.length for each in rows),
                        statistics.median((each.mesh_seconds + getattr(each, spent)) / each.length for each in rows),
                    )
                )  # fmt: skip
    return found


def of_seeds(runs: Sequence[MatRun], case: Case) -> SeedSpread:
    """Tell how much the seeds differ, on the usual mesh of the default mesher."""
    assert isinstance(case.mat, LayeredSettings)
    drops = [each.elements for each in runs if (each.mesher, each.edge) == ("tetwild", USUAL)]
    area = (case.mat.side / case.mat.fiber_diameter.mean) ** 2
    return SeedSpread(area, len(drops), statistics.stdev(drops) / statistics.fmean(drops))
