"""A study's results as CSV files: one line per run, and one line per combination."""

# SPDX-License-Identifier: GPL-3.0-or-later

import csv
import io
import math
from pathlib import Path
from typing import Any

from pipeline.line.places import write_text
from pipeline.study.settings import toml_value
from pipeline.study.study import StudyResult

RUNS, SUMMARY, FAILURES = "runs.csv", "summary.csv", "failures.txt"


def write_tables(result: StudyResult, folder: Path) -> list[Path]:
    """Write ``runs.csv``, ``summary.csv`` and, if runs failed, ``failures.txt``.

    The summary has, for each quantity, the number of runs that gave it, the mean, the standard deviation of one run
    and the half width of the mean's 95 % confidence interval.

    Returns
    -------
    list of Path
    """
    write_text(folder / RUNS, runs_csv(result))
    write_text(folder / SUMMARY, summary_csv(result))
    written = [folder / RUNS, folder / SUMMARY]
    failures = folder / FAILURES
    failures.unlink(missing_ok=True)
    if result.failed:
        write_text(failures, failures_text(result))
        written.append(failures)
    return written


def runs_csv(result: StudyResult) -> str:
    """Give one line per run."""
    labels = [quantity.label for quantity in result.quantities]
    lines = [[*result.keys, "mat.seed", *labels, "error", "folder"]]
    for point in result.points:
        swept = [shown(point.settings[key]) for key in result.keys]
        for run in point.runs:
            error = run.error.splitlines()[-1].strip() if run.error else ""
            lines.append([*swept, str(run.seed), *map(_number, run.values), error, run.folder])
    return _csv(lines)


def summary_csv(result: StudyResult) -> str:
    """Give one line per combination."""
    labels = [quantity.label for quantity in result.quantities]
    parts = [f"{label} {part}" for label in labels for part in ("mean", "std", "ci95", "n")]
    lines = [[*result.keys, "runs", "failed", *parts]]
    for point in result.points:
        swept = [shown(point.settings[key]) for key in result.keys]
        numbers = [
            text
            for each in point.estimates
            for text in (_number(each.mean), _number(each.std), _number(each.half_width), str(each.n))
        ]
        lines.append([*swept, str(len(point.runs)), str(point.failed), *numbers])
    return _csv(lines)


def failures_text(result: StudyResult) -> str:
    """Give the whole error of each run that failed, below what would run it again."""
    blocks = []
    for point in result.points:
        settings = " ".join(f"--set '{key}={shown(value)}'" for key, value in point.settings.items())
        blocks += [f"{settings} --set mat.seed={run.seed}\n{run.error}\n" for run in point.runs if run.error]
    return "\n".join(blocks)


def shown(value: Any) -> str:
    """Give a swept value as people read it."""
    return value if isinstance(value, str) else toml_value(value)


def _number(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.10g}"


def _csv(lines: list[list[str]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(lines)
    return text.getvalue()
