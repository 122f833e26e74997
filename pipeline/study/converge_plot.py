"""The pressure drop over the mesh's spacing, with its limit and its band."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

from pipeline.nouns.convergence import ConvergedDrop

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot_convergence(found: ConvergedDrop) -> "Figure":
    """Draw the drop on each mesh with either wall, and the value with its interval at a spacing of zero."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    axes = figure.subplots()
    spacing = [rung.spacing for rung in found.rungs]
    for label, color, drops in (
        ("no slip", "#d55e00", [rung.pressure_drop_no_slip for rung in found.rungs]),
        ("slip", "#0072b2", [rung.pressure_drop_slip for rung in found.rungs]),
    ):
        known = [(x, drop) for x, drop in zip(spacing, drops, strict=True) if drop is not None]
        if known:
            axes.plot(*zip(*known, strict=True), "o-", color=color, label=label)
    drop = found.pressure_drop
    axes.errorbar(
        [0.0],
        [drop.value],
        [[drop.value - drop.low], [drop.high - drop.value]],
        fmt="s",
        color="#1a1a1a",
        capsize=4,
        label="limit and interval",
    )
    axes.set_xlim(left=-0.02 * max(spacing))
    axes.set_xlabel("(air volume / cells)$^{1/3}$ over fiber diameter")
    axes.set_ylabel("pressure drop [Pa]")
    axes.legend(frameon=False)
    return figure
