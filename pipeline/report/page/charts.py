"""Charts of a run: what its mat is made of, how good its cells are, what the models say."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.analytics.tables.plots import draw_efficiency, draw_figure_of_merit, draw_pressure_drop
from pipeline.nouns.arrays import Floats
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Settling, Solution
from pipeline.nouns.mat_measures import MatMeasures
from pipeline.nouns.quality import Metric
from pipeline.quality.table import shown_unit
from pipeline.report.page.svg import BLUE, GREEN, INK, ORANGE, RED, chart

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TYPESET = str.maketrans("u23", "µ²³")
_MANY_BARS = 60
_SECTORS = 12  # of 15 degrees each
_BINS = 60
_MANY = 30.0  # the worst over the median, from which a logarithmic scale shows more
_LEAST = 0.7  # lowest count shown: a single cell still has height on a logarithmic scale
_LINEAR = ("degree",)  # units whose whole range fits on a plain scale
_SAME = 1e-9  # values that differ by less, relatively, differ by rounding


def diameter_histogram(mat: Mat) -> Markup:
    """Count the fibers by diameter, of which there is more than one."""
    from matplotlib.ticker import MaxNLocator

    diameters = 2e6 * mat.radius

    def draw(axes: "Axes") -> None:
        axes.hist(diameters, bins=min(30, 5 + mat.fibers // 4), color=BLUE)
        axes.set(xlabel="fiber diameter [µm]", ylabel="fibers", title="Diameters")
        axes.yaxis.set_major_locator(MaxNLocator(integer=True))

    return chart("diameters", draw)


def orientation_histogram(mat: Mat) -> Markup:
    """Fiber length by direction in the plan, against a mat without a preferred direction."""
    start = mat.segment_starts()
    step = mat.nodes[start + 1] - mat.nodes[start]
    angle = np.degrees(np.arctan2(step[:, 1], step[:, 0])) % 180.0
    share, edges = np.histogram(angle, bins=_SECTORS, range=(0, 180), weights=mat.segment_lengths())
    share = 100.0 * share / share.sum()

    def draw(axes: "Axes") -> None:
        axes.bar(edges[:-1], share, width=np.diff(edges), align="edge", color=BLUE, edgecolor="none", linewidth=0)
        axes.axhline(100.0 / _SECTORS, color=INK, linewidth=1, linestyle="--", label="no preferred direction")
        axes.set(
            xlabel="direction in the plan [degree from x]", ylabel="share of fiber length [%]",
            xticks=range(0, 181, 30), xlim=(0, 180), ylim=(0, 1.25 * float(share.max())), title="Orientation",
        )  # fmt: skip
        axes.legend(frameon=False, loc="upper right")

    return chart("orientation", draw)


def thickness_profile(measures: MatMeasures) -> Markup:
    """Solidity of thin layers through the mat."""
    z = 1e6 * np.array(measures.profile.z)
    solidity = 100.0 * np.array(measures.profile.solidity)

    def draw(axes: "Axes") -> None:
        axes.fill_betweenx(z, 0, solidity, color=BLUE, alpha=0.25, linewidth=0)
        axes.plot(solidity, z, color=BLUE, linewidth=1.5)
        axes.axvline(100.0 * measures.solidity, color=INK, linewidth=1, linestyle="--", label="mean")
        axes.set(xlabel="solidity [%]", ylabel="height z, along the flow [µm]", title="Through the thickness")
        axes.set_xlim(left=0)
        axes.set_ylim(0, 1e6 * measures.thickness)
        axes.legend(frameon=False)

    return chart("profile", draw)


def metric_histogram(metric: Metric, values: Floats) -> Markup | None:
    """Count cells or faces by their value of a metric, with its limit; None where all of them have one value."""
    name, scale = shown_unit(metric)
    unit = "" if name == "1" else f" [{name.translate(_TYPESET)}]" if metric.unit in ("m2", "m3") else f" [{name}]"
    values = values[np.isfinite(values)] * scale
    if not len(values):
        return None
    low, high = float(values.min()), float(values.max())
    if high - low <= _SAME * abs(high):
        return None
    limit = None if metric.limit is None else metric.limit * scale
    wide = _wants_decades(metric, values)
    if wide:
        values = values[values > 0]
        low = float(values.min())
    # the limit belongs into the picture, unless the values would become a line at its edge
    shown = limit is not None and _is_near(limit, low, high, wide)
    if shown and limit is not None:
        low, high = min(low, limit), max(high, limit)
    edges = np.geomspace(low, high, _BINS + 1) if wide else np.linspace(low, high, _BINS + 1)
    counts, _ = np.histogram(values, edges)

    def draw(axes: "Axes") -> None:
        axes.stairs(counts, edges, fill=True, color=BLUE, baseline=_LEAST)
        axes.set_yscale("log")
        axes.set_ylim(bottom=_LEAST)
        axes.xaxis.set_major_locator(MaxNLocator(6))
        if wide:
            axes.set_xscale("log")
        if shown and limit is not None:
            axes.axvline(limit, color=RED, linewidth=1.5)
        for axis in [axes.yaxis, *([axes.xaxis] if wide else [])]:
            # powers as plain numbers: setting formulas costs more time than all the rest
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
        sign = "below" if metric.worst_is == "largest" else "above"
        aim = "" if limit is None else f" (limit: {sign} {limit:g})"
        axes.set(xlabel=f"{metric.name.replace('_', ' ')}{unit}{aim}", ylabel=metric.where)

    from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter

    return chart(f"metric-{metric.name}", draw, (4.4, 2.7))


def _wants_decades(metric: Metric, values: Floats) -> bool:
    """Whether the side of trouble spans so much that it shows only on a logarithmic scale."""
    if metric.unit in _LINEAR:
        return False
    middle = float(np.median(values))
    if metric.worst_is == "largest":
        return bool(middle > 0 and values.max() > _MANY * middle)
    return bool(values.min() > 0 and middle > _MANY * values.min())


def _is_near(limit: float, low: float, high: float, wide: bool) -> bool:
    if wide:
        return limit > 0 and bool(abs(np.log(limit / np.clip(limit, low, high))) <= 2.0 * np.log(high / low))
    return bool(abs(limit - np.clip(limit, low, high)) <= 2.0 * (high - low))


def models_chart(comparison: Comparison, solution: Solution | None) -> Markup:
    """Pressure drop by every model from the three solidities, and the solver's where there is one."""
    rows = [(row.title or name, row) for name, row in comparison.models.items()][::-1]
    marks = (("nominal", "o", ORANGE), ("surface", "s", BLUE), ("mesh", "D", GREEN))

    def draw(axes: "Axes") -> None:
        for place, (_, row) in enumerate(rows):
            drops = [getattr(row, which) for which, _, _ in marks]
            finite = [value for value in drops if np.isfinite(value)]
            if finite:
                axes.plot([min(finite), max(finite)], [place, place], color="#808080", alpha=0.6, linewidth=1)
        for (which, marker, color), size in zip(marks, (6, 6, 4), strict=True):
            drop = np.array([getattr(row, which) for _, row in rows])
            label = f"{which} solidity {comparison.solidity[which]:.2%}"
            axes.plot(
                np.where(np.isfinite(drop), drop, np.nan),
                range(len(rows)),
                marker,
                color=color,
                markersize=size,
                label=label,
            )
        if solution is not None:
            axes.axvline(solution.pressure_drop, color=INK, linewidth=1.5, label=f"CFD {solution.pressure_drop:.4g} Pa")
        axes.set(xlabel="pressure drop [Pa]", yticks=range(len(rows)), yticklabels=[title for title, _ in rows])
        axes.set_xlim(left=0)
        axes.grid(axis="x")
        axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.4, -0.14), ncols=2)

    return chart("models", draw, (7.6, 1.4 + 0.3 * len(rows)))


