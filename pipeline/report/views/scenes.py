"""Three-dimensional views of a run, one function each; they draw into a plotter that somebody else shows or saves.

Lengths are in micrometers here: VTK takes coordinates of 1e-6 for one point.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pipeline.export.formats.vtk import patch_surface
from pipeline.geometry.box import Box
from pipeline.geometry.polyhedra import polygons
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS
from pipeline.nouns.surface import Surface
from pipeline.report.views.drawing import (
    AIR,
    BACKGROUND,
    CELLS,
    EDGES,
    INK,
    INLET,
    MICRO,
    OUTLET,
    Scene,
    add_balls,
    add_outline,
    add_section,
    bounds,
    colors_by_number,
    extent,
    look,
    look_aslant,
    near_the_middle,
    scaled,
    surface_of,
)
from pipeline.report.views.flow_scenes import draw_slice, draw_streamlines

if TYPE_CHECKING:
    import pyvista as pv


_CUT_END = (206, 211, 217)
_FLUSH = 1e-6  # of the plan: how near to its side the end of a fiber that was cut there lies
_CLOSE = 5.0  # fiber radii from the middle of the close-up to its upper and lower end


@dataclass(frozen=True, eq=False, slots=True)
class Subject:
    """What there is to draw; `worst` are the places (n, 3) [m] of the worst cells and faces beyond a limit."""

    mat: Mat
    surface: Surface | None = None
    domain: FluidDomain | None = None
    mesh: FaceMesh | None = None
    worst: Floats | None = None
    flow: FlowField | None = None


def _fiber_faces(mesh: FaceMesh) -> Floats:
    """Center of each face on the fibers [m]."""
    which = mesh.patch(FIBERS)
    return polygons(mesh.points, mesh.corners, mesh.offsets[which.start : which.stop + 1])[1]


def mat_from_above(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw the mat from downstream: x to the right, y up."""
    _add_fibers(plotter, fiber_surface(subject))
    add_outline(plotter, _slab(subject))
    look(plotter, _slab(subject), towards=(0, 0, -1), up=(0, 1, 0))


