"""The pressure drop of a twin by its solved flow."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.case import Case
from pipeline.errors import StageError
from pipeline.line.run import Run, run
from pipeline.nouns.flow import Solution
from pipeline.progress import Progress
from pipeline.twin.match import Solver


def solver(folder: Path, progress: Progress) -> Solver:
    """Make the function that solves the flow of a case.

    Parameters
    ----------
    folder : Path
        Of the run; the next case takes the place of the last.
    progress : Progress

    Returns
    -------
    callable
        Case -> pressure drop [Pa]. It raises a `StageError` if the flow cannot be solved here, or did not settle.
    """

    def solved(case: Case) -> float:
        outcomes = run(case, folder, "solve", progress=progress, without=frozenset({"report"}))
        last = next(outcome for outcome in outcomes if outcome.stage == "solve")
        if last.how == "skipped":
            raise StageError(f"the flow of the twin was not solved: {last.counts['reason']}")
        solution = Run(case, folder).read(Solution)
        if not solution.converged:
            raise StageError(f"the flow of the twin did not settle; look at {last.folder}")
        return solution.pressure_drop

    return solved
