"""A quality report as rows of text, for a terminal or a page."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

from pipeline.nouns.quality import Metric, QualityReport
from pipeline.nouns.section import Table

if TYPE_CHECKING:
    from pipeline.line.results import Results

HEADER = ("metric", "of", "min", "mean", "99 %", "max", "limit", "beyond")


def rows(report: QualityReport) -> list[tuple[str, ...]]:
    """One row per metric, in the columns of `HEADER`.

    Examples
    --------
    >>> metric = Metric("skewness", "1", "faces", 0.0, 0.2, 0.7, 5.0, 4.0, "largest", 1, (), "checkMesh")
    >>> rows(QualityReport(9, 9, 9, 9, {}, 1.0, {"skewness": metric}, "fail"))
    [('skewness', 'faces', '0', '0.2', '0.7', '5', '< 4', '1')]
    """
    return [_row(metric) for metric in report.metrics.values()]


def _row(metric: Metric) -> tuple[str, ...]:
    unit, per_si = shown_unit(metric)
    name = metric.name.replace("_", " ") + ("" if unit == "1" else f" [{unit}]")
    sign = "<" if metric.worst_is == "largest" else ">"
    limit = "" if metric.limit is None else f"{sign} {metric.limit:g}"
    numbers = (f"{value * per_si:.4g}" for value in (metric.min, metric.mean, metric.p99, metric.max))
    return (name, metric.where, *numbers, limit, f"{metric.over_limit:,}" if metric.limit is not None else "")


def shown_unit(metric: Metric) -> tuple[str, float]:
    """Give the unit that suits cells of this size, and how many of it make the metric's own.

    Examples
    --------
    >>> shown_unit(Metric("volume", "m3", "cells", 1e-9, 4e-9, 8e-9, 9e-9, 0.0, "smallest", 0, (), ""))
    ('mm3', 1000000000.0)
    """
    power = {"m3": 3, "m2": 2}.get(metric.unit)
    if power is None:
        return {"degree": "deg"}.get(metric.unit, metric.unit), 1.0
    # cells of a twentieth of a unit of length are the smallest whose area and volume read well
    for name, size in (("m", 1.0), ("mm", 1e-3)):
        if abs(metric.mean) >= (0.05 * size) ** power:
            return f"{name}{power}", float(round(1.0 / size) ** power)
    return f"um{power}", 1e6**power


def summary(report: QualityReport) -> str:
    """One line: size and verdict.

    Examples
    --------
    >>> summary(QualityReport(1000, 300, 2100, 1900, {"inlet": 200}, 1.0, {}, "pass"))
    '1,000 cells, 300 points, 2,100 faces: every limit holds'
    """
    words = {
        "pass": "every limit holds",
        "warn": "usable, with a loss of accuracy where a limit does not hold",
        "fail": "not fit for a solver",
    }
    if report.fibers and report.passed:
        words["pass"] = f"every limit holds, and {report.fibers:,} fibers stand where they should"
    size = f"{report.cells:,} cells, {report.points:,} points, {report.faces:,} faces"
    return f"{size}: {words[report.verdict]}"


def terminal_table(report: QualityReport, opening: str = "") -> Table:
    """Give one line per metric; what each is measured on stands in the JSON, for a terminal is narrow."""
    lines = tuple((name, *numbers) for name, _, *numbers in rows(report))
    return Table(opening + summary(report), (HEADER[0], *HEADER[2:]), lines)


def tables(results: "Results") -> tuple[Table, ...]:
    """Give the table of the mesh."""
    return (terminal_table(results.read(QualityReport), "mesh quality: "),)
