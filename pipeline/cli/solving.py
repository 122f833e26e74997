"""`fibertwin solve`: the solver for a run that is there already."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import sys
from pathlib import Path

from pydantic import BaseModel
from rich.console import Console

from pipeline.case import Case, override, validate_as
from pipeline.cli.listen import listening
from pipeline.cli.tables import outcome_table, result_tables
from pipeline.errors import CaseError, StageError
from pipeline.line.run import LINE, Run, run
from pipeline.nouns.flow import Solution
from pipeline.solve.settings import SolveSettings

SOLVE = "solve"


class _Changes(BaseModel):
    solve: SolveSettings


def solve_run(folder: Path, overrides: tuple[str, ...], again: bool, as_json: bool, quiet: bool) -> None:
    """Bring a run up to its solution and print it."""
    case = _changed(Run.opened(folder).case, overrides)
    with listening(Console(stderr=True), quiet or as_json) as progress:
        outcomes = run(case, folder, SOLVE, frozenset({SOLVE} if again else ()), progress)
    last = next(outcome for outcome in outcomes if outcome.stage == SOLVE)
    if last.how == "skipped":
        raise StageError(f"{folder} was not solved: {last.counts['reason']}")
    results = Run(case, folder)
    solution = results.read(Solution)
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(solution), indent=2, allow_nan=False) + "\n")
    elif not quiet:
        out = Console()
        out.print(outcome_table(outcomes, LINE))
        out.print(*result_tables(results, {SOLVE}))
        out.print(f"Everything is in {last.folder}", markup=False, highlight=False, soft_wrap=True)


def _changed(case: Case, overrides: tuple[str, ...]) -> Case:
    for text in overrides:
        if not text.startswith("solve."):
            raise CaseError(
                f"--set {text}: only keys of solve can be changed for a run that is there; fibertwin run makes another"
            )
    typed = validate_as(_Changes, override({"solve": {"engine": case.solve.engine}}, overrides), "--set").solve
    if typed.engine == case.solve.engine:
        # what the case file says of this solver holds beside what is set here
        own, changed = getattr(case.solve, typed.engine), getattr(typed, typed.engine).model_dump(exclude_unset=True)
        typed = typed.model_copy(update={typed.engine: own.model_copy(update=changed)})
    return case.model_copy(update={"solve": typed})
