"""Fibers as tubes, rendered by pyvista into an array of pixels."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from pipeline.geometry.box import Box
from pipeline.nouns.fibers import Mat

if TYPE_CHECKING:
    import pyvista as pv

View = Literal["top", "side"]

COLORS = "viridis"
"""Of the height in the mat; equally readable in gray and for the color-blind."""

INLET_COLOR, OUTLET_COLOR = "#0072b2", "#d55e00"

_MICRO = 1e6
_SIDES_OF_A_TUBE = 14


@dataclass(frozen=True, eq=False, slots=True)
class Image:
    """Pixels, (rows, columns, 3) bytes, and what they cover [um]: (left, right, bottom, top)."""

    pixels: npt.NDArray[np.uint8]
    extent: tuple[float, float, float, float]


def tubes(mat: Mat) -> "pv.PolyData":
    """Give the fibers as tubes in micrometers, with the height of their axes as ``height`` [um]."""
    import pyvista as pv

    counts = np.diff(mat.first)
    cells = np.insert(np.arange(len(mat.nodes)), mat.first[:-1], counts)
    lines = pv.PolyData(_MICRO * mat.nodes, lines=cells)
    lines["radius"] = _MICRO * np.repeat(mat.radius, counts)
    lines["height"] = _MICRO * mat.nodes[:, 2]
    # VTK's filter takes the radius of each point from its scalars, and scales none of them
    return lines.tube(scalars="radius", absolute=True, n_sides=_SIDES_OF_A_TUBE, capping=True)


def plan_view(mat: Mat, view: View, pixels: int, margin: float = 0.0) -> Image:
    """Look at a mat along z from above or along y, without perspective.

    Parameters
    ----------
    mat : Mat
    view : {"top", "side"}
    pixels : int
        Width of the picture.
    margin : float [um]
        Shown around the slab.
    """
    size = _MICRO * np.array(mat.slab.size)
    low = _MICRO * np.array(mat.slab.lower)
    up = 1 if view == "top" else 2
    left, right = low[0] - margin, low[0] + size[0] + margin
    bottom, top = low[up] - margin, low[up] + size[up] + margin
    height = max(round(pixels * (top - bottom) / (right - left)), 8)
    center = low + 0.5 * size
    away = np.array([0.0, 0.0, 1.0]) if view == "top" else np.array([0.0, -1.0, 0.0])
    upward = (0.0, 1.0, 0.0) if view == "top" else (0.0, 0.0, 1.0)
    plotter = _plotter((pixels, height))
    _add_fibers(plotter, mat)
    plotter.enable_parallel_projection()
    plotter.camera_position = [tuple(center + 4.0 * size.max() * away), tuple(center), upward]
    # half of the height that is seen
    plotter.camera.parallel_scale = 0.5 * (top - bottom)
    plotter.reset_camera_clipping_range()
    return Image(_shot(plotter), (left, right, bottom, top))


def duct_view(mat: Mat, duct: Box, size: tuple[int, int]) -> Image:
    """Look at a mat within its duct: inlet below in blue, outlet above in red, as edges and faint faces."""
    import pyvista as pv

    plotter = _plotter(size)
    _add_fibers(plotter, mat)
    low, high = _MICRO * np.array(duct.lower), _MICRO * np.array(duct.upper)
    bounds = (low[0], high[0], low[1], high[1], low[2], high[2])
    plotter.add_mesh(pv.Box(bounds).extract_all_edges(), color="#404040", line_width=2)
    for z, color in ((low[2], INLET_COLOR), (high[2], OUTLET_COLOR)):
        center = (0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), z)
        plane = pv.Plane(center=center, direction=(0, 0, 1), i_size=high[0] - low[0], j_size=high[1] - low[1])
        plotter.add_mesh(plane, color=color, opacity=0.35)
    middle = 0.5 * (low + high)
    reach = float(np.linalg.norm(high - low))
    plotter.camera_position = [tuple(middle + reach * np.array([1.25, -1.7, 0.75])), tuple(middle), (0.0, 0.0, 1.0)]
    plotter.camera.zoom(1.08)
    return Image(_shot(plotter), (0.0, float(size[0]), 0.0, float(size[1])))


def _plotter(size: tuple[int, int]) -> "pv.Plotter":
    import pyvista as pv

    # without a display VTK warns, and then renders all the same
    pv.vtk_verbosity("error")
    plotter = pv.Plotter(off_screen=True, window_size=list(size), lighting="light kit")
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def _add_fibers(plotter: "pv.Plotter", mat: Mat) -> None:
    bounds = [0.0, _MICRO * mat.thickness]
    plotter.add_mesh(
        tubes(mat),
        scalars="height",
        cmap=COLORS,
        clim=bounds,
        smooth_shading=True,
        specular=0.25,
        ambient=0.2,
        show_scalar_bar=False,
    )


def _shot(plotter: Any) -> npt.NDArray[np.uint8]:
    pixels: npt.NDArray[np.uint8] = plotter.screenshot(None, return_img=True)
    plotter.close()
    return pixels
