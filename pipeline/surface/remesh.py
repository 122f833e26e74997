"""What MeshLab thinks of a surface; the only import of pymeshlab."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

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
