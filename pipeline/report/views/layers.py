"""What a model to turn in a browser holds: surfaces, outlines, cells, and no more triangles than a page bears."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from pipeline.analytics.tables.rows import length
from pipeline.geometry.box import Box
from pipeline.geometry.sections import fan
from pipeline.line.results import Results
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS, INLET, OUTLET
from pipeline.nouns.surface import Surface
from pipeline.report.page.content import MeshContent
from pipeline.report.views import drawing
from pipeline.report.views.mesh_scenes import axis_of_sections
from pipeline.report.views.model_cells import ModelCells, cells_of
from pipeline.report.views.model_flow import NumberField, Particles, Streamlines, caught, drag, streamlines_of
from pipeline.report.views.scenes import tubes_of

LARGEST = 300_000
"""Triangles that a model holds at most: 8 MB of text."""
_SEE_THROUGH, _SOLID = 0.3, 1.0
_OUTWARD, _INWARD = 1, -1


@dataclass(frozen=True, eq=False, slots=True)
class Layer:
    """Triangles that are shown and hidden together.

    Parameters
    ----------
    name : str
    points : (n, 3) array [m]
    triangles : (t, 3) int array
    edges : (t,) int array
        Which sides of a triangle are to be drawn as lines: bit k stands for that from corner k to the next.
    number : (t,) int array
        Of the fiber or patch that each belongs to.
    color : str, optional
        As ``#rrggbb``; without it a number has a color of its own.
    opacity : float
    shown : bool
        Whether it is seen at first.
    label : str
        What a triangle's number counts, as in "fiber 7"; where it is empty a click tells the layer's name.
    solid : int
        1 or -1 where the triangles enclose something solid, and are counterclockwise seen from outside or inside it.
    """

    name: str
    points: Floats
    triangles: Ints
    edges: Ints
    number: Ints
    color: str | None = None
    opacity: float = _SOLID
    shown: bool = True
    label: str = ""
    solid: int = 0


@dataclass(frozen=True, eq=False, slots=True)
class Model:
    """All that a model to turn shows.

    Parameters
    ----------
    layers : tuple of Layer
    outlines : dict of str to Box
    note : str
        What was left out, in words.
    cells : ModelCells, optional
        What a plane cuts.
    axis : int
        Across which the plane stands at first.
    streamlines : Streamlines, optional
    particles : tuple of Particles
    number_fields : tuple of NumberField
        What layers with a label can be colored by beside their number.
    """

    layers: tuple[Layer, ...]
    outlines: dict[str, Box]
    note: str
    cells: ModelCells | None = None
    axis: int = 0
    streamlines: Streamlines | None = None
    particles: tuple[Particles, ...] = ()
    number_fields: tuple[NumberField, ...] = ()


def layers_of_run(content: Results) -> Model:
    """Give what a run has: its fibers, the patches of its duct, its cells, its flow and the particles that it caught.

    The content must have a mat at least.
    """
    mat, mesh, domain = content.read(Mat), content.get(FaceMesh), content.get(FluidDomain)
    flow, solution = content.get(FlowField), content.get(Solution)
    layers = [_fibers(content)]
    if mesh is not None:
        layers += _patches(mesh, {FIBERS})
    elif domain is not None:
        layers += _sides(domain)
    outlines = {"slab of the mat": mat.slab}
    if domain is not None:
        outlines["duct"] = domain.box
    return replace(
        _with_cells(limited(layers, outlines), mesh, flow),
        streamlines=streamlines_of(flow) if flow is not None else None,
        particles=caught(content),
        number_fields=drag(solution) if solution is not None else (),
    )


def layers_of_mesh(content: MeshContent) -> Model:
    """Give what a mesh alone has: its patches and its cells."""
    mesh = content.mesh
    layers = [replace(layer, opacity=_SOLID, shown=True) for layer in _patches(mesh, set())]
    model = limited(layers, {"extent": drawing.extent(mesh)})
    return replace(_with_cells(model, mesh, None), axis=axis_of_sections(mesh))


def _with_cells(model: Model, mesh: FaceMesh | None, flow: FlowField | None) -> Model:
    if mesh is None:
        return model
    cells = cells_of(mesh, flow)
    return replace(model, cells=cells, note="; ".join(part for part in (model.note, cells.note) if part))


def limited(layers: list[Layer], outlines: dict[str, Box], largest: int = LARGEST) -> Model:
    """Thin out layers until all of them together have no more triangles than a page bears.

    Points that lie within one cell of a grid become one, and what has no area left goes. The grid is the finest of
    those that double each other which is coarse enough.
    """
    layers = [layer for layer in layers if len(layer.triangles)]
    whole = sum(len(layer.triangles) for layer in layers)
    size = max(float(np.ptp(layer.points, axis=0).max()) for layer in layers)
    cell, thin = size / 4096, layers
    while sum(len(layer.triangles) for layer in thin) > largest:
        thin = [_merged(layer, cell) for layer in layers]
        cell *= 2.0
    kept = sum(len(layer.triangles) for layer in thin)
    note = f"{kept:,} triangles"
    if kept < whole:
        note += f" of {whole:,}: points closer than {length(0.5 * cell)} were merged"
    return Model(tuple(layer for layer in thin if len(layer.triangles)), outlines, note)


def _merged(layer: Layer, cell: float) -> Layer:
    place = np.floor((layer.points - layer.points.min(axis=0)) / cell).astype(np.int64)
    _, first, which = np.unique(place, axis=0, return_index=True, return_inverse=True)
    triangles = which.ravel()[layer.triangles]
    a, b, c = triangles.T
    kept = (a != b) & (b != c) & (c != a)
    return replace(
        layer,
        points=layer.points[first],
        triangles=triangles[kept],
        edges=layer.edges[kept],
        number=layer.number[kept],
    )


def _fibers(content: Results) -> Layer:
    name, label = "fibers", "fiber"
    mesh, surface = content.get(FaceMesh), content.get(Surface)
    if mesh is not None:
        which = mesh.patch(FIBERS)
        points, triangles, edges, face = fan(mesh.points, mesh.corners, mesh.offsets[which.start : which.stop + 1])
        return Layer(name, points, triangles, edges, mesh.fiber[face], label=label, solid=_INWARD)
    if surface is not None:
        edges = _all_edges(surface.triangles)
        return Layer(name, surface.points, surface.triangles, edges, surface.fiber, label=label, solid=_OUTWARD)
    points, triangles, fiber = tubes_of(content.read(Mat))
    return Layer(name, points, triangles, _all_edges(triangles), fiber, label=label, solid=_OUTWARD)


def _all_edges(triangles: Ints) -> Ints:
    return np.full(len(triangles), 0b111)


def _patches(mesh: FaceMesh, without: set[str]) -> Iterator[Layer]:
    for number, patch in enumerate(mesh.patches):
        if patch.name in without or not patch.count:
            continue
        which = mesh.patch(patch.name)
        offsets = mesh.offsets[which.start : which.stop + 1]
        points, triangles, edges, _ = fan(mesh.points, mesh.corners, offsets)
        yield _side(patch.name, number, points, triangles, edges)


def _sides(domain: FluidDomain) -> Iterator[Layer]:
    for number, name in enumerate(domain.patches):
        triangles = domain.triangles[domain.patch == number]
        if name != FIBERS and len(triangles):
            yield _side(name, number, domain.points, triangles, _all_edges(triangles))


def _side(name: str, number: int, points: Floats, triangles: Ints, edges: Ints) -> Layer:
    ours = {INLET: drawing.INLET, OUTLET: drawing.OUTLET}
    color = ours.get(name) or "#" + bytes(drawing.colors_by_number(np.array([number]))[0].tolist()).hex()
    numbers = np.full(len(triangles), number)
    return Layer(name, points, triangles, edges, numbers, color, _SEE_THROUGH, shown=name in ours)
