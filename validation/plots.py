"""The measured figures as plots; matplotlib is imported where a figure is made, and without pyplot."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pipeline.analytics.measured_errors import EdgeError
from validation.judged import judged
from validation.ladder import Rung
from validation.lattices import LatticeRung

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#1a1a1a", "#56b4e9")


def ladder_figure(arrays: Sequence[Rung], lattices: Sequence[LatticeRung]) -> "Figure":
    """Plot the errors of arrays and lattices over the mesh spacing."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    shown: dict[str, list[Rung | LatticeRung]] = {
        "square and hexagonal arrays, elements": [rung for rung in arrays if rung.engine == "stokes"],
        "square array, simpleFoam": [rung for rung in arrays if rung.engine == "openfoam"],
        "crossed layers and cubic lattice, elements": list(lattices),
    }
    for axes, (title, rungs) in zip(figure.subplots(1, 3, sharey=True), shown.items(), strict=True):
        for each in judged(rungs):
            color = _COLORS[0] if each.fine.mesher == "tetwild" else _COLORS[1]
            errors = [100.0 * max(abs(rung.error), 1e-5) for rung in each.rungs]
            axes.loglog([rung.spacing for rung in each.rungs], errors, "o-", color=color, markersize=3, linewidth=0.8)
        spacings = np.array([0.15, 0.4])
        axes.loglog(spacings, 100.0 * spacings**3, "--", color="#777777", label="third order")
        axes.loglog(spacings, 30.0 * spacings**2, ":", color="#777777", label="second order")
        axes.set_xticks([0.05, 0.1, 0.2, 0.4], ["0.05", "0.1", "0.2", "0.4"])
        axes.minorticks_off()
        axes.set_title(title, fontsize="small", loc="left")
        axes.set_xlabel("(air volume / cells)^(1/3) [fiber diameters]")
        axes.grid(alpha=0.3, which="both")
        axes.legend(fontsize="small")
    figure.axes[0].set_ylabel("error of the resistance, absolute [%]")
    figure.suptitle("blue: fTetWild, orange: lattice; each line one array, solidity and slip", fontsize="small")
    return figure


def cost_figure(found: Sequence[EdgeError]) -> "Figure":
    """Plot error against processor time of random mats, a line per mesher and solver."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    axes = figure.subplots()
    lines = dict.fromkeys((each.mesher, each.solver, each.growth < 1.0) for each in found)
    for (mesher, solver, graded), color in zip(lines, _COLORS, strict=False):
        rows = [e for e in found if (e.mesher, e.solver, e.growth < 1.0) == (mesher, solver, graded)]
        rows.sort(key=lambda each: each.edge)
        axes.loglog(
            [each.seconds for each in rows],
            [100.0 * abs(each.mean) for each in rows],
            "o-" if solver == "stokes" else "s--",
            color=color,
            label=f"{mesher}{', graded' if graded else ''}, {'elements' if solver == 'stokes' else 'simpleFoam'}",
        )
        for each in rows:
            axes.annotate(f"{each.edge:g}", (each.seconds, 100.0 * abs(each.mean)), fontsize=7)
    axes.axhline(1.0, color="#000000", linewidth=0.8)
    axes.set_xticks([0.1, 0.2, 0.3, 0.5, 1.0], ["0.1", "0.2", "0.3", "0.5", "1"])
    axes.minorticks_off()
    axes.set_xlabel("processor time for mesh and flow [s per diameter of fiber length]")
    axes.set_ylabel("mean error of the pressure drop, absolute [%]")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize="small")
    return figure
