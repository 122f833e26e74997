"""The cells of a model to turn, as tetrahedra that the page itself cuts with any plane, and the fields on them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass, replace

import numpy as np

from pipeline.geometry.faces import compacted
from pipeline.geometry.sections import fan
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.quality.judge import cell_fields

LARGEST = 250_000
"""Tetrahedra that a model holds at most: 6 MB of text."""
NODES, VERTICES, CELLS = "nodes", "vertices", "cells"
_WHOLE = 0b1111
_TOWARD_CENTER = 0b1000  # only the face across from the last vertex, a cell's middle, is a face of the cell
_LOUD = 99.5  # percentile at which a field's colors end: a single cell would else take them all
_QUALITY = {"non_orthogonality": "degree", "skewness": "", "aspect_ratio": ""}


@dataclass(frozen=True, eq=False, slots=True)
class Field:
    """Something that cells are colored by.

    Parameters
    ----------
    name, unit : str
    at : str
        `NODES` (quadratic: vertices, then the middles of edges in the order in which the tetrahedra name them first),
        `VERTICES` (linear) or `CELLS` (one value per tetrahedron).
    values : (n,) array
    low, high : float
        Ends of the colors.
    """

    name: str
    unit: str
    at: str
    values: Floats
    low: float
    high: float


@dataclass(frozen=True, eq=False, slots=True)
class ModelCells:
    """Cells in tetrahedra.

    Parameters
    ----------
    points : (n, 3) array [m]
    tets : (t, 4) int array
    sides : (t,) int array
        Bit k where the face across from vertex k is a face of the cell, and not one between two of its tetrahedra.
    cell : (t,) int array
        Number in the mesh of the cell that each belongs to.
    fields : tuple of Field
    note : str
        What was left out, in words; empty where nothing was.
    """

    points: Floats
    tets: Ints
    sides: Ints
    cell: Ints
    fields: tuple[Field, ...] = ()
    note: str = ""


def cells_of(mesh: FaceMesh, flow: FlowField | None = None, largest: int = LARGEST) -> ModelCells:
    """Give the cells of a mesh with their quality, and with speed and pressure where the flow on them is known.

    Parameters
    ----------
    mesh : FaceMesh
    flow : FlowField, optional
        Solved on this mesh, of tetrahedra.
    largest : int
        How many tetrahedra there may be. Where there are more, those that are nearest to the middle stay.
    """
    whole = _in_tetrahedra(mesh)
    if flow is not None:
        # the flow's own order of vertices, which its edges go by
        whole = replace(whole, tets=flow.cells[:, :4])
    chosen = _around_the_middle(whole, largest)
    points, corners = compacted(whole.points, whole.tets[chosen].ravel())
    tets, cell = corners.reshape(-1, 4), whole.cell[chosen]
    fields = [] if flow is None else _flow_fields(flow, whole.tets[chosen], flow.cells[cell])
    for name, values in cell_fields(mesh).items():
        if name in _QUALITY:
            fields.append(_field(name.replace("_", " "), _QUALITY[name], CELLS, values[cell]))
    note = ""
    if len(chosen) < len(whole.tets):
        seen = len(np.unique(cell))
        note = f"the section shows {seen:,} of {mesh.cells:,} cells, those nearest to the middle"
    return ModelCells(points, tets, whole.sides[chosen], cell, tuple(fields), note)


def _in_tetrahedra(mesh: FaceMesh) -> ModelCells:
    if mesh.tetrahedral:
        tets = mesh.tets()
        return ModelCells(mesh.points, tets, np.full(len(tets), _WHOLE), np.arange(len(tets)))
    # between each triangle of a cell's faces and the middle of the cell
    points, triangles, _, face = fan(mesh.points, mesh.corners, mesh.offsets)
    inner = np.flatnonzero(face < mesh.internal)
    triangle = np.concatenate([triangles, triangles[inner]])
    cell = np.concatenate([mesh.owner[face], mesh.neighbour[face[inner]]])
    tets = np.column_stack([triangle, len(points) + cell])
    centers = mesh.polyhedra().cell_centers
    return ModelCells(np.concatenate([points, centers]), tets, np.full(len(tets), _TOWARD_CENTER), cell)


def _around_the_middle(cells: ModelCells, largest: int) -> Ints:
    count = len(cells.tets)
    if count <= largest:
        return np.arange(count)
    low, high = cells.points.min(axis=0), cells.points.max(axis=0)
    # a box of the whole one's shape, so that every plane through the middle still shows a section
    far = np.abs((cells.points - 0.5 * (low + high)) / (high - low)).max(axis=1)[cells.tets].max(axis=1)
    nearest = np.argpartition(far, largest - 1)[:largest]
    return np.sort(nearest)


def _flow_fields(flow: FlowField, old: Ints, nodes: Ints) -> list[Field]:
    """Give speed and pressure at the nodes, in the order in which the page numbers them."""
    vertices = np.unique(old)
    edge = nodes[:, 4:]
    # an edge has the number of its first coming, tetrahedron by tetrahedron
    _, first = np.unique(edge.ravel(), return_index=True)
    middles = edge.ravel()[np.sort(first)]
    speed = 100.0 * np.linalg.norm(flow.velocity, axis=1)
    return [
        replace(_field("speed", "cm/s", NODES, np.concatenate([speed[vertices], speed[middles]])), low=0.0),
        _field("pressure", "Pa", VERTICES, flow.pressure[vertices]),
    ]


def _field(name: str, unit: str, at: str, values: Floats) -> Field:
    finite = values[np.isfinite(values)]
    low, high = np.percentile(finite, [100.0 - _LOUD, _LOUD]).tolist() if len(finite) else (0.0, 1.0)
    return Field(name, unit, at, values, low, high)
