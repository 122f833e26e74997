"""Mesh quality by OpenFOAM's own definitions, one function each, on meshes of any polyhedra.

Source of all: OpenFOAM v1912, `primitiveMeshTools` and `polyMeshTools`. S is a face's area vector, f its center,
C and N the centers of its owner and neighbour, d = N - C, V a cell's volume. Each takes a mesh and its geometry; their
loops, in `pipeline.openfoam.metric_loops`, run on all cores and hold one number for each face or cell.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from pipeline.geometry.polyhedra import Polyhedra
from pipeline.geometry.threads import in_parts
from pipeline.nouns.arrays import Bools, Floats
from pipeline.nouns.mesh import CYCLIC, FaceMesh

if TYPE_CHECKING:
    from pipeline.openfoam.metric_loops import Measured

TINY = 1e-150
"""Keeps a quotient of nothing by nothing at 0, as OpenFOAM's ROOTVSMALL."""


def _filled(
    loop: "Callable[[Measured, Floats, int, int], None]", mesh: FaceMesh, shape: Polyhedra, count: int
) -> Floats:
    # numba takes half a second to load
    from pipeline.geometry.compiled import read_only
    from pipeline.openfoam.metric_loops import Measured

    measured = Measured(
        mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, read_only(shape.areas),
        read_only(shape.centers), read_only(shape.cell_centers), read_only(shape.volumes), read_only(shape.first),
        read_only(shape.faces), read_only(directions(mesh, shape)), read_only(_inner(mesh)),
    )  # fmt: skip
    found = np.empty(count)
    in_parts(lambda begin, end: loop(measured, found, begin, end), count)
    return found


def _inner(mesh: FaceMesh) -> Bools:
    found = np.zeros(mesh.faces, np.bool_)
    found[: mesh.internal] = True
    for patch in mesh.patches:
        if patch.kind == CYCLIC:
            found[patch.start : patch.start + patch.count] = True
    return found


def non_orthogonality(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Angle between S and d, (internal,) array [degree]."""
    from pipeline.openfoam.metric_loops import non_orthogonality as loop

    return _filled(loop, mesh, shape, mesh.internal)


def skewness(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Offset of f from where d pierces the face, over the face's extent that way, (faces,) array [1].

    The offset is ``s = (f - C) - (S.(f - C)) / (S.d) d``, the extent ``max(0.2 |d|, |s.(p - f)| / |s|)`` over the
    corners p. On the boundary d is the part of f - C along S, and 0.4 stands for 0.2.
    """
    from pipeline.openfoam.metric_loops import skewness as loop

    return _filled(loop, mesh, shape, mesh.faces)


def directions(mesh: FaceMesh, shape: Polyhedra) -> Bools:
    """Tell in which of x, y and z the mesh has more than one layer of cells, (3,) array.

    A patch of OpenFOAM's kind ``empty`` or ``wedge`` says that it has not: `polyMesh::calcDirections`.
    """
    flat = np.zeros(3)
    for patch in mesh.patches:
        areas = shape.areas[patch.start : patch.start + patch.count]
        if patch.kind == "empty":
            flat += np.abs(areas).sum(axis=0) / max(float(np.abs(areas).sum()), TINY)
        elif patch.kind == "wedge" and len(areas):
            # the plane in the middle of two wedges is normal to an axis; a wedge leans by a few degrees from it
            normal = np.abs(areas.sum(axis=0)) / max(float(np.linalg.norm(areas.sum(axis=0))), TINY)
            flat += np.maximum(normal, 0.5) - 0.5
    return flat <= 1e-6


def aspect_ratio(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Larger of a_max / a_min and (a_x + a_y + a_z) / (6 V^(2/3)), a = sum of abs(S), (cells,) array [1].

    Of a flat mesh, a_max / a_min in its own directions.
    """
    from pipeline.openfoam.metric_loops import aspect_ratio as loop

    return _filled(loop, mesh, shape, mesh.cells)


def openness(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Largest component of the sum of S over that of abs(S), 0 for a closed cell, (cells,) array [1]."""
    from pipeline.openfoam.metric_loops import openness as loop

    return _filled(loop, mesh, shape, mesh.cells)


def determinant(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Give ``det(sum(S S) / (mean of |S|)^2) / 8`` over a cell's internal faces, (cells,) array [1].

    1 for a cube among cubes; 0 where all internal faces lie in two directions, so that no gradient is known. A face of
    a cyclic patch counts as internal, as it does for OpenFOAM. A flat mesh has 1 in the sum's place for the direction
    that it lacks, and a mesh along a line has 1.
    """
    if directions(mesh, shape).sum() < 2:
        return np.ones(mesh.cells)
    from pipeline.openfoam.metric_loops import determinant as loop

    return _filled(loop, mesh, shape, mesh.cells)


def face_weight(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Distance of the nearer cell's center from the face over the sum of both, (internal,) array [1]."""
    from pipeline.openfoam.metric_loops import face_weight as loop

    return _filled(loop, mesh, shape, mesh.internal)


def volume_ratio(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Smaller over larger volume of the two cells of a face, (internal,) array [1]."""
    from pipeline.openfoam.metric_loops import volume_ratio as loop

    return _filled(loop, mesh, shape, mesh.internal)


def volume(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Volume, (cells,) array [m3]."""
    return shape.volumes.copy()


def face_area(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Area, (faces,) array [m2]."""
    from pipeline.openfoam.metric_loops import face_area as loop

    return _filled(loop, mesh, shape, mesh.faces)


def face_pyramid(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Smaller volume of the pyramids from a face to its cells' centers, over V, (faces,) array [1].

    Below 0 the cell is folded there. `checkMesh` compares it with -1e-15 m3, which is larger than a whole cell of a
    mesh in micrometers: relative to the cell nothing slips through. A tetrahedron has 1/4.
    """
    from pipeline.openfoam.metric_loops import face_pyramid as loop

    return _filled(loop, mesh, shape, mesh.faces)


def concavity(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Largest cosine between a face's normal and the way from its center to another face's, (cells,) array [1].

    Above 0 the cell is concave there, 0 is a side that is cut in two; `checkMesh -allGeometry` calls concave what is
    above -1e-6.
    """
    from pipeline.openfoam.metric_loops import concavity as loop

    return _filled(loop, mesh, shape, mesh.cells)


def face_tets(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Smallest of the tetrahedra that OpenFOAM cuts the cells into at a face, over the cell, (faces,) array [1].

    Particles are tracked and fields interpolated through these; not above 0 one is turned inside out or flat
    (`polyMeshTetDecomposition::checkFaceTets`).
    """
    from pipeline.openfoam.metric_loops import face_tets as loop

    return _filled(loop, mesh, shape, mesh.faces)
