"""`fibertwin permeability`: what a mat lets through along each of its axes."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import sys
from pathlib import Path

from rich.console import Console

from pipeline.case import read_case
from pipeline.cli.listen import listening
from pipeline.cli.tables import plain_table
from pipeline.line import store
from pipeline.line.places import disk_trouble_explained, own_file
from pipeline.line.run import report
from pipeline.nouns.permeability import RESULT, permeability_table


def permeability_of_case(path: Path, folder: Path, overrides: tuple[str, ...], as_json: bool, quiet: bool) -> None:
    """Solve a mat along its three axes, keep and print what was found."""
    case = read_case(path, overrides)
    with listening(Console(stderr=True), quiet or as_json) as progress:
        from pipeline.study.permeability import permeability

        found = permeability(case, folder, progress)
        with disk_trouble_explained(folder):
            store.write_json(own_file(folder / RESULT), found)
        report(folder, progress)
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(found), indent=2, allow_nan=False) + "\n")
    elif not quiet:
        out = Console()
        table = permeability_table(found)
        out.print(plain_table(table.title, table.columns, table.rows))
        out.print(f"Everything is in {folder}", markup=False, highlight=False, soft_wrap=True)
