"""Areas, centers and volumes of polygons and of the polyhedra between them, as OpenFOAM computes them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pipeline.geometry.triangles import Floats, Ints


def by_size(offsets: Ints) -> Iterator[tuple[Ints, Ints]]:
    """Group polygons by their number of corners, so that each group is one array.

    Parameters
    ----------
    offsets : (faces + 1,) int array
        Polygon f owns ``corners[offsets[f]:offsets[f + 1]]``.

    Yields
    ------
    faces : (k,) int array
    places : (k, size) int array
        Where their corners stand.
    """
    sizes = np.diff(offsets)
    if len(sizes) and sizes.min() == sizes.max():
        # a mesh of triangles alone: nothing to look for
        yield np.arange(len(sizes)), offsets[:-1, None] + np.arange(sizes[0])
        return
    for size in np.unique(sizes):
        faces = np.flatnonzero(sizes == size)
        yield faces, offsets[faces][:, None] + np.arange(size)


def polygons(points: Floats, corners: Ints, offsets: Ints) -> tuple[Floats, Floats]:
    """Area vector and center of each polygon.

    Parameters
    ----------
    points : (n, 3) array [m]
    corners, offsets : int arrays
        As in `by_size`.

    Returns
    -------
    areas : (faces, 3) array [m2]
        Normal to the polygon, as long as its area.
    centers : (faces, 3) array [m]

    Notes
    -----
    OpenFOAM's `primitiveMesh::makeFaceCentresAndAreas`: a triangle's center is the mean of its corners; any other
    polygon is a fan of triangles about that mean, whose centers are weighted by their areas.

    Examples
    --------
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    >>> areas, centers = polygons(square, np.arange(4), np.array([0, 4]))
    >>> areas.tolist(), centers.tolist()
    ([[0.0, 0.0, 1.0]], [[0.5, 0.5, 0.0]])
    """
    areas, centers = np.empty((len(offsets) - 1, 3)), np.empty((len(offsets) - 1, 3))
    for faces, places in by_size(offsets):
        vertices = points[corners[places]]
        middle = vertices.mean(axis=1)
        if places.shape[1] == 3:
            edges = vertices[:, 1:] - vertices[:, :1]
            areas[faces], centers[faces] = 0.5 * np.cross(edges[:, 0], edges[:, 1]), middle
            continue
        following = np.roll(vertices, -1, axis=1)
        normals = np.cross(following - vertices, middle[:, None] - vertices)
        weights = np.linalg.norm(normals, axis=2)
        total = weights.sum(axis=1)
        moment = np.einsum("fk,fkx->fx", weights, vertices + following + middle[:, None])
        areas[faces] = 0.5 * normals.sum(axis=1)
        flat = total == 0
        centers[faces] = np.where(flat[:, None], middle, moment / (3.0 * np.where(flat, 1.0, total))[:, None])
    return areas, centers


def fanned(points: Floats, corners: Ints, offsets: Ints) -> tuple[Floats, Ints]:
    """Cut polygons into triangles, as OpenFOAM does: a fan about the mean of the corners, a triangle as it is.

    Parameters
    ----------
    points : (n, 3) array [m]
    corners, offsets : int arrays
        As in `by_size`; `offsets` may begin anywhere in `corners`.

    Returns
    -------
    points : (k, 3) array [m]
        The corners' points, then the middles of the polygons.
    triangles : (t, 3) int array
        Each goes round as its polygon does.

    Examples
    --------
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    >>> points, triangles = fanned(square, np.arange(4), np.array([0, 4]))
    >>> points[-1].tolist(), triangles.tolist()
    ([0.5, 0.5, 0.0], [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    """
    used, local = np.unique(corners[offsets[0] : offsets[-1]], return_inverse=True)
    vertices = [points[used]]
    triangles = [np.empty((0, 3), np.int64)]
    count = len(used)
    for faces, places in by_size(offsets - offsets[0]):
        around = local[places]
        if places.shape[1] == 3:
            triangles.append(around)
            continue
        middle = np.broadcast_to((count + np.arange(len(faces)))[:, None], around.shape)
        triangles.append(np.stack([around, np.roll(around, -1, axis=1), middle], axis=2).reshape(-1, 3))
        vertices.append(vertices[0][around].mean(axis=1))
        count += len(faces)
    return np.concatenate(vertices), np.concatenate(triangles)


def sum_per_cell(cell: Ints, values: Floats, cells: int) -> Floats:
    """Sum rows of `values` by the cell that each belongs to.

    Parameters
    ----------
    cell : (k,) int array
    values : (k,) or (k, components) array
    cells : int

    Returns
    -------
    (cells,) or (cells, components) array
    """
    if values.ndim == 1:
        return np.bincount(cell, values, cells).astype(np.float64)
    return np.stack([sum_per_cell(cell, column, cells) for column in values.T], axis=1)


@dataclass(frozen=True, eq=False, slots=True)
class Polyhedra:
    """Geometry of a mesh of polyhedra.

    Parameters
    ----------
    areas, centers : (faces, 3) arrays [m2], [m]
        Of the faces; an area vector points out of the owner.
    cell_centers : (cells, 3) array [m]
    volumes : (cells,) array [m3]
    """

    areas: Floats
    centers: Floats
    cell_centers: Floats
    volumes: Floats


def polyhedra(points: Floats, corners: Ints, offsets: Ints, owner: Ints, neighbour: Ints, cells: int) -> Polyhedra:
    """Volumes and centers of cells from their faces.

    Parameters
    ----------
    points : (n, 3) array [m]
    corners, offsets, owner, neighbour : int arrays
        As in `pipeline.nouns.mesh.FaceMesh`.
    cells : int

    Returns
    -------
    Polyhedra

    Notes
    -----
    OpenFOAM's `primitiveMesh::makeCellCentresAndVols`: pyramids from each face to the mean of the cell's face
    centers; the cell's center is the mean of the pyramids' centers, weighted by their volumes. Points are taken
    from the middle of the mesh, where far from the origin the terms would cancel in rounding.
    """
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    areas, centers = polygons(points - middle, corners, offsets)
    internal = len(neighbour)
    inner = slice(0, internal)
    faces_of = np.bincount(owner, minlength=cells) + np.bincount(neighbour, minlength=cells)
    estimate = sum_per_cell(owner, centers, cells) + sum_per_cell(neighbour, centers[inner], cells)
    estimate /= np.maximum(faces_of, 1)[:, None]

    volumes = np.zeros(cells)
    moments = np.zeros((cells, 3))
    for cell, sign, which in ((owner, 1.0, slice(None)), (neighbour, -1.0, inner)):
        pyramids = sign * np.einsum("fx,fx->f", areas[which], centers[which] - estimate[cell])
        middles = 0.75 * centers[which] + 0.25 * estimate[cell]
        volumes += sum_per_cell(cell, pyramids, cells)
        moments += sum_per_cell(cell, pyramids[:, None] * middles, cells)
    solid = volumes != 0
    cell_centers = np.where(solid[:, None], moments / np.where(solid, volumes, 1.0)[:, None], estimate)
    return Polyhedra(areas, centers + middle, cell_centers + middle, volumes / 3.0)
