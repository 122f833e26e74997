"""Run a study: what is done is kept, what fails is told, and the rest goes on."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import traceback
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.errors import CaseError, FibertwinError
from pipeline.line import places
from pipeline.progress import Progress, silent
from pipeline.study.one import read_result
from pipeline.study.plan import RESULTS, WORK, Task, plan
from pipeline.study.quantity import Quantity, Results, value_of
from pipeline.study.settings import Reference, Study
from pipeline.study.summary import Estimate, estimate
from pipeline.study.workers import carried_out


@dataclass(frozen=True, slots=True)
class RunRow:
    """One run: its seed, its values by quantity (NaN where there is none), and its error if it failed."""

    seed: int
    folder: str
    values: tuple[float, ...]
    error: str = ""


@dataclass(frozen=True, slots=True)
class PointRow:
    """One combination of the swept keys, its runs, and the estimate of each quantity."""

    settings: dict[str, Any]
    runs: tuple[RunRow, ...]
    estimates: tuple[Estimate, ...]

    @property
    def failed(self) -> int:
        """How many of its runs failed."""
        return sum(bool(run.error) for run in self.runs)


@dataclass(frozen=True, slots=True)
class StudyResult:
    """What a study found.

    Parameters
    ----------
    keys : tuple of str
        The swept keys.
    quantities : tuple of Quantity
    points : tuple of PointRow
    made, reused : int
        Runs of this time, and of earlier times.
    references : tuple of Reference
        What somebody else found, for the plot.
    """

    keys: tuple[str, ...]
    quantities: tuple[Quantity, ...]
    points: tuple[PointRow, ...]
    made: int
    reused: int
    references: tuple[Reference, ...] = ()

    @property
    def failed(self) -> int:
        """How many runs failed."""
        return sum(point.failed for point in self.points)

    @property
    def runs(self) -> int:
        """How many runs there are, with those that failed."""
        return sum(len(point.runs) for point in self.points)


def carry_out_study(
    study: Study,
    folder: Path,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> StudyResult:
    """Run what is still to be run of a study, and put everything together.

    Parameters
    ----------
    study : Study
    folder : Path
        Where results are kept; the same study in the same folder continues.
    workers, scheduler : optional
        As for `pipeline.study.workers.carried_out`.
    progress : Progress

    Returns
    -------
    StudyResult

    Raises
    ------
    CaseError
        If the study asks for nonsense, also for a measure that its results do not have.
    StageError
        If the folder cannot be written or the scheduler cannot be reached.
    """
    tasks = plan(study, folder)
    errors: dict[str, str] = {}
    with places.locked(folder):
        for name in (RESULTS, WORK):
            places.own_folder(folder, name)
        todo = [task for task in tasks if not task.done]
        kept = len(tasks) - len(todo)
        asked = _Asked(study.quantities)
        if kept:
            asked.check(read_result(next(task for task in tasks if task not in todo)))
        if todo:
            progress(f"runs, {kept} of {len(tasks)} kept from before", kept / len(tasks))
            for done, (task, outcome) in enumerate(carried_out(todo, workers, scheduler), start=1):
                if isinstance(outcome, BaseException):
                    errors[task.name] = _told(outcome)
                else:
                    asked.check(outcome)
                failed = f", {len(errors)} failed" if errors else ""
                progress(f"runs, {kept + done} of {len(tasks)} done{failed}", (kept + done) / len(tasks))
        points = tuple(_point(study, number, settings, tasks, errors) for number, settings in enumerate(study.points()))
    return StudyResult(tuple(study.sweep), study.quantities, points, len(todo) - len(errors), kept, study.reference)


class _Asked:
    """Check once, with the first results that come, that they have all that is asked for."""

    def __init__(self, quantities: Iterable[Quantity]) -> None:
        self.quantities = tuple(quantities)
        self.checked = False

    def check(self, results: Results) -> None:
        if self.checked:
            return
        mistakes = []
        for quantity in self.quantities:
            try:
                value_of(quantity, results)
            except CaseError as problem:
                mistakes.append(str(problem))
        if mistakes:
            end = "finished runs are kept, and the corrected study continues"
            raise CaseError("\n".join([*mistakes, end]))
        self.checked = True


def _told(problem: BaseException) -> str:
    if isinstance(problem, FibertwinError):
        return str(problem)
    # a bug, or a worker that died: its traceback is what helps
    return "".join(traceback.format_exception(problem)).strip()


def _point(study: Study, number: int, settings: dict[str, Any], tasks: list[Task], errors: dict[str, str]) -> PointRow:
    runs = tuple(_row(study, task, errors.get(task.name, "")) for task in tasks if task.point == number)
    columns = zip(*(run.values for run in runs), strict=True)
    return PointRow(settings, runs, tuple(map(estimate, columns)))


def _row(study: Study, task: Task, error: str) -> RunRow:
    folder = task.result.relative_to(task.folder).as_posix()
    if error:
        return RunRow(task.seed, folder, (math.nan,) * len(study.measure), error)
    results = read_result(task)
    return RunRow(task.seed, folder, tuple(value_of(quantity, results) for quantity in study.quantities))
