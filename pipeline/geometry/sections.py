"""Polygons in triangles, and sections of polyhedra with a plane across an axis."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.polyhedra import by_size
from pipeline.geometry.triangles import Floats, Ints


@dataclass(frozen=True, eq=False, slots=True)
class Section:
    """Where a plane meets the cells of a mesh.

    Parameters
    ----------
    points : (n, 3) array
    triangles : (t, 3) int array
        From a piece of a cell's outline, its first two corners, to the middle of the cell's section.
    cell : (t,) int array
    """

    points: Floats
    triangles: Ints
    cell: Ints

    @property
    def outlines(self) -> Ints:
        """The pieces of all outlines, (k, 2) int array; one between two cells stands there once."""
        return np.unique(self.triangles[:, :2], axis=0)


def section(
    points: Floats, corners: Ints, offsets: Ints, owner: Ints, neighbour: Ints, axis: int, place: float
) -> Section:
    """Cut all cells of a mesh with a plane across an axis.

    Parameters
    ----------
    points : (n, 3) array
    corners, offsets, owner, neighbour : int arrays
        As in `pipeline.nouns.mesh.FaceMesh`.
    axis : int
        0, 1 or 2.
    place : float
        Where the plane stands on the axis.

    Returns
    -------
    Section
        Right where a cell's section is seen whole from its middle, as every convex one is.

    Notes
    -----
    Faces are cut into triangles about the mean of their corners, as OpenFOAM does: a triangle meets the plane in
    one piece of a line. A point on the plane counts as below it.
    """
    beyond = points[corners, axis] > place
    some, every = (each.reduceat(beyond, offsets[:-1]) for each in (np.logical_or, np.logical_and))
    met = np.flatnonzero(some & ~every)
    size = np.diff(offsets)[met]
    inside = np.repeat(offsets[met] - np.cumsum(size) + size, size) + np.arange(int(size.sum()))
    vertices, triangles, _, polygon = fan(points, corners[inside], np.concatenate([[0], np.cumsum(size)]))
    above = vertices[triangles, axis] > place
    crossed = above.any(axis=1) & ~above.all(axis=1)
    triangles, above, face = triangles[crossed], above[crossed], met[polygon[crossed]]
    # the corner that stands alone on its side
    alone = np.argmax(above == (above.sum(axis=1) == 1)[:, None], axis=1)
    ends = []
    for step in (1, 2):
        row = np.arange(len(triangles))
        a, b = vertices[triangles[row, alone]], vertices[triangles[row, (alone + step) % 3]]
        share = (place - a[:, axis]) / (b[:, axis] - a[:, axis])
        end = a + share[:, None] * (b - a)
        end[:, axis] = place
        ends.append(end)
    count = len(triangles)
    inner = np.flatnonzero(face < len(neighbour))
    piece = np.concatenate([np.arange(count), inner])
    cell = np.concatenate([owner[face], neighbour[face[inner]]])
    cells, local = np.unique(cell, return_inverse=True)
    local = local.ravel()
    total = np.zeros((len(cells), 3))
    np.add.at(total, local, 0.5 * (ends[0] + ends[1])[piece])
    middle = total / np.bincount(local, minlength=len(cells))[:, None]
    return Section(
        points=np.concatenate([*ends, middle]),
        triangles=np.column_stack([piece, count + piece, 2 * count + local]),
        cell=cell,
    )


def fan(points: Floats, corners: Ints, offsets: Ints) -> tuple[Floats, Ints, Ints, Ints]:
    """Cut polygons into triangles, and keep which of their sides are sides of the polygons.

    Parameters
    ----------
    points : (n, 3) array
    corners, offsets : int arrays
        Polygon f is ``corners[offsets[f]:offsets[f + 1]]``; `offsets` may begin anywhere in `corners`.

    Returns
    -------
    points : (k, 3) array
        Those of the corners, then the middles of the polygons of more than three.
    triangles : (t, 3) int array
    edges : (t,) int array
        Bit k where the side from corner k to the next is one of the polygon's.
    polygon : (t,) int array

    Examples
    --------
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    >>> _, triangles, edges, polygon = fan(square, np.array([0, 1, 2, 3]), np.array([0, 4]))
    >>> triangles.tolist(), edges.tolist(), polygon.tolist()
    ([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], [1, 1, 1, 1], [0, 0, 0, 0])
    """
    used, local = np.unique(corners[offsets[0] : offsets[-1]], return_inverse=True)
    vertices, count = [points[used]], len(used)
    parts = [(np.empty((0, 3), np.int64), np.empty(0, np.int64), np.empty(0, np.int64))]
    for polygon, places in by_size(offsets - offsets[0]):
        around = local.ravel()[places]
        sides = around.shape[1]
        if sides == 3:
            parts.append((around, np.full(len(around), 0b111), polygon))
            continue
        middle = np.broadcast_to((count + np.arange(len(polygon)))[:, None], around.shape)
        triangles = np.stack([around, np.roll(around, -1, axis=1), middle], axis=2).reshape(-1, 3)
        parts.append((triangles, np.full(len(triangles), 0b001), np.repeat(polygon, sides)))
        vertices.append(vertices[0][around].mean(axis=1))
        count += len(polygon)
    triangles, edges, polygon = (np.concatenate(each) for each in zip(*parts, strict=True))
    return np.concatenate(vertices), triangles, edges, polygon
