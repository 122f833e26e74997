"""The section of what the filter catches: efficiency over particle size beside the model, depth, and words."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from pipeline.analytics.models.prediction import efficiency_over
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.capture.tables import capture_tables, filter_rows, share, size
from pipeline.line.results import Results
from pipeline.nouns.capture import Capture
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.section import Charts, Facts, Part, Section, Text
from pipeline.report.page.svg import BLUE, GREEN, INK, ORANGE, RED, chart

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLORS = (BLUE, ORANGE, GREEN, RED, "#8a6bbe")
_MANY = 0.05  # of the particles given up, from which the page warns; and of the paths that end on a fiber


def capture(content: Results) -> Section | None:
    """Show efficiency and penetration over particle size, where particles stick, and the class of the filter."""
    found, comparison = content.get(Capture), content.get(Comparison)
    if found is None:
        return None
    drawings = [depth_chart(found)]
    if comparison is not None:
        medium = FilterSettings(
            solidity=comparison.solidity["mesh"],
            thickness=comparison.thickness,
            fiber_diameter=comparison.fiber_diameter,
        )
        drawings = [efficiency_chart(found, medium, content.case.flow), penetration_chart(found), *drawings]
    caption = (
        "Points: particles through the solved flow, with 95 % intervals. Lines: the single-fiber model, each mechanism "
        "alone and all together; its impaction changes its formula where a particle is .4 of a fiber's diameter."
    )
    parts: list[Part] = [Charts(tuple(drawings), caption), Facts(tuple(filter_rows(found))), capture_tables(found)[0]]
    lost = sum(found.timed_out) / sum(found.released)
    if lost > _MANY:
        parts.append(Text(f"{share(lost)} of the particles were given up before they had an end.", "note"))
    if found.stray > _MANY:
        words = f"{share(found.stray)} of the air's own paths end on a fiber: lower tetmesh.edge, for particles' sake."
        parts.append(Text(words, "note"))
    parts.append(Text("Charge on fibers or particles is left out.", "soft"))
    return Section("capture", "Capture", "What the filter catches", tuple(parts))


def efficiency_chart(found: Capture, medium: FilterSettings, air: FlowSettings) -> Markup:
    """Draw counted efficiencies with their intervals over the model's curves by mechanism."""
    sizes = np.array(found.particle_diameter)
    fine = np.geomspace(min(sizes[0], 2e-8), max(sizes[-1], 4e-6), 200)
    air = air.model_copy(update={"particle_density": found.density})
    curves = efficiency_over(medium, air, fine)

    def draw(axes: "Axes") -> None:
        for (name, values), color in zip(list(curves.items())[1:], _COLORS, strict=True):
            axes.plot(1e6 * fine, 100 * values, color=color, linewidth=1, label=name.replace("_", " "))
        axes.plot(1e6 * fine, 100 * curves["total"], color=INK, linewidth=1.5, label="model")
        efficiency = 100 * np.array(found.efficiency)
        bars = np.abs(100 * np.array([found.low, found.high]) - efficiency)
        axes.errorbar(
            1e6 * sizes, efficiency, bars, fmt="o", color=INK, markersize=4, capsize=2, linewidth=1, label="CFD"
        )
        _sizes_along(axes)
        axes.set(ylabel="efficiency [%]", ylim=(0, 103), title="Efficiency")
        axes.legend(frameon=False, fontsize=7)

    return chart("capture-efficiency", draw, (5.0, 3.6))


def penetration_chart(found: Capture) -> Markup:
    """Draw what passes, on a logarithmic scale, and the most penetrating size."""
    sizes, passed = 1e6 * np.array(found.particle_diameter), np.array(found.penetration)
    high, low = 1 - np.array(found.low), 1 - np.array(found.high)
    worst = found.most_penetrating["cfd"]

    def draw(axes: "Axes") -> None:
        # a size that nothing passed has an upper end only
        shown = np.where(passed > 0, passed, high)
        least = np.maximum(low, 0.1 * shown)
        bars = [100 * (shown - np.minimum(least, shown)), 100 * (high - shown)]
        axes.errorbar(sizes, 100 * shown, bars, fmt="o", color=BLUE, markersize=4, capsize=2, linewidth=1)
        axes.plot(sizes, 100 * (1 - np.array(found.single_fiber)).clip(1e-7), color=INK, linewidth=1, label="model")
        if worst.inside:
            axes.axvspan(
                1e6 * worst.low, 1e6 * worst.high, color=ORANGE, alpha=0.3, label=f"MPPS {size(worst.diameter)}"
            )
        axes.set_yscale("log")
        _sizes_along(axes)
        axes.set(ylabel="penetration [%]", title="Penetration", ylim=(max(1e-3, 50 * float(high.min())), 150))
        _plain(axes.yaxis)
        axes.legend(frameon=False, fontsize=7)

    return chart("capture-penetration", draw, (5.0, 3.6))


def depth_chart(found: Capture) -> Markup:
    """Share of the caught particles by how deep in the mat they stick."""
    edges = 1e6 * np.array(found.depth.edges)

    def draw(axes: "Axes") -> None:
        for counts, diameter, color in zip(found.depth.captured, found.particle_diameter, _cycle(), strict=False):
            total = sum(counts)
            if total:
                axes.stairs(100 * np.array(counts) / total, edges, color=color, label=size(diameter).replace("u", "µ"))
        axes.set(xlabel="height z, along the flow [µm]", ylabel="share of the caught [%]", title="Where they stick")
        if len(found.particle_diameter):
            axes.legend(frameon=False, fontsize=7)

    return chart("capture-depth", draw, (5.0, 3.6))


def _cycle() -> list[str]:
    return [*_COLORS, INK] * 20


def _sizes_along(axes: "Axes") -> None:
    axes.set_xscale("log")
    axes.set_xlabel("particle diameter [µm]")
    _plain(axes.xaxis)


def _plain(axis: object) -> None:
    from matplotlib.ticker import FuncFormatter, NullFormatter

    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))  # type: ignore[attr-defined]
    axis.set_minor_formatter(NullFormatter())  # type: ignore[attr-defined]
