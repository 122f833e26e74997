"""Views of a solved flow: streamlines between the fibers, and a slice of speed and pressure.

Lengths are in micrometers here, as in the other scenes.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np

from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.flow_field import EDGES, FlowField
from pipeline.report.views.drawing import INK, MICRO

if TYPE_CHECKING:
    import pyvista as pv

# eight straight tetrahedra in a quadratic one: its corners, and four about a diagonal of the middle
_EIGHT = np.array(
    [[0, 4, 6, 7], [4, 1, 5, 8], [6, 5, 2, 9], [7, 8, 9, 3], [4, 9, 6, 7], [4, 9, 7, 8], [4, 9, 8, 5], [4, 9, 5, 6]]
)
_TETRAHEDRON = 10  # VTK's number of the cell
_SPEED_COLORS, _PRESSURE_COLORS = "plasma", "viridis"
_LINES = 12  # streamlines along each side of the inlet
_LOUD = 99.5  # percentile of the speed at which colors end
_SLOWEST = 1e-5  # of the face velocity at which a streamline ends


def linear_grid(field: FlowField) -> "pv.UnstructuredGrid":
    """Give the flow on straight tetrahedra between all of its nodes: speed [cm/s], pressure [Pa], velocity [m/s]."""
    import pyvista as pv

    tets: Ints = field.cells[:, _EIGHT].reshape(-1, 4)
    cells = np.column_stack([np.full(len(tets), 4), tets]).ravel()
    grid = pv.UnstructuredGrid(cells, np.full(len(tets), _TETRAHEDRON), field.positions * MICRO)
    grid.point_data["velocity"] = field.velocity
    grid.point_data["speed"] = 100.0 * np.linalg.norm(field.velocity, axis=1)
    grid.point_data["pressure"] = _at_nodes(field)
    return grid


def _at_nodes(field: FlowField) -> Floats:
    pressure = np.zeros(len(field.positions))
    vertices = len(field.pressure)
    pressure[:vertices] = field.pressure
    pressure[field.cells[:, 4:]] = field.pressure[field.cells[:, EDGES]].mean(axis=2)
    return pressure


def streamlines_between(field: FlowField) -> "pv.PolyData":
    """Give streamlines from a grid of points on the inlet, in micrometers, with their speed [cm/s]."""
    import pyvista as pv

    grid = linear_grid(field)
    x0, x1, y0, y1, z0, z1 = grid.bounds
    share = (np.arange(_LINES) + 0.5) / _LINES
    x, y = np.meshgrid(x0 + share * (x1 - x0), y0 + share * (y1 - y0))
    seeds = pv.PolyData(np.column_stack([x.ravel(), y.ravel(), np.full(x.size, z0 + 1e-3 * (z1 - z0))]))
    return grid.streamlines_from_source(
        seeds,
        vectors="velocity",
        integration_direction="forward",
        max_length=4.0 * (z1 - z0),
        initial_step_length=0.5,
        max_step_length=0.5,
        terminal_speed=_SLOWEST * float(np.abs(field.velocity).max()),
    )


def draw_streamlines(plotter: "pv.Plotter", field: FlowField, fibers: "pv.PolyData") -> None:
    """Draw streamlines, colored by speed, between the fibers."""
    lines = streamlines_between(field)
    fastest = float(np.percentile(lines.point_data["speed"], _LOUD))
    low, high = field.positions.min(axis=0) * MICRO, field.positions.max(axis=0) * MICRO
    tubes = lines.tube(radius=0.0028 * float(np.linalg.norm(high - low)), n_sides=8)
    plotter.add_mesh(fibers, color="#d8d3c8", smooth_shading=True, split_sharp_edges=True, ambient=0.25)
    plotter.add_mesh(
        tubes, scalars="speed", cmap=_SPEED_COLORS, clim=[0.0, fastest], scalar_bar_args=_bar("speed [cm/s]")
    )


def draw_slice(plotter: "pv.Plotter", field: FlowField, middle: float) -> None:
    """Draw speed and, beside it, pressure on the plane x = `middle` [um]."""
    grid = linear_grid(field)
    width = grid.bounds[3] - grid.bounds[2]
    cut = grid.slice("x", origin=(middle, 0.0, 0.0))
    plotter.add_mesh(
        cut, scalars="speed", cmap=_SPEED_COLORS, lighting=False, scalar_bar_args=_bar("speed [cm/s]", 0.05)
    )
    beside = cut.translate((0.0, 1.08 * width, 0.0), inplace=False)
    plotter.add_mesh(
        beside, scalars="pressure", cmap=_PRESSURE_COLORS, lighting=False, scalar_bar_args=_bar("pressure [Pa]", 0.55)
    )


def _bar(title: str, place: float = 0.3) -> dict[str, object]:
    return {
        "title": title, "color": INK, "width": 0.4, "height": 0.08, "position_x": place, "position_y": 0.02,
        "n_labels": 4, "fmt": "%.3g", "label_font_size": 20, "title_font_size": 22, "vertical": False,
    }  # fmt: skip
