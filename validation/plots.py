"""The measured figures as plots; matplotlib is imported where a figure is made, and without pyplot."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np

from validation.exact import hexagonal_drag, square_drag
from validation.ladder import FACTORS, Rung
from validation.mats import MatRun, mean_and_half_width, over_finest, spread

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#1a1a1a")
_MARKERS = {"square": "s", "hexagonal": "h"}
_LINES = {"square": "-", "hexagonal": "--"}


def ladder_figure(rungs: list[Rung]) -> "Figure":
    """Plot F* over solidity against the exact curves, and the errors over the mesh spacing."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    _draw_drag(left, rungs)
    _draw_errors(right, rungs)
    return figure


def _draw_drag(axes: "Axes", rungs: list[Rung]) -> None:
    solidities = np.geomspace(0.008, 0.33, 40)
    for name, exact in (("square", square_drag), ("hexagonal", hexagonal_drag)):
        axes.loglog(solidities, [exact(a) for a in solidities], _LINES[name], color="#777777", label=f"exact, {name}")
    for name, slips, color in (
        ("square", False, _COLORS[0]),
        ("hexagonal", False, _COLORS[1]),
        ("square", True, _COLORS[2]),
    ):
        finest = [rung for rung in rungs[len(FACTORS) - 1 :: len(FACTORS)] if rung.arrangement == name]
        finest = [rung for rung in finest if (rung.slip > 0) == slips]
        if finest:
            label = f"finest mesh, {name}" + (f", slip {finest[0].slip:g} r" if slips else "")
            places, drags = [rung.solidity for rung in finest], [rung.f_star for rung in finest]
            axes.plot(places, drags, _MARKERS[name], color=color, fillstyle="none", markersize=7, label=label)
    axes.set_xlabel("solidity")
    axes.set_ylabel("F*, drag per length / (viscosity x velocity)")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")


def _draw_errors(axes: "Axes", rungs: list[Rung]) -> None:
    solidities = sorted({rung.solidity for rung in rungs})
    for start in range(0, len(rungs), len(FACTORS)):
        three = rungs[start : start + len(FACTORS)]
        first = three[0]
        axes.plot(
            [rung.spacing for rung in three],
            [100.0 * rung.error for rung in three],
            ":" if first.slip else _LINES[first.arrangement],
            marker=_MARKERS[first.arrangement],
            markersize=4,
            linewidth=1.2,
            color=_COLORS[solidities.index(first.solidity) % len(_COLORS)],
            label=f"{first.arrangement}, {first.solidity:g}" + (", slip" if first.slip else ""),
        )
    axes.axhspan(-1.0, 1.0, color="#000000", alpha=0.06, linewidth=0)
    axes.axhline(0.0, color="#000000", linewidth=0.8)
    axes.set_xlabel("(air volume / cells)^(1/3) [fiber diameters]")
    axes.set_ylabel("error of F* [%]")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.set_title("gray: within 1 %", fontsize="small", loc="left")


def mats_figure(resolution: list[MatRun], sizes: list[MatRun]) -> "Figure":
    """Plot what the mesh's spacing and the box's side do to the pressure drop, with 95 % confidence of the means."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    for seed in sorted({each.seed for each in resolution}):
        own = [each for _, group in spread(resolution, "edge") for each in group if each.seed == seed]
        change = [100.0 * (each.cfd / own[0].cfd - 1.0) for each in own]
        left.plot([each.edge for each in own], change, ".", color="#999999", markersize=5)
    means = [
        (edge, *mean_and_half_width([100.0 * (v - 1.0) for v in values])) for edge, values in over_finest(resolution)
    ]
    _bars(left, means)
    left.set_xlabel("edge at the fibers [diameters]")
    left.set_ylabel("pressure drop against the finest mesh [%]")
    for each in sizes:
        right.plot(1e6 * each.side, each.cfd / each.davies, ".", color="#999999", markersize=5)
    _bars(
        right,
        [
            (1e6 * side, *mean_and_half_width([e.cfd / e.davies for e in group]))
            for side, group in spread(sizes, "side")
        ],
    )
    right.set_xlabel("side of the box [um]")
    right.set_ylabel("CFD over Davies at the mesh's solidity")
    return figure


def _bars(axes: "Axes", means: list[tuple[float, float, float]]) -> None:
    places, values, widths = zip(*means, strict=True)
    axes.errorbar(places, values, yerr=widths, color=_COLORS[0], marker="o", markersize=4, linewidth=1.2, capsize=3)
    axes.grid(alpha=0.3)
    axes.set_title("mean of three mats, 95 % confidence", fontsize="small", loc="left")
