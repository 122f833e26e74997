"""Fibers as text: CSV of their center lines, and the list of cylinders that SpaceClaim builds from (docs/mat.md)."""

# SPDX-License-Identifier: GPL-3.0-or-later

import io
from pathlib import Path

import numpy as np

from pipeline.cad.lengths import in_micrometers
from pipeline.nouns.fibers import Mat

COLUMNS = ("fiber", "x", "y", "z", "radius")
"""Columns of the CSV."""


def write_fibers(mat: Mat, path: Path) -> None:
    """Write a mat's center lines as CSV, in micrometers, one line per point.

    Parameters
    ----------
    mat : Mat
    path : Path
        `pipeline.mat.exchange.read_fibers` gives the same mat back, bit by bit where the slab begins at 0.
    """
    x, y, z = (in_micrometers(size) for size in mat.slab.size)
    lines = [
        f"# {' '.join(mat.origin.split())}",
        f"# plan: {x} um x {y} um",
        f"# thickness: {z} um",
        f"# periodic: {'yes' if mat.periodic else 'no'}",
        ",".join(["fiber", *(f"{name} [um]" for name in COLUMNS[1:])]),
    ]
    nodes = mat.nodes - mat.slab.lower
    radius = [in_micrometers(value) for value in mat.radius.tolist()]
    fiber = np.repeat(np.arange(mat.fibers), np.diff(mat.first))
    for k, point in zip(fiber.tolist(), nodes.tolist(), strict=True):
        lines.append(",".join([str(k), *map(in_micrometers, point), radius[k]]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_spaceclaim(mat: Mat, path: Path) -> None:
    """Write the paper's list of cylinders: per segment its start, its end, and a point on the surface at the end.

    Parameters
    ----------
    mat : Mat
    path : Path
        Gets nine numbers per line [m], the unit of SpaceClaim's scripts, separated by tabs.
    """
    start = mat.segment_starts()
    begin, end = mat.nodes[start], mat.nodes[start + 1]
    axis = (end - begin) / mat.segment_lengths()[:, None]
    # any direction across the axis: here the one that is level
    level = np.column_stack([-axis[:, 1], axis[:, 0], np.zeros(len(axis))])
    upright = np.hypot(axis[:, 0], axis[:, 1]) < 1e-6
    level[upright] = [1.0, 0.0, 0.0]
    level -= np.einsum("ij,ij->i", level, axis)[:, None] * axis
    level /= np.linalg.norm(level, axis=1)[:, None]
    on_surface = end + mat.radius[mat.segment_fibers()][:, None] * level
    text = io.StringIO()
    np.savetxt(text, np.column_stack([begin, end, on_surface]), fmt="%.12e", delimiter="\t")
    path.write_text(text.getvalue(), encoding="utf-8")
