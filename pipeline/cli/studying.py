"""`fibertwin study`: a case run many times, and its means as a table, as CSV and as a plot."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from pathlib import Path

from rich.console import Console

from pipeline.cli.listen import listening
from pipeline.cli.tables import plain_table
from pipeline.errors import CaseError, StageError
from pipeline.line.places import disk_trouble_explained, own_file
from pipeline.study.settings import Study, read_study
from pipeline.study.study import StudyResult, carry_out_study
from pipeline.study.tables import FAILURES, shown, write_tables

PLOT, PICTURES = "plot.svg", "pictures.png"


def run_study(
    path: Path, folder: Path, workers: int | None, scheduler: str | None, plot: Path | None, quiet: bool
) -> None:
    """Run a study file and print what came of it."""
    if workers is not None and workers < 1:
        raise CaseError(f"--workers {workers}: one or more")
    study = read_study(path)
    out = Console()
    with listening(out, quiet) as progress:
        result = carry_out_study(study, folder, workers, scheduler, progress)
        with disk_trouble_explained(folder):
            written = write_tables(result, folder)
            written += _drawn(study, result, folder, plot)
    if not quiet:
        for number, quantity in enumerate(result.quantities):
            out.print(plain_table(quantity.label, *_table(result, number)))
        out.print()
        out.print(
            f"{result.runs} runs: {result.made} made, {result.reused} kept from before, {result.failed} failed",
            *(f"  {name}" for name in written),
            sep="\n",
            markup=False,
            highlight=False,
            soft_wrap=True,
        )
    if result.failed == result.runs:
        raise StageError(f"all {result.runs} runs failed; {folder / FAILURES} says why")


def _drawn(study: Study, result: StudyResult, folder: Path, plot: Path | None) -> list[Path]:
    written = []
    if any(each.n for point in result.points for each in point.estimates):
        from pipeline.analytics.tables.plots import save_figure
        from pipeline.study.plot import plot_study

        plot = plot or own_file(folder / PLOT)
        save_figure(plot_study(result), plot)
        written.append(plot)
    left_out = frozenset(number for number, point in enumerate(result.points) if point.runs[0].error)
    if study.picture and len(left_out) < len(result.points):
        from pipeline.study.pictures import draw_points

        written.append(own_file(folder / PICTURES))
        draw_points(study, written[-1], left_out)
    return written


def _table(result: StudyResult, number: int) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    columns = (*result.keys, "mean", "95 % interval", "std of one run", "runs", "failed")
    rows = []
    for point in result.points:
        each = point.estimates[number]
        rows.append(
            (
                *(shown(point.settings[key]) for key in result.keys),
                _number(each.mean),
                "+- " + _number(each.half_width, digits=2),
                _number(each.std, digits=2),
                str(each.n),
                str(point.failed),
            )
        )
    return columns, rows


def _number(value: float, digits: int = 5) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}g}"
