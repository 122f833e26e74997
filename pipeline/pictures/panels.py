"""Rendered mats in figures with axes in micrometers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.geometry.box import Box
from pipeline.nouns.fibers import Mat
from pipeline.pictures.render import COLORS, INLET_COLOR, OUTLET_COLOR, View, duct_view, plan_view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DPI = 100


def mat_figure(mat: Mat, view: View, title: str = "", pixels: int = 900) -> "Figure":
    """Draw a mat from above or from the side, colored by height.

    Parameters
    ----------
    mat : Mat
    view : {"top", "side"}
    title : str
    pixels : int
        Width of the rendered part.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    ratio = (mat.slab.size[1] if view == "top" else mat.thickness) / mat.slab.size[0]
    # room for axes and color bar beside and below the picture
    figure = Figure(figsize=(pixels / _DPI + 1.9, ratio * pixels / _DPI + 0.9), layout="constrained")
    axes = figure.subplots()
    draw_mat(axes, mat, view, pixels)
    axes.set_title(title, loc="left", fontsize="medium")
    colors = ScalarMappable(Normalize(0.0, mat.thickness * 1e6), COLORS)
    # as high as the picture, whatever its shape
    beside = axes.inset_axes((1.0 + 0.2 / (pixels / _DPI), 0.0, 0.2 / (pixels / _DPI), 1.0))
    figure.colorbar(colors, cax=beside, label="height z [um]")
    return figure


def draw_mat(axes: "Axes", mat: Mat, view: View, pixels: int) -> None:
    """Draw a mat into axes that are in micrometers."""
    image = plan_view(mat, view, pixels)
    axes.imshow(image.pixels, extent=image.extent, interpolation="antialiased")
    axes.set_xlabel("x [um]")
    axes.set_ylabel("y [um]" if view == "top" else "z [um]")


def contact_sheet(mats: Sequence[Mat], labels: Sequence[str], view: View, pixels: int = 620) -> "Figure":
    """Draw several mats side by side, all at one scale, each with its label.

    Parameters
    ----------
    mats : sequence of Mat
    labels : sequence of str
        One per mat.
    view : {"top", "side"}
    pixels : int
        Width of each.
    """
    from matplotlib.figure import Figure

    columns = min(len(mats), 2 if view == "side" else 3)
    rows = -(-len(mats) // columns)
    up = 1 if view == "top" else 2
    widest = max(mat.slab.size[0] for mat in mats) * 1e6
    tallest = [max(mat.slab.size[up] for mat in mats[k * columns : (k + 1) * columns]) * 1e6 for k in range(rows)]
    scale = pixels / _DPI / widest
    size = (columns * (widest * scale + 0.7), sum(tallest) * scale + 0.75 * rows)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False, height_ratios=tallest).ravel()
    for number, axes in enumerate(panels):
        if number >= len(mats):
            axes.set_axis_off()
            continue
        draw_mat(axes, mats[number], view, pixels)
        axes.set_xlim(0.0, widest)
        axes.set_ylim(0.0, tallest[number // columns])
        axes.set_title(labels[number], loc="left", fontsize="medium")
    return figure


def duct_figure(mat: Mat, duct: Box, title: str = "", size: tuple[int, int] = (760, 900)) -> "Figure":
    """Draw a mat in its duct, with inlet (blue) and outlet (red)."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    figure = Figure(figsize=(size[0] / _DPI, size[1] / _DPI + 0.4), layout="constrained")
    axes = figure.subplots()
    axes.imshow(duct_view(mat, duct, size).pixels, interpolation="antialiased")
    axes.set_axis_off()
    axes.set_title(title, loc="left", fontsize="medium")
    edges = " x ".join(f"{1e6 * edge:.4g}" for edge in duct.size)
    handles = [
        Patch(color=OUTLET_COLOR, alpha=0.35, label="outlet"),
        Patch(color=INLET_COLOR, alpha=0.35, label="inlet"),
    ]
    axes.legend(handles=handles, title=f"duct {edges} um", loc="upper right", frameon=False, fontsize="small")
    return figure


def write_png(figure: "Figure", path: Path) -> None:
    """Write a figure as a small PNG of 160 colors; equal figures give equal files."""
    from PIL import Image

    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_DPI, metadata={"Software": None})
    buffer.seek(0)
    with Image.open(buffer) as full:
        # a palette takes a third of the space, and nobody sees the difference
        small = full.convert("RGB").quantize(160, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    small.save(path, optimize=True)
