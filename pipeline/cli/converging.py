"""`fibertwin converge`: a pressure drop with its error bar."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import sys
from pathlib import Path

from rich.console import Console

from pipeline.case import read_case
from pipeline.cli.listen import listening
from pipeline.cli.tables import plain_table
from pipeline.errors import CaseError
from pipeline.line import store
from pipeline.line.places import disk_trouble_explained, own_file
from pipeline.line.run import report
from pipeline.nouns.convergence import RESULT, convergence_tables

PLOT = "convergence.svg"


def converge_case(path: Path, folder: Path, seeds: int, overrides: tuple[str, ...], as_json: bool, quiet: bool) -> None:
    """Solve a case on three meshes, keep and print what they tell, and write its page with the error budget."""
    if seeds < 1:
        raise CaseError(f"--seeds {seeds}: one or more")
    case = read_case(path, overrides)
    with listening(Console(stderr=True), quiet or as_json) as progress:
        from pipeline.study.converge import converge
        from pipeline.study.converge_plot import plot_convergence

        found = converge(case, folder, seeds, progress)
        from pipeline.analytics.tables.plots import save_figure

        with disk_trouble_explained(folder):
            store.write_json(own_file(folder / RESULT), found)
            save_figure(plot_convergence(found), own_file(folder / PLOT))
        report(folder, progress)
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(found), indent=2, allow_nan=False) + "\n")
    elif not quiet:
        out = Console()
        for table in convergence_tables(found):
            out.print(plain_table(table.title, table.columns, table.rows))
        out.print(f"Everything is in {folder}", markup=False, highlight=False, soft_wrap=True)
