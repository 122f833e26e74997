"""`fibertwin twin`: from what was measured on a filter to the case that has it."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from pipeline.case import override, read_toml, validate_as
from pipeline.cli.listen import listening
from pipeline.cli.measuring import path_beside
from pipeline.cli.tables import plain_table
from pipeline.errors import CaseError
from pipeline.line.places import disk_trouble_explained
from pipeline.twin.fibers import fibers_of
from pipeline.twin.match import Twin, match
from pipeline.twin.settings import MeasuredFilter
from pipeline.twin.solved import solver
from pipeline.twin.told import head_of, notes, numbers, table_of
from pipeline.writing import write_whole

UNMATCHED = 3
"""Exit code where the case is the nearest, and not all that was measured is within its tolerance."""


def find_twin(
    file: Path | None,
    options: Mapping[str, str],
    case: Path | None,
    solve: bool,
    out: Path | None,
    as_json: bool,
    quiet: bool,
) -> int:
    """Find the twin, write its case, tell what it has of what was measured, and give the exit code."""
    measured = _measured(file, options)
    if case is not None and os.path.lexists(case):
        raise CaseError(f"{case} is there already; name another file for the case")
    if solve and measured.drop is None:
        raise CaseError(
            '--solve holds the solved pressure drop beside a measured one: give --pressure-drop "45 Pa at 5 cm/s"'
        )
    folder = out or Path("runs") / (case.stem if case is not None else "twin")
    with listening(Console(stderr=True), quiet or as_json) as progress:
        progress("the fibers")
        fibers = fibers_of(measured)
        twin = match(measured, fibers, solver(folder, progress) if solve else None, progress)
    picture = None if fibers.picture is None else path_beside(fibers.picture, case)
    text = twin.text(head_of(twin), picture)
    if case is not None:
        with disk_trouble_explained(case):
            write_whole(case, text)
    if as_json:
        told = {**numbers(twin), "case": None if case is None else str(case)}
        sys.stdout.write(json.dumps(told, indent=2, allow_nan=False) + "\n")
    elif case is None:
        # the case alone goes to the standard output, so that it can be sent into a file
        sys.stdout.write(text)
    if not (as_json or quiet):
        _show(twin, case, Console(stderr=case is None))
    return UNMATCHED if twin.unmatched else 0


def _measured(file: Path | None, options: Mapping[str, str]) -> MeasuredFilter:
    content: dict[str, Any] = {} if file is None else read_toml(file)
    picture = content.get("micrograph")
    if file is not None and isinstance(picture, str):
        # a path in a file starts from the file, wherever the command is run
        content["micrograph"] = str(file.parent / picture)
    for first, second in (("micrograph", "fiber_diameter"), ("fiber_diameter", "micrograph")):
        if first in options and second not in options:
            content.pop(second, None)
    content = override(content, tuple(f"{name}={text}" for name, text in options.items()))
    return validate_as(MeasuredFilter, content, "what was measured" if file is None else str(file))


def _show(twin: Twin, case: Path | None, out: Console) -> None:
    table = table_of(twin)
    out.print(plain_table(table.title, table.columns, table.rows))
    for note in notes(twin):
        out.print(f"- {note}", markup=False, highlight=False, soft_wrap=True)
    if case is not None:
        out.print("run it: fibertwin run", case, markup=False, highlight=False, soft_wrap=True)
