"""How good the cells are, for the page of a run and for the page of a mesh that is not ours."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pipeline.line.results import Results
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import Metric, QualityReport
from pipeline.nouns.section import Charts, Columns, Heading, Part, Picture, Section, Table, Text
from pipeline.quality.judge import measure
from pipeline.quality.table import HEADER, rows, shown_unit, summary
from pipeline.report.page import charts

_SHOWN_WORST = 5


@dataclass(frozen=True, slots=True)
class LengthUnit:
    """A unit of length: its name, how many make a meter, and the digits that a coordinate has behind the point."""

    name: str
    per_meter: float
    digits: int

    def text(self, value: float) -> str:
        """Write a length [m] as a number of this unit."""
        return f"{value * self.per_meter:.{self.digits}f}"


MICROMETER = LengthUnit("µm", 1e6, 3)
_UNITS = (LengthUnit("m", 1.0, 6), LengthUnit("mm", 1e3, 5), MICROMETER)


def unit_of(mesh: FaceMesh) -> LengthUnit:
    """Give the unit that suits a mesh."""
    return unit_for(float(np.ptp(mesh.points, axis=0).max()))


def unit_for(extent: float) -> LengthUnit:
    """Give the unit in which the largest extent [m] is a number of at least one."""
    return next((unit for unit in _UNITS if extent * unit.per_meter >= 1.0 - 1e-9), MICROMETER)


def section(content: Results) -> Section | None:
    """Show how good the cells of a run are."""
    report = content.get(QualityReport)
    return quality_section(report, content.get(FaceMesh), "worst") if report is not None else None


def quality_section(report: QualityReport, mesh: FaceMesh | None, view: str) -> Section:
    """Make the section: the verdict, the table, a histogram per metric, and where the worst are.

    Parameters
    ----------
    report : QualityReport
    mesh : FaceMesh, optional
        Without it there are no histograms.
    view : str
        The view that shows the worst places.
    """
    measured = measure(mesh) if mesh is not None else ()
    unit = unit_of(mesh) if mesh is not None else MICROMETER
    drawn = [
        chart
        for name, values in measured
        if name in report.metrics and (chart := charts.metric_histogram(report.metrics[name], values)) is not None
    ]
    mark = {"pass": "good", "warn": "note"}.get(report.verdict, "bad")
    worst = Table(
        "", ("metric", "where", "limit", "value", *(f"{axis} [{unit.name}]" for axis in "xyz")),
        tuple(line for metric in report.metrics.values() for line in _worst_rows(metric, unit)),
    )  # fmt: skip
    parts: tuple[Part, ...] = (
        Text(f"{summary(report)}."),
        *(Text(reason, mark) for reason in report.reasons),
        *(Text(f"Note: {note}.", "soft") for note in report.notes),
        Table("", HEADER, tuple(rows(report))),
        Charts(tuple(drawn)),
        Text(
            "Counts on a logarithmic scale, so that single cells show; the red line is the limit, left out where it "
            "lies far off.",
            "soft",
        ),
        Heading("Where the worst are"),
        Columns(
            (
                (Picture(view, "Places of the worst cells and faces beyond a limit, up to five for each metric."),),
                (worst,),
            )
        ),
    )
    return Section("quality", "Quality", "Quality of the mesh", parts)


def _worst_rows(metric: Metric, length: LengthUnit) -> Iterator[tuple[str, ...]]:
    if metric.limit is None:
        return
    # with every limit kept, the single worst is enough to know where to look
    few = min(metric.over_limit, _SHOWN_WORST) or 1
    unit, per_si = shown_unit(metric)
    kept = "broken" if metric.over_limit else "kept"
    singular = metric.where.removesuffix("s")
    for number, value, place in metric.worst[:few]:
        shown = f"{value * per_si:.4g}" + ("" if unit == "1" else f" {unit}")
        coordinates = (length.text(coordinate) for coordinate in place)
        yield (metric.name.replace("_", " "), f"{singular} {number}", kept, shown, *coordinates)
