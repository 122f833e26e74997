"""The flow through a mat, read from a solved OpenFOAM case: pressure on a slice, and streamlines between the fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats
from pipeline.nouns.patches import FIBERS
from pipeline.pictures.render import _MICRO, Image, _plotter, _shot

if TYPE_CHECKING:
    import pyvista as pv
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DPI = 100
_FIBER_COLOR = "#d8d3c8"
_PRESSURE_COLORS, _SPEED_COLORS = "viridis", "plasma"
_SLICE_POINTS = 500  # across the wider side of a slice's picture


@dataclass(frozen=True, eq=False, slots=True)
class FlowField:
    """A solved flow in micrometers and pascals.

    Parameters
    ----------
    air : pyvista UnstructuredGrid
        With ``p`` [Pa], ``U`` [m/s] and ``speed`` [m/s] on its points.
    fibers : pyvista PolyData
    """

    air: "pv.UnstructuredGrid"
    fibers: "pv.PolyData"


def read_flow(case: Path, density: float) -> FlowField:
    """Read the last state of a solved case.

    Parameters
    ----------
    case : Path
        OpenFOAM case, as the stage ``solve`` leaves it.
    density : float [kg/m3]
        Of the air: OpenFOAM's pressure is over it.

    Raises
    ------
    StageError
        If the case holds no solution.
    """
    import pyvista as pv

    pv.vtk_verbosity("error")
    reader = pv.OpenFOAMReader(str(case / "case.foam"))
    if max(reader.time_values, default=0.0) == 0.0:
        raise StageError(f"{case} holds no solution; run the case with --until solve")
    reader.set_active_time_value(max(reader.time_values))
    reader.cell_to_point_creation = True
    content = reader.read()
    air, fibers = content["internalMesh"], content["boundary"][FIBERS]
    for part in (air, fibers):
        part.points = _MICRO * np.asarray(part.points, np.float64)
    air.point_data["p"] = density * air.point_data["p"]
    air.point_data["speed"] = np.linalg.norm(air.point_data["U"], axis=1)
    return FlowField(air, fibers)


def slice_figure(flow: FlowField, title: str = "", share: float = 0.5) -> "Figure":
    """Draw pressure and speed on the plane y = constant, air flowing upward, fibers left white.

    Parameters
    ----------
    flow : FlowField
    title : str
    share : float [-]
        Where the plane lies, 0 to 1 across the duct.
    """
    import pyvista as pv
    from matplotlib.figure import Figure

    x0, x1, y0, y1, z0, z1 = flow.air.bounds
    scale = _SLICE_POINTS / max(x1 - x0, z1 - z0)
    columns, rows = round((x1 - x0) * scale), round((z1 - z0) * scale)
    # half a pixel inside, where every point of the grid lies in the air or in a fiber
    spacing = ((x1 - x0) / columns, 1.0, (z1 - z0) / rows)
    origin = (x0 + 0.5 * spacing[0], y0 + share * (y1 - y0), z0 + 0.5 * spacing[2])
    grid = pv.ImageData(dimensions=(columns, 1, rows), spacing=spacing, origin=origin).sample(flow.air)
    solid = grid.point_data["vtkValidPointMask"] == 0
    # as wide as two slices and their color bars at the same scale
    width = 3.4 if z1 - z0 > 1.5 * (x1 - x0) else 4.2
    figure = Figure(figsize=(2 * width + 2.2, width * (z1 - z0) / (x1 - x0) + 0.9), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for axes, name, label, colors in (
        (panels[0], "p", "pressure [Pa]", _PRESSURE_COLORS),
        (panels[1], "speed", "speed [cm/s]", _SPEED_COLORS),
    ):
        values = (100.0 if name == "speed" else 1.0) * np.asarray(grid.point_data[name], np.float64)
        image = np.where(solid, np.nan, values).reshape(rows, columns)
        _show(axes, image, (x0, x1, z0, z1), label, colors)
    panels[0].set_ylabel("z, along the flow [um]")
    figure.suptitle(title, fontsize="medium")
    return figure


def _show(axes: "Axes", image: Floats, extent: tuple[float, float, float, float], label: str, colors: str) -> None:
    shown = axes.imshow(image, extent=extent, origin="lower", cmap=colors, interpolation="nearest")
    axes.figure.colorbar(shown, ax=axes, label=label, shrink=0.8)
    axes.set_xlabel("x [um]")


def streamline_figure(
    flow: FlowField, title: str = "", lines: int = 14, size: tuple[int, int] = (900, 1000)
) -> "Figure":
    """Draw streamlines from a grid of points on the inlet, colored by speed, between the fibers.

    Parameters
    ----------
    flow : FlowField
    title : str
    lines : int
        Along each side of the grid.
    size : tuple of int
        Pixels.
    """
    import pyvista as pv
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    fastest = float(np.percentile(flow.air.point_data["speed"], 99.5))
    plotter = _plotter(size)
    plotter.add_mesh(flow.fibers, color=_FIBER_COLOR, smooth_shading=True, split_sharp_edges=True, ambient=0.25)
    tubes = _streamlines(flow, lines)
    plotter.add_mesh(tubes, scalars="speed", cmap=_SPEED_COLORS, clim=[0.0, fastest], show_scalar_bar=False)
    plotter.add_mesh(pv.Box(flow.air.bounds).extract_all_edges(), color="#404040", line_width=2)
    low, high = np.array(flow.air.bounds[::2]), np.array(flow.air.bounds[1::2])
    middle, reach = 0.5 * (low + high), float(np.linalg.norm(high - low))
    plotter.camera_position = [tuple(middle + reach * np.array([0.9, -1.75, 0.55])), tuple(middle), (0.0, 0.0, 1.0)]
    plotter.camera.zoom(1.02)
    image = Image(_shot(plotter), (0.0, float(size[0]), 0.0, float(size[1])))
    figure = Figure(figsize=(size[0] / _DPI + 1.0, size[1] / _DPI + 0.4), layout="constrained")
    axes = figure.subplots()
    axes.imshow(image.pixels, interpolation="antialiased")
    axes.set_axis_off()
    axes.set_title(title, loc="left", fontsize="medium")
    colors = ScalarMappable(Normalize(0.0, 100.0 * fastest), _SPEED_COLORS)
    figure.colorbar(colors, ax=axes, label="speed [cm/s]", shrink=0.5, pad=0.0)
    return figure


def _streamlines(flow: FlowField, lines: int) -> "pv.PolyData":
    import pyvista as pv

    x0, x1, y0, y1, z0, z1 = flow.air.bounds
    shares = (np.arange(lines) + 0.5) / lines
    x, y = np.meshgrid(x0 + shares * (x1 - x0), y0 + shares * (y1 - y0))
    seeds = pv.PolyData(np.column_stack([x.ravel(), y.ravel(), np.full(x.size, z0 + 1e-3 * (z1 - z0))]))
    found = flow.air.streamlines_from_source(
        seeds,
        vectors="U",
        integration_direction="forward",
        max_length=4.0 * (z1 - z0),
        initial_step_length=0.5,
        max_step_length=0.5,
        # against a face velocity of centimeters a second; the lines end where they run into a fiber
        terminal_speed=1e-7,
    )
    return found.tube(radius=0.0028 * float(np.linalg.norm([x1 - x0, y1 - y0, z1 - z0])), n_sides=8)
