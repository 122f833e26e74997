"""Figures of the analytical models: the paper's Figs. 1, 10d, 10e and A8, for any filter.

matplotlib is imported where a figure is made, and without pyplot: nothing here opens a window or keeps state.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pipeline.analytics.formulas import merit, slip
from pipeline.analytics.formulas.pressure_drop import pressure_drop
from pipeline.analytics.models import single_fiber
from pipeline.analytics.models.prediction import depth_of, efficiency_over, predict, single_fiber_at
from pipeline.analytics.models.pressure_models import MODELS, pressure_model
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.errors import CaseError
from pipeline.writing import whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = (".svg", ".png", ".pdf")

_SIZES = np.geomspace(1e-9, 1e-5, 601)
_SHOWN = np.geomspace(1e-8, 1e-6, 601)  # the range of Figs. 10d and 10e

_MECHANISM_COLOR = {
    "total": "#1a1a1a",
    "interception": "#0072b2",
    "diffusion": "#d55e00",
    "diffusion_interception": "#cc79a7",
    "impaction": "#009e73",
    "gravity": "#999999",
}
_STRUCTURE_COLOR = {
    "measured pads": "#1a1a1a",
    "layers across the flow": "#009e73",
    "all directions": "#d55e00",
    "parallel cylinders across the flow": "#0072b2",
}
_DASHES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1, 1, 1)), (0, (1, 1)))


def draw_efficiency(axes: "Axes", medium: FilterSettings, settings: FlowSettings) -> None:
    """Draw filter efficiency over particle size, in total and by each mechanism alone (Figs. 10d and A8).

    Parameters
    ----------
    axes : matplotlib Axes
    medium : FilterSettings
    settings : FlowSettings
    """
    lowest = predict(medium, settings).mpps
    for name, value in efficiency_over(medium, settings, _SIZES).items():
        axes.semilogx(
            _SIZES * 1e9,
            100.0 * value,
            color=_MECHANISM_COLOR[name],
            linewidth=2.2 if name == "total" else 1.3,
            label=name.replace("_", " "),
        )
    axes.plot(lowest["diameter"] * 1e9, 100.0 * lowest["efficiency"], "o", color=_MECHANISM_COLOR["total"])
    axes.annotate(
        f"{lowest['diameter'] * 1e9:.1f} nm, {lowest['efficiency']:.2%}",
        (lowest["diameter"] * 1e9, 100.0 * lowest["efficiency"]),
        xytext=(0, -14),
        textcoords="offset points",
        ha="center",
        fontsize="small",
    )
    axes.set(xlabel="particle diameter [nm]", ylabel="filter efficiency [%]", ylim=(0, 101))
    axes.set_title(f"Efficiency by mechanism ({settings.preset})")
    _legend_below(axes, 3)
    axes.grid(alpha=0.25)


def draw_figure_of_merit(axes: "Axes", medium: FilterSettings, settings: FlowSettings) -> None:
    """Draw the figure of merit over particle size, in both senses (Fig. 10e).

    Parameters
    ----------
    axes : matplotlib Axes
    medium : FilterSettings
    settings : FlowSettings
    """
    flow = settings.flow()
    slip_length = slip.slip_length(slip.knudsen(flow.mean_free_path, medium.fiber_diameter))
    f = pressure_model(settings.pressure_model).coefficient(medium.solidity, slip_length)
    drop = float(pressure_drop(f, flow.viscosity, flow.face_velocity, medium.thickness, medium.fiber_diameter))
    depth = depth_of(medium, single_fiber_at(medium, settings, _SHOWN)["total"])
    efficiency = single_fiber.filter_efficiency(depth)
    axes.semilogx(
        _SHOWN * 1e9, merit.figure_of_merit(depth, drop), color="#0072b2", label=r"$-\ln(P)/\Delta p$ (Eq. A34)"
    )
    axes.semilogx(
        _SHOWN * 1e9,
        merit.efficiency_per_pascal(efficiency, drop),
        color="#d55e00",
        label=r"$E/\Delta p$ (as the paper prints)",
    )
    axes.set(xlabel="particle diameter [nm]", ylabel="figure of merit [1/Pa]")
    axes.set_ylim(bottom=0)
    axes.set_title(f"Figure of merit, {drop:.4g} Pa by {MODELS[settings.pressure_model].title}")
    axes.legend(fontsize="small", frameon=False)
    axes.grid(alpha=0.25)


def draw_pressure_drop(axes: "Axes", medium: FilterSettings, settings: FlowSettings) -> None:
    """Draw pressure drop over solidity by every model, dimmed outside the model's range (Fig. 1).

    Parameters
    ----------
    axes : matplotlib Axes
    medium : FilterSettings
        Its solidity is marked.
    settings : FlowSettings
    """
    flow = settings.flow()
    share = np.linspace(0.005, 0.3, 200)
    slip_length = slip.slip_length(slip.knudsen(flow.mean_free_path, medium.fiber_diameter))
    used = dict.fromkeys(_STRUCTURE_COLOR, 0)
    for model in MODELS.values():
        f = np.asarray(model.coefficient(share, slip_length))
        drop = pressure_drop(f, flow.viscosity, flow.face_velocity, medium.thickness, medium.fiber_diameter)
        value = np.where(np.isfinite(f), drop, np.nan)
        inside = (share >= model.low) & (share <= model.high)
        color, dashes = _STRUCTURE_COLOR[model.structure], _DASHES[used[model.structure]]
        used[model.structure] += 1
        axes.semilogy(share, value, color=color, linestyle=dashes, linewidth=0.8, alpha=0.3)
        axes.semilogy(
            share, np.where(inside, value, np.nan), color=color, linestyle=dashes, linewidth=1.6, label=model.title
        )
    axes.axvline(medium.solidity, color="#999999", linewidth=1)
    axes.set(xlabel="solidity [-]", ylabel="pressure drop [Pa]", xlim=(0, 0.3))
    axes.set_title("Pressure drop by model (faint: outside its range)")
    _legend_below(axes, 2)
    axes.grid(alpha=0.25)


def _legend_below(axes: "Axes", columns: int) -> None:
    axes.legend(fontsize="x-small", frameon=False, ncols=columns, loc="upper center", bbox_to_anchor=(0.5, -0.13))


def plot_prediction(medium: FilterSettings, settings: FlowSettings) -> "Figure":
    """Plot what ``fibertwin predict --plot`` shows: efficiency, figure of merit, pressure drop.

    Parameters
    ----------
    medium : FilterSettings
    settings : FlowSettings

    Returns
    -------
    matplotlib Figure
        Three panels.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 5.6), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    draw_efficiency(left, medium, settings)
    draw_figure_of_merit(middle, medium, settings)
    draw_pressure_drop(right, medium, settings)
    return figure


def save_figure(figure: "Figure", path: Path) -> None:
    """Write a figure; equal figures give equal files.

    Parameters
    ----------
    figure : matplotlib Figure
    path : Path
        Ends with one of `FORMATS`; its folder must exist.

    Raises
    ------
    CaseError
        If the ending names no format that is offered, or the file cannot be written.
    """
    import matplotlib as mpl

    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise CaseError(f"cannot plot to {path}: the name must end with one of {', '.join(FORMATS)}")
    # dates and random ids would make every file differ from the last
    metadata = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(kind)
    try:
        with mpl.rc_context({"svg.hashsalt": "fibertwin"}), whole_file(path) as side:
            figure.savefig(side, dpi=110, metadata=metadata)
    except OSError as problem:
        raise CaseError(f"cannot write {path}: {problem.strerror}") from problem
