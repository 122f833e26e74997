"""Areas, centers and volumes of polygons and of the polyhedra between them, as OpenFOAM computes them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from pipeline.geometry.tets import Cells
from pipeline.geometry.threads import in_parts
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
    # numba takes half a second to load
    from pipeline.geometry.compiled import read_only
    from pipeline.geometry.pyramids import measure_polygons

    count = len(offsets) - 1
    areas, centers = np.empty((count, 3)), np.empty((count, 3))
    vertices, numbers, places = read_only(points), read_only(corners), read_only(offsets)
    in_parts(lambda begin, end: measure_polygons(vertices, numbers, places, areas, centers, begin, end), count)
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


@dataclass(frozen=True, eq=False, slots=True)
class Polyhedra:
    """Geometry of a mesh of polyhedra.

    Parameters
    ----------
    areas, centers : (faces, 3) arrays [m2], [m]
        Of the faces; an area vector points out of the owner.
    cell_centers : (cells, 3) array [m]
    volumes : (cells,) array [m3]
    first : (cells + 1,) int array
    faces : (faces + internal,) int array
        Cell c has ``faces[first[c]:first[c + 1]]``: f where it owns face f, and then ``-1 - f`` where it is the
        neighbour.
    """

    areas: Floats
    centers: Floats
    cell_centers: Floats
    volumes: Floats
    first: Ints
    faces: Cells


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
    from pipeline.geometry.compiled import read_only
    from pipeline.geometry.pyramids import faces_of_cells, measure_cells

    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    areas, centers = polygons(points - middle, corners, offsets)
    first, faces = faces_of_cells(read_only(owner), read_only(neighbour), cells)
    cell_centers, volumes = np.empty((cells, 3)), np.empty(cells)
    in_parts(lambda begin, end: measure_cells(first, faces, areas, centers, cell_centers, volumes, begin, end), cells)
    centers += middle
    cell_centers += middle
    return Polyhedra(areas, centers, cell_centers, volumes, first, faces)