def drag_chart(solution: Solution) -> Markup:
    """Drag of each fiber along the flow, in the order of ``mat/fibers.csv``."""
    drags = 1e9 * np.array(solution.drag_per_fiber)

    def draw(axes: "Axes") -> None:
        axes.bar(np.arange(len(drags)), drags, color=BLUE, width=1.0 if len(drags) > _MANY_BARS else 0.8)
        axes.set(xlabel="fiber", ylabel="drag along the flow [nN]", title="Drag per fiber")
        axes.set_xlim(-0.6, len(drags) - 0.4)

    return chart("drag-per-fiber", draw)


def settling_chart(settling: Settling) -> Markup:
    """How far the pressure drop was from its last value, against iterations."""
    names = {"slip": ("slip", BLUE), "no_slip": ("no slip", ORANGE)}

    def draw(axes: "Axes") -> None:
        for curve in settling.curves:
            at, drops = np.array(curve.iterations), np.array(curve.pressure_drop)
            off = 100.0 * np.abs(drops / drops[-1] - 1.0)
            # the last one is where it settled: nothing that a logarithmic scale could show
            shown = off > 0.0
            name, color = names[curve.fiber_wall]
            axes.semilogy(at[shown], off[shown], "o-", color=color, markersize=3, linewidth=1.2, label=name)
        axes.set(xlabel="iterations", ylabel="off its last value [%]", title="Settling of the pressure drop")
        axes.grid(axis="y")
        axes.legend(frameon=False)

    return chart("settling", draw)


def prediction_charts(medium: FilterSettings, flow: FlowSettings) -> list[Markup]:
    """Efficiency, figure of merit and pressure drop, as ``fibertwin predict --plot`` draws them."""
    panels = (("efficiency", draw_efficiency), ("merit", draw_figure_of_merit), ("drop", draw_pressure_drop))

    return [
        chart(f"prediction-{name}", lambda axes, draw=draw: draw(axes, medium, flow), (5.0, 4.5))  # type: ignore[misc]
        for name, draw in panels
    ]
