"""Views of a mesh of which nothing else is known: its patches, its cells, its worst places.

The mesh is scaled so that its largest extent is 1, whatever its unit was.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pipeline.export.formats.vtk import patch_surface
from pipeline.geometry.box import Box
from pipeline.nouns.arrays import Floats
from pipeline.nouns.mesh import FaceMesh
from pipeline.report.views.drawing import (
    EDGES,
    Scene,
    add_balls,
    add_outline,
    add_section,
    colors_by_number,
    extent,
    look,
    look_aslant,
    near_the_middle,
)

if TYPE_CHECKING:
    import pyvista as pv

_MANY_FACES = 40_000
"""From this many faces on the boundary their edges would blacken the picture."""
_CELLS_AROUND = 5.0
"""The close-up shows as many cells' sizes on each side of its middle."""


@dataclass(frozen=True, eq=False, slots=True)
class MeshSubject:
    """What there is to draw of a mesh alone.

    Parameters
    ----------
    mesh : FaceMesh
    focus : (3,) array [m]
        Where the worst cell or face is.
    worst : (n, 3) array [m], optional
        Places beyond a limit.
    """

    mesh: FaceMesh
    focus: Floats
    worst: Floats | None = None


def from_outside(plotter: "pv.Plotter", subject: MeshSubject) -> None:
    """Draw the boundary, one color per patch."""
    mesh, scale = subject.mesh, _scale(subject.mesh)
    _add_patches(plotter, mesh, scale, edges=mesh.faces - mesh.internal < _MANY_FACES)
    look_aslant(plotter, extent(mesh, scale))


def section_of_all(plotter: "pv.Plotter", subject: MeshSubject) -> None:
    """Draw the middle plane across the shortest extent through all cells, with the walls behind its holes."""
    mesh, scale = subject.mesh, _scale(subject.mesh)
    axis, across, up = _axes(mesh)
    box = extent(mesh)
    place = near_the_middle(box.lower[axis], box.upper[axis])
    add_section(plotter, mesh, axis, place, scale, edges=0.8)
    _add_patches(plotter, mesh, scale, beyond=(axis, place))
    look(plotter, extent(mesh, scale), towards=across, up=up)


def section_at_the_worst(plotter: "pv.Plotter", subject: MeshSubject) -> None:
    """Draw the plane through the worst place, as wide as some ten cells there are; the cell itself in red."""
    mesh, scale = subject.mesh, _scale(subject.mesh)
    axis, across, up = _axes(mesh)
    shape = mesh.polyhedra()
    cell = int(np.argmin(((shape.cell_centers - subject.focus) ** 2).sum(axis=1)))
    center = shape.cell_centers[cell]
    # the plane must meet the cell, which a grid's own plane might only touch
    place = float(center[axis]) + 1e-4 * float(np.cbrt(abs(shape.volumes[cell])))
    add_section(plotter, mesh, axis, place, scale, edges=1.6, marked=cell)
    size = np.ptp(mesh.points[mesh.corners[_corners_of(mesh, cell)]], axis=0).max()
    box = extent(mesh)
    half = min(_CELLS_AROUND * float(size), 0.5 * max(box.size))
    low, high = np.maximum(center - half, box.lower), np.minimum(center + half, box.upper)
    low[axis], high[axis] = box.lower[axis], box.upper[axis]
    look(plotter, Box(tuple((scale * low).tolist()), tuple((scale * high).tolist())), towards=across, up=up)


def worst_places(plotter: "pv.Plotter", subject: MeshSubject) -> None:
    """Draw where the worst cells and faces beyond a limit are, as dots within the boundary."""
    assert subject.worst is not None
    mesh, scale = subject.mesh, _scale(subject.mesh)
    for patch in mesh.patches:
        if patch.count:
            plotter.add_mesh(patch_surface(mesh, patch.name, scale), color="#aab4bf", opacity=0.2)
    box = extent(mesh, scale)
    add_outline(plotter, box)
    add_balls(plotter, subject.worst * scale, 0.012)
    look_aslant(plotter, box)


MESH_SCENES = {
    "outside": Scene(("mesh",), (1000, 800), from_outside),
    "section": Scene(("mesh",), (1500, 850), section_of_all),
    "section-worst": Scene(("mesh",), (1000, 800), section_at_the_worst),
    "worst-places": Scene(("worst",), (1000, 800), worst_places),
}
"""Every view of a mesh alone by its name."""


def _scale(mesh: FaceMesh) -> float:
    return 1.0 / max(extent(mesh).size)


def axis_of_sections(mesh: FaceMesh) -> int:
    """Axis across which the pictures cut: that of the shortest extent, so that the section is the largest."""
    return _axes(mesh)[0]


def _axes(mesh: FaceMesh) -> tuple[int, tuple[float, float, float], tuple[float, float, float]]:
    """Axis across which the mesh is thinnest, the direction along it, and the one of the others that points up."""
    axis, up, _ = np.argsort(extent(mesh).size, kind="stable").tolist()
    unit = [tuple(row) for row in np.eye(3).tolist()]
    return axis, unit[axis], unit[up]


def _corners_of(mesh: FaceMesh, cell: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Places in `corners` of all faces of a cell."""
    faces = np.concatenate([np.flatnonzero(mesh.owner == cell), np.flatnonzero(mesh.neighbour == cell)])
    return np.concatenate([np.arange(mesh.offsets[face], mesh.offsets[face + 1]) for face in faces])


def _add_patches(
    plotter: "pv.Plotter", mesh: FaceMesh, scale: float, edges: bool = False, beyond: tuple[int, float] | None = None
) -> None:
    for number, patch in enumerate(mesh.patches):
        if not patch.count:
            continue
        skin = patch_surface(mesh, patch.name, scale)
        if beyond is not None:
            axis, place = beyond
            origin = [0.0, 0.0, 0.0]
            origin[axis] = place * scale
            skin = skin.clip("xyz"[axis], origin=origin, invert=False)
        if skin.n_cells:
            color = colors_by_number(np.array([number]))[0].tolist()
            plotter.add_mesh(
                skin, color=color, ambient=0.3, diffuse=0.75, show_edges=edges, edge_color=EDGES, line_width=0.8
            )
