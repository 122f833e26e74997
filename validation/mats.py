"""How far a random mat's pressure drop depends on the mesh and on the size of the box, over a few seeds."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.case import Case
from pipeline.errors import CaseError
from pipeline.line.run import Run, run
from pipeline.mat.settings import LayeredSettings
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution, SolvingCost
from pipeline.nouns.mesh_measures import MeshingCost, TetmeshMeasures
from pipeline.progress import Progress, silent

SEEDS = (1, 2, 3)
SIDES = (7e-6, 10e-6, 14e-6)
"""Box sides of the size study [m]."""
FACTORS = (1.5, 1.0, 0.7)
"""Mesh spacing over the case's, coarse to fine, of the resolution study."""


@dataclass(frozen=True, slots=True)
class MatRun:
    """One mat on one mesh.

    Parameters
    ----------
    side : float [m]
    edge : float [-]
        Edge length at the fibers in fiber diameters, as asked for.
    seed : int
    fibers, cells : int
    thickness : float [m]
    solidity : float [-]
        Of the mesh.
    cfd, davies : float [Pa]
        Pressure drop, solved and by Davies at the mesh's solidity.
    force_balance, mass_balance : float [-]
    iterations : int
    converged : bool
    mesh_seconds, solve_seconds : float [s]
    """

    side: float
    edge: float
    seed: int
    fibers: int
    cells: int
    thickness: float
    solidity: float
    cfd: float
    davies: float
    force_balance: float
    mass_balance: float
    iterations: int
    converged: bool
    mesh_seconds: float
    solve_seconds: float


def mat_case(case: Case, side: float, factor: float, seed: int) -> Case:
    """Give a case another box, another seed, and a mesh with its edges and its envelope scaled.

    Raises
    ------
    CaseError
        If its mat is not layered.
    """
    if not isinstance(case.mat, LayeredSettings):
        raise CaseError("the study of mats needs mat.generator = layered")
    return case.model_copy(
        update={
            "mat": case.mat.model_copy(update={"side": side, "seed": seed}),
            "tetmesh": case.tetmesh.scaled(factor),
        }
    )


def solved(case: Case, folder: Path, progress: Progress = silent) -> MatRun:
    """Run a case of a layered mat and collect what the studies compare.

    Raises
    ------
    StageError
        If a stage fails.
    """
    assert isinstance(case.mat, LayeredSettings)
    run(case, folder, "solve", progress=progress, without=frozenset({"report"}))
    this = Run(case, folder)
    solution, comparison, measures = this.read(Solution), this.read(Comparison), this.read(TetmeshMeasures)
    return MatRun(
        side=case.mat.side,
        edge=case.tetmesh.edge,
        seed=case.mat.seed,
        fibers=this.read(Mat).fibers,
        cells=measures.cells,
        thickness=this.read(Mat).thickness,
        solidity=comparison.solidity["mesh"],
        cfd=solution.pressure_drop,
        davies=comparison.models["davies"].mesh,
        force_balance=solution.force_balance_error,
        mass_balance=solution.mass_balance_error,
        iterations=solution.iterations,
        converged=solution.converged,
        mesh_seconds=this.read(MeshingCost).seconds,
        solve_seconds=this.read(SolvingCost).seconds,
    )


def mat_runs(case: Case, folder: Path, progress: Progress = silent) -> list[MatRun]:
    """Run both studies: the case's box on three meshes, and boxes of other sides on the case's mesh."""
    assert isinstance(case.mat, LayeredSettings)
    pairs = [(case.mat.side, factor) for factor in FACTORS]
    pairs += [(side, 1.0) for side in SIDES if not math.isclose(side, case.mat.side)]
    runs = []
    for side, factor in pairs:
        for seed in SEEDS:
            place = folder / f"side_{1e6 * side:g}_spacing_{factor:g}_seed_{seed}"
            runs.append(solved(mat_case(case, side, factor, seed), place, progress))
    return runs


def mean_and_half_width(values: Sequence[float]) -> tuple[float, float]:
    """Give the mean and the half width of its 95 % confidence interval (Student's t).

    Examples
    --------
    >>> mean, half = mean_and_half_width([1.0, 2.0, 3.0])
    >>> mean, round(half, 3)
    (2.0, 2.484)
    """
    from scipy.stats import t

    count = len(values)
    return float(np.mean(values)), float(t.ppf(0.975, count - 1) * np.std(values, ddof=1) / math.sqrt(count))


def spread(runs: Sequence[MatRun], by: str) -> list[tuple[float, list[MatRun]]]:
    """Group runs by a field, in rising order of it."""
    keys = sorted({getattr(each, by) for each in runs})
    return [(key, [each for each in runs if getattr(each, by) == key]) for key in keys]


def over_finest(runs: Sequence[MatRun]) -> list[tuple[float, list[float]]]:
    """Give per edge length the pressure drop of each mat over that of the same mat on the finest mesh."""
    groups = spread(runs, "edge")
    finest = {each.seed: each.cfd for each in groups[0][1]}
    return [(edge, [each.cfd / finest[each.seed] for each in group]) for edge, group in groups]
