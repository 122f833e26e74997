"""A study's means over its first swept key, with their confidence intervals."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.study.quantity import read_quantity
from pipeline.study.study import PointRow, StudyResult
from pipeline.study.tables import shown
from pipeline.units import parse

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WITH_UNIT = re.compile(r"\s*[-+]?[\d.]+(?:[eE][-+]?\d+)?\s*([A-Za-zµ°%].*?)\s*")

_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#1a1a1a")


def axis_of(values: list[Any]) -> tuple[list[float], str] | None:
    """Give swept values as numbers in the unit of the first; None where they are no numbers.

    Examples
    --------
    >>> axis_of(["200 nm", "1.6 um"])
    ([200.0, 1600.0], 'nm')
    >>> axis_of([0.05, 0.1])
    ([0.05, 0.1], '')
    >>> axis_of(["paper", "clear"]) is None
    True
    """
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return [float(value) for value in values], ""
    first = _WITH_UNIT.fullmatch(values[0]) if isinstance(values[0], str) else None
    if first is None or not all(isinstance(value, str) for value in values):
        return None
    try:
        return [parse(value, first[1]) for value in values], first[1]
    except ValueError:
        return None


def plot_study(result: StudyResult) -> "Figure":
    """Plot each quantity over the first swept key, a line per combination of the other keys.

    Error bars are 95 % confidence intervals of the mean.
    """
    from matplotlib.figure import Figure

    count = len(result.quantities)
    columns = min(count, 3)
    rows = -(-count // columns)
    figure = Figure(figsize=(4.6 * columns, 3.7 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for number, axes in enumerate(panels):
        if number < count:
            _draw(axes, result, number)
        else:
            axes.set_axis_off()
    return figure


def _draw(axes: "Axes", result: StudyResult, number: int) -> None:
    first, *others = result.keys
    quantity = result.quantities[number]
    found = [
        (one.label, one.at, value)
        for one in result.references
        for text, value in one.values.items()
        if read_quantity(text) == quantity
    ]
    values = [*(point.settings[first] for point in result.points), *(at for _, at, _ in found)]
    swept = list({shown(value): value for value in values}.values())
    numbers = axis_of(swept)
    place = dict(zip(map(shown, swept), numbers[0] if numbers else range(len(swept)), strict=True))
    lines: dict[str, list[PointRow]] = {}
    for point in result.points:
        lines.setdefault(", ".join(f"{key} {shown(point.settings[key])}" for key in others), []).append(point)
    for index, (label, points) in enumerate(lines.items()):
        estimates = [point.estimates[number] for point in points]
        axes.errorbar(
            [place[shown(point.settings[first])] for point in points],
            [each.mean for each in estimates],
            yerr=np.nan_to_num([each.half_width for each in estimates]),
            color=_COLORS[index % len(_COLORS)],
            marker="o",
            markersize=3.5,
            linewidth=1.2,
            capsize=2.5,
            label=label,
        )
    crosses: dict[str, list[tuple[float, float]]] = {}
    for label, at, value in found:
        crosses.setdefault(label, []).append((place[shown(at)], value))
    for index, (label, pairs) in enumerate(crosses.items()):
        axes.plot(*zip(*pairs, strict=True), "x+*"[index % 3], color="#1a1a1a", markersize=8, label=label)
    if numbers is None:
        axes.set_xticks(range(len(swept)), list(map(shown, swept)))
    axes.set_xlabel(f"{first} [{numbers[1]}]" if numbers and numbers[1] else first)
    axes.set_ylabel(quantity.label)
    axes.grid(alpha=0.3)
    if others or crosses:
        axes.legend(fontsize="small")
    most = max(len(point.runs) for point in result.points)
    axes.set_title(f"mean of {most} mats, 95 % confidence" if most > 1 else "one mat", fontsize="small", loc="left")
