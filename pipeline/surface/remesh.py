"""What MeshLab thinks of a surface; the only import of pymeshlab."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.triangles import connected_pieces, signed_volumes
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.surface import Surface


@dataclass(frozen=True, slots=True)
class MeshLabCheck:
    """Counts by another program's eyes; all but `components` are 0 and the genus whole for a sound surface.

    Parameters
    ----------
    self_intersecting : int
        Triangles that cut another one.
    boundary_edges : int
        Edges with one triangle.
    non_manifold_edges : int
        Edges with more than two triangles.
    non_manifold_vertices : int
        Points where two fans of triangles meet.
    components : int
        Parts that share no edge.
    """

    self_intersecting: int
    boundary_edges: int
    non_manifold_edges: int
    non_manifold_vertices: int
    components: int


def check_with_meshlab(surface: Surface) -> MeshLabCheck:
    """Let MeshLab look for self-intersections and places that are no manifold.

    Parameters
    ----------
    surface : Surface

    Returns
    -------
    MeshLabCheck

    Notes
    -----
    A union is exact but for rounding, 1e-12 of its size: triangles with less height than that may count as cut.
    """
    import pymeshlab

    # MeshLab's tolerances are absolute: work at fibers of size one
    middle = 0.5 * (surface.points.min(axis=0) + surface.points.max(axis=0))
    scaled = (surface.points - middle) / (2.0 * float(surface.radius.mean()))
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(scaled, surface.triangles.astype(np.int32)))
    topology = meshes.get_topological_measures()
    meshes.compute_selection_by_self_intersections_per_face()
    return MeshLabCheck(
        self_intersecting=int(meshes.current_mesh().selected_face_number()),
        boundary_edges=int(topology["boundary_edges"]),
        non_manifold_edges=int(topology["non_two_manifold_edges"]),
        non_manifold_vertices=int(topology["non_two_manifold_vertices"]),
        components=int(topology["connected_components_number"]),
    )


@dataclass(frozen=True, eq=False, slots=True)
class Mended:
    """A surface after mending.

    Parameters
    ----------
    points : (n, 3) array
    triangles : (m, 3) int array
        Outward, where it is closed.
    done : str
        What was done, in words; empty where nothing was.
    open_places : (k, 3) array
        Points on edges that are still open.
    largest_hole : int
        Edges of the largest hole that is closed.
    """

    points: Floats
    triangles: Ints
    done: str
    open_places: Floats
    largest_hole: int


_LARGEST_HOLE = 12
"""Edges around a hole that is closed: a missing triangle or a missing vertex with all its triangles."""


def mended(points: Floats, triangles: Ints) -> Mended:
    """Let MeshLab mend what can be mended without guessing a shape.

    Points that are there several times become one, triangles that are there twice or have no area go, what hangs on
    edges of three triangles is taken off, small holes are closed, and all triangles are turned outward.

    Parameters
    ----------
    points : (n, 3) array
    triangles : (m, 3) int array

    Returns
    -------
    Mended
    """
    import pymeshlab

    # MeshLab's tolerances are absolute: work at size one
    low, size = points.min(axis=0), float(np.ptp(points, axis=0).max()) or 1.0
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh((points - low) / size, triangles.astype(np.int32)))
    done = []

    def count() -> tuple[int, int]:
        mesh = meshes.current_mesh()
        return mesh.vertex_number(), mesh.face_number()

    def told(what: str, before: int, after: int) -> None:
        if before != after:
            done.append(f"{abs(before - after)} {what}")

    meshes.meshing_merge_close_vertices(threshold=pymeshlab.PureValue(1e-7))
    meshes.meshing_remove_null_faces()
    before = count()
    meshes.meshing_remove_duplicate_faces()
    told("triangles there twice taken out", before[1], count()[1])
    before = count()
    meshes.meshing_repair_non_manifold_edges()
    meshes.meshing_repair_non_manifold_vertices()
    told("triangles on edges of three taken off", before[1], count()[1])
    meshes.meshing_remove_unreferenced_vertices()
    before = count()
    if meshes.get_topological_measures()["boundary_edges"]:
        meshes.meshing_close_holes(maxholesize=_LARGEST_HOLE, newfaceselected=False)
    told("triangles put into holes", before[1], count()[1])
    oriented = meshes.current_mesh().face_matrix().copy()
    meshes.meshing_re_orient_faces_coherently()
    mesh = meshes.current_mesh()
    vertices = np.asarray(mesh.vertex_matrix(), np.float64)
    faces = _outward(vertices, np.asarray(mesh.face_matrix(), np.int64))
    turned = int((_rolled(faces) != _rolled(np.asarray(oriented, np.int64))).any(axis=1).sum())
    if turned:
        done.append(f"{turned} triangles turned over")
    return Mended(
        vertices * size + low, faces, ", ".join(done), _open_places(vertices, faces) * size + low, _LARGEST_HOLE
    )


def _rolled(triangles: Ints) -> Ints:
    """Give each triangle from its lowest corner on."""
    first = triangles.argmin(axis=1)[:, None]
    return np.take_along_axis(triangles, (first + np.arange(3)) % 3, axis=1)


def _outward(points: Floats, triangles: Ints) -> Ints:
    """Turn the shells that are inside out, but for those within another one, which bound voids."""
    piece = connected_pieces(triangles)
    count = int(piece.max()) + 1
    volume = np.bincount(piece, weights=signed_volumes(points, triangles), minlength=count)
    # voids in the solid are closed to the air: they count as solid, as in the union of fibers
    turn = volume[piece] < 0
    return np.where(turn[:, None], triangles[:, ::-1], triangles)


def _open_places(points: Floats, triangles: Ints) -> Floats:
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    edge = np.sort(np.column_stack([start, end]), axis=1)
    _, first, times = np.unique(edge, axis=0, return_index=True, return_counts=True)
    places: Floats = points[start[first[times != 2]]]
    return places
