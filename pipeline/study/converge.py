"""The pressure drop of a case on three meshes, with the other wall, in a larger box and of other seeds."""

# SPDX-License-Identifier: GPL-3.0-or-later

import statistics
from collections.abc import Mapping
from pathlib import Path

from pipeline.case import Case
from pipeline.errors import CaseError, StageError
from pipeline.line.places import own_folder
from pipeline.line.run import Run, run
from pipeline.mat.settings import BoxSettings, LayeredSettings
from pipeline.nouns.convergence import Contributions, ConvergedDrop, Interval, MeshRung
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.flow import Solution, SolvingCost
from pipeline.nouns.mesh_measures import MeshingCost, TetmeshMeasures
from pipeline.progress import Progress
from pipeline.study.convergence import convergence

FACTORS = (1.3, 1.0, 1.0 / 1.3)
"""Mesh spacing of each rung over the case's, coarse to fine; 1.3 is the least that Celik et al. (2008) advise."""
OTHERS = "convergence"
"""Folder in a run's that holds the runs beside its own."""
_ORDERS = 0.5, 5.0  # observed orders that tell of a mesh's error
_LARGER = 1.25  # side of the larger box over the case's


def converge(case: Case, folder: Path, seeds: int, progress: Progress) -> ConvergedDrop:
    """Solve a case on three meshes and tell its pressure drop with what is known of its error.

    Parameters
    ----------
    case : Case
    folder : Path
        Of the case's own run; the others stand in a folder of it. Finished runs are used again.
    seeds : int
        Mats of this many seeds, the case's own among them, are solved on its mesh.
    progress : Progress

    Returns
    -------
    ConvergedDrop

    Raises
    ------
    CaseError
        If seeds are asked of a mat that no seed draws.
    StageError
        If a run fails.
    """
    drawn = isinstance(case.mat, LayeredSettings | BoxSettings)
    if seeds > 1 and not drawn:
        raise CaseError(
            f'--seeds {seeds}: a mat of generator = "{case.mat.generator}" is always the same; leave it out'
        )
    names = ("coarse", "own", "fine")
    rungs = []
    for name, factor in zip(names, FACTORS, strict=True):
        this = case if name == "own" else case.model_copy(update={"tetmesh": case.tetmesh.scaled(factor)})
        rungs.append(_rung(this, folder if name == "own" else own_folder(folder, OTHERS, name), name, progress))
    answers = (rungs[0].pressure_drop, rungs[1].pressure_drop, rungs[2].pressure_drop)
    # where two meshes came out alike, they tell of the mesher's chance, not of an order
    falling = rungs[0].spacing > rungs[1].spacing > rungs[2].spacing
    found = convergence((rungs[0].spacing, rungs[1].spacing, rungs[2].spacing), answers) if falling else None
    # an order beyond what any element has tells that the meshes' chance is larger than what they leave
    settled = found is not None and _ORDERS[0] <= found.order <= _ORDERS[1]
    fine, spread = answers[2], max(answers) - min(answers)
    if found is not None and settled:
        value, half = found.extrapolated, max(found.index * fine, abs(found.extrapolated - fine))
    else:
        value, half = fine, spread
    notes: list[str] = []
    others = (
        {f"seed {seed}": {"seed": seed} for seed in range(case.mat.seed + 1, case.mat.seed + seeds)} if drawn else {}
    )
    moved = [_beside(case, folder, name, change, notes, progress) for name, change in others.items()]
    of_seeds = (answers[1], *(drop for drop in moved if drop is not None))
    box = {"side": case.mat.side * _LARGER} if drawn else None
    larger = None if box is None else _beside(case, folder, "larger box", box, notes, progress)
    own = rungs[1]
    both = own.pressure_drop_slip is not None and own.pressure_drop_no_slip is not None
    return ConvergedDrop(
        case=folder.resolve().name,
        engine=case.solve.engine,
        fiber_wall=case.flow.fiber_wall,
        pressure_drop=Interval(value, value - half, value + half),
        order=found.order if found is not None and settled else None,
        extrapolated=fine if found is None else found.extrapolated,
        rungs=tuple(rungs),
        contributions=Contributions(
            mesh=own.pressure_drop / value - 1.0,
            slip=float(own.pressure_drop_no_slip or 0.0) / float(own.pressure_drop_slip or 1.0) - 1.0 if both else None,
            box=None if larger is None else larger / own.pressure_drop - 1.0,
            seed=statistics.stdev(of_seeds) / statistics.fmean(of_seeds) if len(of_seeds) > 1 else None,
        ),
        seeds=of_seeds if len(of_seeds) > 1 else (),
        notes=tuple(notes),
    )


def _rung(case: Case, folder: Path, name: str, progress: Progress) -> MeshRung:
    def told(what: str, done: float | None = None) -> None:
        progress(f"{name}: {what}", done)

    run(case, folder, "solve", progress=told, without=frozenset({"report"}))
    results = Run(case, folder)
    solution, measures = results.read(Solution), results.read(TetmeshMeasures)
    seconds = results.read(MeshingCost).seconds + results.read(SolvingCost).seconds
    unit = 2.0 * float(results.read(FluidDomain).radius.mean())
    return MeshRung(
        edge=case.tetmesh.edge,
        cells=measures.cells,
        spacing=(measures.fluid_volume / measures.cells) ** (1 / 3) / unit,
        pressure_drop=solution.pressure_drop,
        pressure_drop_no_slip=solution.pressure_drop_no_slip,
        pressure_drop_slip=solution.pressure_drop_slip,
        seconds=seconds,
    )


def _beside(
    case: Case, folder: Path, name: str, change: Mapping[str, object], notes: list[str], progress: Progress
) -> float | None:
    """Drop of the case with another mat; None and a note where that mat cannot be solved."""
    other = case.model_copy(update={"mat": case.mat.model_copy(update=change)})
    try:
        return _rung(other, own_folder(folder, OTHERS, name.replace(" ", "_")), name, progress).pressure_drop
    except StageError as problem:
        # what moves the number is told as far as it is known; the number itself stands
        notes.append(f"{name}: {problem}")
        return None
