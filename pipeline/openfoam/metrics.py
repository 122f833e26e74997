"""Mesh quality by OpenFOAM's own definitions, one function each, on meshes of any polyhedra.

Source of all: OpenFOAM v1912, `primitiveMeshTools` and `polyMeshTools`. S is a face's area vector, f its center,
C and N the centers of its owner and neighbour, d = N - C, V a cell's volume. Each takes a mesh and its geometry.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.polyhedra import Polyhedra, by_size, sum_per_cell
from pipeline.nouns.arrays import Bools, Floats
from pipeline.nouns.mesh import FaceMesh

TINY = 1e-150
"""Keeps a quotient of nothing by nothing at 0, as OpenFOAM's ROOTVSMALL."""


def _dot(a: Floats, b: Floats) -> Floats:
    product: Floats = np.einsum("ij,ij->i", a, b)
    return product


def _length(vectors: Floats) -> Floats:
    return np.sqrt(_dot(vectors, vectors))


def _between(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    return shape.cell_centers[mesh.neighbour] - shape.cell_centers[mesh.owner[: mesh.internal]]


def non_orthogonality(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Angle between S and d, (internal,) array [degree]."""
    between, areas = _between(mesh, shape), shape.areas[: mesh.internal]
    cosine = _dot(between, areas) / (_length(between) * _length(areas) + TINY)
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def skewness(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Offset of f from where d pierces the face, over the face's extent that way, (faces,) array [1].

    The offset is ``s = (f - C) - (S.(f - C)) / (S.d) d``, the extent ``max(0.2 |d|, |s.(p - f)| / |s|)`` over the
    corners p. On the boundary d is the part of f - C along S, and 0.4 stands for 0.2.
    """
    n = mesh.internal
    to_face = shape.centers - shape.cell_centers[mesh.owner]
    normal = shape.areas[n:] / (_length(shape.areas[n:]) + TINY)[:, None]
    to_plane = normal * _dot(normal, to_face[n:])[:, None]
    between = np.concatenate([_between(mesh, shape), to_plane])
    reach = _dot(shape.areas, to_face) / (_dot(shape.areas, between) + TINY)
    offset = to_face - reach[:, None] * between
    size = _length(offset)
    along = offset / (size + TINY)[:, None]
    extent = np.where(np.arange(mesh.faces) < n, 0.2, 0.4) * _length(between) + TINY
    for faces, places in by_size(mesh.offsets):
        for corner in mesh.corners[places].T:
            spread = np.abs(_dot(along[faces], mesh.points[corner] - shape.centers[faces]))
            extent[faces] = np.maximum(extent[faces], spread)
    return size / extent


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
    _, total = _sums_of_areas(mesh, shape)
    lively = directions(mesh, shape)
    if not lively.all():
        own = total[:, lively] if lively.any() else np.ones((mesh.cells, 1))
        flat: Floats = own.max(axis=1) / (own.min(axis=1) + TINY)
        return flat
    sides = total.max(axis=1) / (total.min(axis=1) + TINY)
    surface: Floats = total.sum(axis=1) / 6.0 / np.cbrt(np.maximum(shape.volumes, TINY)) ** 2
    ratio: Floats = np.maximum(sides, surface)
    return ratio


def openness(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Largest component of the sum of S over that of abs(S), 0 for a closed cell, (cells,) array [1]."""
    vector, total = _sums_of_areas(mesh, shape)
    largest: Floats = (np.abs(vector) / (total + TINY)).max(axis=1)
    return largest


def _sums_of_areas(mesh: FaceMesh, shape: Polyhedra) -> tuple[Floats, Floats]:
    inner = shape.areas[: mesh.internal]
    vector = sum_per_cell(mesh.owner, shape.areas, mesh.cells) - sum_per_cell(mesh.neighbour, inner, mesh.cells)
    total = sum_per_cell(mesh.owner, np.abs(shape.areas), mesh.cells)
    return vector, total + sum_per_cell(mesh.neighbour, np.abs(inner), mesh.cells)


def determinant(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Give ``det(sum(S S) / (mean of |S|)^2) / 8`` over a cell's internal faces, (cells,) array [1].

    1 for a cube among cubes; 0 where all internal faces lie in two directions, so that no gradient is known. A flat
    mesh has 1 in the sum's place for the direction that it lacks, and a mesh along a line has 1.
    """
    lively = directions(mesh, shape)
    if lively.sum() < 2:
        return np.ones(mesh.cells)
    n = mesh.internal
    inner = shape.areas[:n]
    size = _length(inner)
    upper = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    sums = np.zeros((mesh.cells, 8))
    for cell in (mesh.owner[:n], mesh.neighbour):
        columns = [inner[:, i] * inner[:, j] for i, j in upper]
        for k, column in enumerate([*columns, size, np.ones(n)]):
            sums[:, k] += np.bincount(cell, column, mesh.cells)
    mean = sums[:, 6] / np.maximum(sums[:, 7], 1.0)
    xx, xy, xz, yy, yz, zz = sums[:, :6].T / (mean**2 + TINY)
    if not lively.all():
        (xx, yy, zz)[int(np.flatnonzero(~lively)[0])][sums[:, 7] > 0] = 1.0
    result: Floats = np.abs(xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)) / 8.0
    return result


def face_weight(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Distance of the nearer cell's center from the face over the sum of both, (internal,) array [1]."""
    n = mesh.internal
    own = np.abs(_dot(shape.areas[:n], shape.centers[:n] - shape.cell_centers[mesh.owner[:n]]))
    other = np.abs(_dot(shape.areas[:n], shape.cell_centers[mesh.neighbour] - shape.centers[:n]))
    return np.minimum(own, other) / (own + other + TINY)


def volume_ratio(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Smaller over larger volume of the two cells of a face, (internal,) array [1]."""
    own, other = np.abs(shape.volumes[mesh.owner[: mesh.internal]]), np.abs(shape.volumes[mesh.neighbour])
    return np.minimum(own, other) / (np.maximum(own, other) + TINY)


def volume(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Volume, (cells,) array [m3]."""
    return shape.volumes


def face_area(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Area, (faces,) array [m2]."""
    return _length(shape.areas)


def face_pyramid(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Smaller volume of the pyramids from a face to its cells' centers, over V, (faces,) array [1].

    Below 0 the cell is folded there. `checkMesh` compares it with -1e-15 m3, which is larger than a whole cell of a
    mesh in micrometers: relative to the cell nothing slips through. A tetrahedron has 1/4.
    """
    n = mesh.internal
    share = _dot(shape.areas, shape.centers - shape.cell_centers[mesh.owner])
    share /= 3.0 * (np.abs(shape.volumes[mesh.owner]) + TINY)
    other = _dot(shape.areas[:n], shape.cell_centers[mesh.neighbour] - shape.centers[:n])
    share[:n] = np.minimum(share[:n], other / (3.0 * (np.abs(shape.volumes[mesh.neighbour]) + TINY)))
    return share


def concavity(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Largest cosine between a face's normal and the way from its center to another face's, (cells,) array [1].

    Above 0 the cell is concave there, 0 is a side that is cut in two; `checkMesh -allGeometry` calls concave what is
    above -1e-6.
    """
    from pipeline.openfoam.decomposition import largest_cosines

    cell = np.concatenate([mesh.owner, mesh.neighbour])
    face = np.concatenate([np.arange(mesh.faces), np.arange(mesh.internal)])
    sign = np.where(np.arange(len(cell)) < mesh.faces, 1.0, -1.0)
    order = np.argsort(cell, kind="stable")
    first = np.concatenate([[0], np.cumsum(np.bincount(cell, minlength=mesh.cells))])
    return largest_cosines(first, face[order], sign[order], shape.areas, shape.centers)


def face_tets(mesh: FaceMesh, shape: Polyhedra) -> Floats:
    """Smallest of the tetrahedra that OpenFOAM cuts the cells into at a face, over the cell, (faces,) array [1].

    Particles are tracked and fields interpolated through these; not above 0 one is turned inside out or flat
    (`polyMeshTetDecomposition::checkFaceTets`).
    """
    from pipeline.openfoam.decomposition import smallest_tets

    return smallest_tets(
        mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, shape.centers, shape.cell_centers,
        shape.volumes,
    )  # fmt: skip
