"""`fibertwin run`: the line with its progress, and a summary that says where everything is."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import sys
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from rich.console import Console

from pipeline.case import Case, read_case
from pipeline.cli.listen import listening
from pipeline.cli.tables import outcome_table, prospect_table, result_tables
from pipeline.errors import CaseError, StageError
from pipeline.line.run import LAST, LINE, STAGES, Outcome, Run, dry_run, run
from pipeline.report.stage import PAGE


def run_case(
    path: Path,
    folder: Path,
    until: str | None,
    overrides: tuple[str, ...],
    force: tuple[str, ...],
    as_json: bool,
    quiet: bool,
    dry: bool = False,
) -> None:
    """Run a case file and print what came of it; or only tell what would."""
    for name in (*force, *([until] if until else [])):
        if name not in STAGES:
            raise CaseError(f"there is no stage {name!r}; the stages are {', '.join(STAGES)}")
    case = read_case(path, overrides)
    out = Console()
    if dry:
        prospects = dry_run(case, folder, until or LAST, frozenset(force))
        if as_json:
            told = {"folder": str(folder), "stages": [asdict(each) for each in prospects]}
            sys.stdout.write(json.dumps(told, indent=2, allow_nan=False) + "\n")
        else:
            out.print(prospect_table(prospects))
        return
    with listening(Console(stderr=True) if as_json else out, quiet) as progress:
        outcomes = run(case, folder, until or LAST, frozenset(force), progress)
    if as_json:
        stages = [{**asdict(outcome), "folder": str(outcome.folder)} for outcome in outcomes]
        sys.stdout.write(json.dumps({"folder": str(folder), "stages": stages}, indent=2, allow_nan=False) + "\n")
    elif not quiet:
        _show(outcomes, case, folder, out)
    _tell_failures(outcomes)


def _tell_failures(outcomes: Iterable[Outcome]) -> None:
    """End with an error where a stage left out a part of what it was asked for: the rest of the run is there.

    Raises
    ------
    StageError
    """
    lacking = [
        f"{outcome.stage}: cannot write {what}"
        for outcome in outcomes
        if isinstance(failed := outcome.counts.get("failed"), list)
        for what in failed
    ]
    if lacking:
        raise StageError("; ".join(lacking) + "; all else was made")


def _show(outcomes: list[Outcome], case: Case, folder: Path, out: Console) -> None:
    out.print(outcome_table(outcomes, LINE))
    for table in result_tables(Run(case, folder), {each.stage for each in outcomes if each.how != "skipped"}):
        out.print(table)
    out.print(*_next_steps(folder), sep="\n", markup=False, highlight=False, soft_wrap=True)


def _next_steps(folder: Path) -> list[str]:
    steps = [f"Everything is in {folder}"]
    page = folder / "report" / PAGE
    if page.is_file():
        steps.append(f"  read it:    {page}")
    solved, flow = (folder / "solve" / "solution.json").is_file(), folder / "solve" / "flow.vtu"
    openfoam, vtk = folder / "export" / "openfoam", folder / "export" / "vtk"
    if not solved and (folder / "tetmesh").is_dir():
        steps.append(f"  solve it:   fibertwin solve {folder}")
    if openfoam.is_dir():
        steps.append(f"  your own:   {openfoam} is a case for OpenFOAM (./Allrun)")
    if flow.is_file():
        steps.append(f"  look at it: paraview {flow}")
    elif vtk.is_dir():
        steps.append(f"  look at it: paraview {next(vtk.glob('*.vtm'), vtk)}")
    if (folder / "mat").is_dir():
        steps.append(f"  turn it:    fibertwin view {folder}   (or --html model.html, for any browser)")
    return steps