def mat_from_the_side(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw the mat along y: x to the right, thickness up."""
    _add_fibers(plotter, fiber_surface(subject))
    add_outline(plotter, _slab(subject))
    look(plotter, _slab(subject), towards=(0, 1, 0), up=(0, 0, 1))


def mat_in_its_duct(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw the mat in the translucent duct, air from left to right (the paper's Fig. 10c)."""
    import pyvista as pv

    domain = subject.domain
    assert domain is not None
    box = scaled(domain.box, MICRO)
    _add_fibers(plotter, fiber_surface(subject))
    plotter.add_mesh(pv.Box(bounds(box)), color=AIR, opacity=0.13, lighting=False)
    add_outline(plotter, box, width=2.0)
    add_outline(plotter, _slab(subject), width=1.0)
    (x0, y0, z0), (x1, y1, z1) = box.lower, box.upper
    side = max(x1 - x0, y1 - y0)
    reach = 0.3 * side
    middle = (0.5 * (x0 + x1), 0.5 * (y0 + y1))
    for z, start, color, name in ((z0, -1.2, INLET, "inlet"), (z1, 0.2, OUTLET, "outlet")):
        plotter.add_mesh(pv.Box((x0, x1, y0, y1, z, z)), color=color, opacity=0.35, lighting=False)
        arrow = pv.Arrow(
            start=(*middle, z + start * reach), direction=(0, 0, 1), scale=reach, tip_radius=0.1, tip_length=0.35,
            shaft_radius=0.035, tip_resolution=32, shaft_resolution=24,
        )  # fmt: skip
        plotter.add_mesh(arrow, color=color, ambient=0.35)
        # below the corner that is nearest to the eye and to the reader's line
        plotter.add_point_labels(
            [(x0, y0 - 0.03 * side, z)], [name], font_size=36, bold=True, text_color=color, shape=None,
            show_points=False, always_visible=True, justification_horizontal="center", justification_vertical="top",
        )  # fmt: skip
    around = Box((x0, y0 - 0.12 * side, z0 - 1.2 * reach), (x1, y1, z1 + 1.2 * reach))
    look(plotter, around, towards=(1.0, -0.42, 0.5), up=(0, 1, 0))


def cut_through_cells(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw the middle plane x through all cells, and through its holes the fibers behind it."""
    mesh = _add_slice(plotter, subject, edges=0.8)
    look(plotter, extent(mesh, MICRO), towards=(1, 0, 0), up=(0, 1, 0))


def cut_close_up(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw a part of the same plane, a few fibers wide, so that single cells can be told apart."""
    _add_slice(plotter, subject, edges=1.6)
    mesh = subject.mesh
    assert mesh is not None
    low, high = np.array(subject.mat.slab.lower), np.array(subject.mat.slab.upper)
    half = min(_CLOSE * float(subject.mat.radius.max()), 0.5 * float((high - low)[1:].min()))
    # around the fiber that the plane meets nearest to the middle: that of the walls within half a radius of it
    walls = _fiber_faces(mesh) * MICRO
    met = np.abs(walls[:, 0] - MICRO * _middle(subject)) < 0.5 * MICRO * float(subject.mat.radius.min())
    middle = 0.5 * (low + high)
    places = walls[met] / MICRO
    if len(places):
        middle = places[np.argmin(np.linalg.norm((places - middle)[:, 1:], axis=1))]
    plan = Box((low[0], middle[1] - half, middle[2] - half), (high[0], middle[1] + half, middle[2] + half))
    look(plotter, scaled(plan, MICRO), towards=(1, 0, 0), up=(0, 1, 0))


def cells_behind_the_cut(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw the whole cells behind the middle plane x, and all fibers as the mesh has them."""
    mesh = subject.mesh
    assert mesh is not None
    behind = mesh.polyhedra().cell_centers[:, 0] > _middle(subject)
    plotter.add_mesh(
        surface_of(mesh, behind, MICRO),
        color=CELLS, ambient=0.35, diffuse=0.6, show_edges=True, edge_color=EDGES, line_width=0.8,
    )  # fmt: skip
    _add_fibers(plotter, _mesh_fibers(subject))
    look(plotter, extent(mesh, MICRO), towards=(1.0, -0.45, 0.55), up=(0, 1, 0))


def fibers_of_the_mesh(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw the mesh's own faces on the fibers, colored by fiber."""
    _add_fibers(plotter, _mesh_fibers(subject), edges=0.8)
    add_outline(plotter, _slab(subject))
    look_aslant(plotter, _slab(subject))


def worst_cells(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw where the worst cells and faces beyond a limit are, as dots among the fibers."""
    assert subject.worst is not None
    plotter.add_mesh(fiber_surface(subject), color="#aab4bf", opacity=0.3)
    add_outline(plotter, _slab(subject))
    add_balls(plotter, subject.worst * MICRO, 0.012 * MICRO * max(subject.mat.slab.size))
    look_aslant(plotter, _slab(subject))


def streamlines(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw streamlines between the fibers, air from below, colored by speed."""
    domain, flow = subject.domain, subject.flow
    assert domain is not None
    assert flow is not None
    draw_streamlines(plotter, flow, _mesh_fibers(subject))
    box = scaled(domain.box, MICRO)
    add_outline(plotter, box, width=2.0)
    look(plotter, box, towards=(-0.9, 1.75, -0.55), up=(0, 0, 1))


def slice_of_the_flow(plotter: "pv.Plotter", subject: Subject) -> None:
    """Draw speed and pressure on a plane along the flow, air from below, fibers left out."""
    domain, flow = subject.domain, subject.flow
    assert domain is not None
    assert flow is not None
    draw_slice(plotter, flow, _middle(subject) * MICRO)
    (x0, y0, z0), (x1, y1, z1) = scaled(domain.box, MICRO).lower, scaled(domain.box, MICRO).upper
    around = Box((x0, y0, z0 - 0.15 * (z1 - z0)), (x1, y1 + 1.08 * (y1 - y0), z1))
    look(plotter, around, towards=(-1.0, 0.0, 0.0), up=(0, 0, 1))


SCENES = {
    "mat-top": Scene(("mat",), (900, 900), mat_from_above),
    "mat-side": Scene(("mat",), (1400, 640), mat_from_the_side),
    "duct": Scene(("mat", "domain"), (1500, 900), mat_in_its_duct),
    "cut": Scene(("mat", "mesh"), (1500, 850), cut_through_cells),
    "close-up": Scene(("mat", "mesh"), (1000, 800), cut_close_up),
    "cells": Scene(("mat", "mesh"), (1000, 800), cells_behind_the_cut),
    "mesh-fibers": Scene(("mat", "mesh"), (1000, 800), fibers_of_the_mesh),
    "flow": Scene(("mat", "domain", "mesh", "flow"), (1100, 1150), streamlines),
    "flow-slice": Scene(("mat", "domain", "mesh", "flow"), (1300, 1000), slice_of_the_flow),
    "worst": Scene(("mat", "mesh", "worst"), (1000, 800), worst_cells),
}
"""Every view by its name."""


def fiber_surface(subject: Subject) -> "pv.PolyData":
    """Give the fibers' surface with a color per fiber, and gray where the plan's sides cut it."""
    import pyvista as pv

    surface = subject.surface
    points, triangles, fiber = (
        tubes_of(subject.mat) if surface is None else (surface.points, surface.triangles, surface.fiber)
    )
    skin = pv.PolyData.from_regular_faces(points * MICRO, triangles)
    color = colors_by_number(fiber)
    color[_on_a_side(points[triangles], subject.mat.slab)] = _CUT_END
    skin.cell_data["color"] = color
    return skin


def _on_a_side(triangles: Floats, slab: Box) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    """Tell the triangles, (n, 3, 3) array [m], that lie in a side of the plan: ends of fibers, cut flush.

    Fibers that leave side by side share one flat end, whose triangles wear the number of either.
    """
    ends = np.array([slab.lower[:2], slab.upper[:2]])
    close = np.abs(triangles[:, :, None, :2] - ends) < _FLUSH * float(np.diff(ends, axis=0).max())
    return np.asarray(close.all(axis=1).any(axis=(1, 2)))


def tubes_of(mat: Mat) -> tuple[Floats, Ints, Ints]:
    """Give round tubes in place of a surface, before the fibers are united: points [m], triangles, fiber of each."""
    import pyvista as pv

    points, triangles, fiber, count = [], [], [], 0
    for k, radius in enumerate(mat.radius):
        line = mat.nodes[mat.first[k] : mat.first[k + 1]] * MICRO
        tube = pv.MultipleLines(line).tube(radius=float(radius) * MICRO, n_sides=16, capping=True).triangulate()
        points.append(np.asarray(tube.points, np.float64) / MICRO)
        triangles.append(count + np.asarray(tube.regular_faces, np.int64))
        fiber.append(np.full(len(triangles[-1]), k))
        count += len(points[-1])
    return np.concatenate(points), np.concatenate(triangles), np.concatenate(fiber)


def _mesh_fibers(subject: Subject, beyond: float | None = None) -> "pv.PolyData":
    mesh = subject.mesh
    assert mesh is not None
    skin = patch_surface(mesh, FIBERS, MICRO)
    skin.cell_data["color"] = colors_by_number(mesh.fiber)
    return skin if beyond is None else skin.clip("x", origin=(MICRO * beyond, 0, 0), invert=False)


def _middle(subject: Subject) -> float:
    """Where the plane x of the pictures stands [m]."""
    return near_the_middle(subject.mat.slab.lower[0], subject.mat.slab.upper[0])


def _slab(subject: Subject) -> Box:
    return scaled(subject.mat.slab, MICRO)


def _add_fibers(plotter: "pv.Plotter", skin: "pv.PolyData", edges: float = 0.0) -> None:
    plotter.add_mesh(
        skin, scalars="color", rgb=True, preference="cell", ambient=0.25, diffuse=0.8, specular=0.15,
        show_edges=edges > 0, edge_color=INK, line_width=edges or 1.0,
    )  # fmt: skip


def _add_slice(plotter: "pv.Plotter", subject: Subject, edges: float) -> FaceMesh:
    mesh = subject.mesh
    assert mesh is not None
    middle = _middle(subject)
    add_section(plotter, mesh, 0, middle, MICRO, edges)
    _add_fibers(plotter, _mesh_fibers(subject, beyond=middle))
    return mesh


def show(subject: Subject, there: tuple[str, ...], scene: str | None, title: str) -> None:
    """Open a window on a scene, or on the mat beside the richest scene there is, and wait until it is closed."""
    import pyvista as pv

    richest = next(name for name in ("cells", "duct", "mat-top") if name in there)
    names = (scene,) if scene else tuple(dict.fromkeys(("duct" if "duct" in there else "mat-side", richest)))
    plotter = pv.Plotter(shape=(1, len(names)), window_size=(900 * len(names), 800), title=title)
    for column, name in enumerate(names):
        plotter.subplot(0, column)
        plotter.set_background(BACKGROUND)
        SCENES[name].draw(plotter, subject)
    plotter.show()
