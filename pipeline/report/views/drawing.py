"""What the scenes share: colors, where the eye stands, outlines, and the cells that a plane meets.

VTK takes coordinates of 1e-6 for one point, so that lengths are scaled to order one before it sees them.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pipeline.geometry.box import Box
from pipeline.geometry.faces import compacted
from pipeline.geometry.sections import section
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh

if TYPE_CHECKING:
    import pyvista as pv

MICRO = 1e6
"""Micrometers in a meter: the scale of a run's pictures."""
BACKGROUND = "#f5f7fa"
INK = "#26303b"
AIR, INLET, OUTLET, CELLS, EDGES, TROUBLE = (
    "#b9d3ea", "#3b82c4", "#d97b35", "#e3eaf0", "#6b7b8b", "#d3222a",
)  # fmt: skip
# neighbors in this list differ in lightness as well as in hue: fibers with close numbers lie close in a layered mat
PALETTE = np.array(
    [
        (78, 121, 167), (242, 176, 92), (89, 161, 140), (225, 120, 110), (146, 199, 226), (120, 95, 150),
        (160, 190, 105), (184, 115, 70), (240, 205, 110), (95, 110, 130), (210, 150, 185), (60, 135, 120),
    ],
    dtype=np.uint8,
)  # fmt: skip
_OFF_CENTER = 0.5003
"""A plane in the very middle would meet grid points, and show cells' faces in place of their sections."""


@dataclass(frozen=True, slots=True)
class Scene:
    """A view: what it needs of its subject, its size in pixels, and how it is drawn."""

    needs: tuple[str, ...]
    size: tuple[int, int]
    draw: Callable[["pv.Plotter", Any], None]


def colors_by_number(number: Ints) -> npt.NDArray[np.uint8]:
    """Color of each number, of a fiber or a patch, (n, 3) array of RGB; one number always has one color."""
    return PALETTE[number % len(PALETTE)]


def near_the_middle(low: float, high: float) -> float:
    """Give the place of a plane that cuts cells in about the middle of a range."""
    return low + _OFF_CENTER * (high - low)


def extent(mesh: FaceMesh, scale: float = 1.0) -> Box:
    """Box around a mesh, with its lengths scaled."""
    low, high = (scale * mesh.points.min(axis=0)).tolist(), (scale * mesh.points.max(axis=0)).tolist()
    return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def scaled(box: Box, scale: float) -> Box:
    """Give the box with its lengths scaled."""
    (x0, y0, z0), (x1, y1, z1) = box.lower, box.upper
    return Box((scale * x0, scale * y0, scale * z0), (scale * x1, scale * y1, scale * z1))


def add_section(
    plotter: "pv.Plotter",
    mesh: FaceMesh,
    axis: int,
    place: float,
    scale: float,
    edges: float,
    marked: int | None = None,
) -> None:
    """Draw the section of all cells with a plane across an axis.

    Parameters
    ----------
    plotter : pyvista.Plotter
    mesh : FaceMesh
    axis : int
    place : float [m]
        Where the plane stands on the axis.
    scale : float
        The picture's length over the mesh's.
    edges : float [pixel]
        How wide the cells' outlines are.
    marked : int, optional
        A cell to draw in red.
    """
    import pyvista as pv

    cut = section(mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, axis, place)
    red = np.zeros(len(cut.cell), bool) if marked is None else cut.cell == marked
    for chosen, color in ((~red, CELLS), (red, TROUBLE)):
        if chosen.any():
            skin = pv.PolyData.from_regular_faces(cut.points * scale, cut.triangles[chosen])
            plotter.add_mesh(skin, color=color, lighting=False)
    pieces = cut.outlines
    if len(pieces):
        lines = pv.PolyData(cut.points * scale, lines=np.insert(pieces, 0, 2, axis=1).ravel())
        plotter.add_mesh(lines, color=EDGES, line_width=edges, lighting=False)


def surface_of(mesh: FaceMesh, chosen: npt.NDArray[np.bool_], scale: float) -> "pv.PolyData":
    """Give the faces around the chosen cells, in scaled lengths: those with a chosen cell on one side only."""
    import pyvista as pv

    around = chosen[mesh.owner]
    around[: mesh.internal] ^= chosen[mesh.neighbour]
    size = np.diff(mesh.offsets)
    points, corners = compacted(mesh.points, mesh.corners[np.repeat(around, size)])
    size = size[around]
    # VTK wants the number of corners before those of each face
    return pv.PolyData(points * scale, faces=np.insert(corners, np.cumsum(size) - size, size))


def add_balls(plotter: "pv.Plotter", places: Floats, radius: float) -> None:
    """Mark places of trouble, in scaled lengths."""
    import pyvista as pv

    balls = pv.PolyData(places).glyph(geom=pv.Sphere(radius=radius), scale=False, orient=False)
    plotter.add_mesh(balls, color=TROUBLE)


def add_outline(plotter: "pv.Plotter", box: Box, width: float = 1.5) -> None:
    """Draw the edges of a box, in scaled lengths."""
    import pyvista as pv

    plotter.add_mesh(pv.Box(bounds(box)).extract_all_edges(), color=INK, line_width=width, lighting=False)


def bounds(box: Box) -> tuple[float, ...]:
    """Bounds as VTK lists them: x, x, y, y, z, z."""
    return tuple(value for pair in zip(box.lower, box.upper, strict=True) for value in pair)


def look(plotter: "pv.Plotter", box: Box, towards: tuple[float, float, float], up: tuple[float, float, float]) -> None:
    """Look in a direction, in parallel projection, so that the box, in scaled lengths, just fills the picture."""
    direction = np.array(towards, float) / np.linalg.norm(towards)
    right = np.cross(direction, up)
    right /= np.linalg.norm(right)
    above = np.cross(right, direction)
    low, high = np.array(box.lower), np.array(box.upper)
    center, size = 0.5 * (low + high), high - low
    plotter.camera_position = [center - 4.0 * float(np.linalg.norm(size)) * direction, center, above]
    plotter.enable_parallel_projection()
    width, height = plotter.window_size
    half = 0.5 * max(float(size @ np.abs(above)), float(size @ np.abs(right)) * height / width)
    plotter.camera.parallel_scale = 1.04 * half
    plotter.reset_camera_clipping_range()


def look_aslant(plotter: "pv.Plotter", box: Box) -> None:
    """Look at a box, in scaled lengths, from in front, from the left and from above, z upward."""
    look(plotter, box, towards=(0.75, 1.15, -0.85), up=(0, 0, 1))
