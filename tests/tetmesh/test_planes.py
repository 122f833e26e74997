"""A mesh whose planes have dents is refused: fTetWild can leave triangles of its input out."""

import numpy as np
import pytest

from pipeline.data import FIBERS, PATCHES, Floats, FluidDomain, Ints, TetMesh
from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.geometry.tets import boundary
from pipeline.tetmesh.mesh import _check_planes
from pipeline.tetmesh.patches import assign
from tests.tetmesh.boxes import kuhn_box

UNIT = Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


def hollow_box() -> tuple[Floats, Ints]:
    """Split the unit cube into 5^3 cubes of tetrahedra, and leave the one in the middle out as the fiber."""
    points, tets = kuhn_box(5)
    inside = (np.abs(points[tets].mean(axis=1) - 0.5) < 0.1).all(axis=1)
    return points, tets[~inside]


def mesh_of(points: Floats, tets: Ints) -> TetMesh:
    faces, _ = boundary(tets)
    return TetMesh(points, tets, faces, assign(points, faces, UNIT, 0.0), PATCHES, UNIT)


def domain_of(mesh: TetMesh) -> FluidDomain:
    fiber = np.where(mesh.patch == PATCHES.index(FIBERS), 0, -1)
    return FluidDomain(mesh.points, mesh.faces, mesh.patch, PATCHES, fiber, np.array([0.1]), UNIT, UNIT)


def test_whole_planes_pass() -> None:
    mesh = mesh_of(*hollow_box())
    _check_planes(mesh, domain_of(mesh), passes=2)


@pytest.mark.parametrize(("axis", "name"), [(0, "xmin"), (1, "ymin"), (2, "inlet")])
def test_a_dent_in_a_plane_is_refused_and_the_plane_named(axis: int, name: str) -> None:
    points, tets = hollow_box()
    whole = domain_of(mesh_of(points, tets))
    # a cell whose face is 1/50 of the plane: within 1 % it would pass
    on_plane = (points[:, axis] == 0.0)[tets].sum(axis=1) == 3
    dented = np.delete(tets, np.flatnonzero(on_plane)[0], axis=0)
    with pytest.raises(StageError, match=rf"patch {name}, whose area is off by -2\.00%.*raise tetmesh\.passes"):
        _check_planes(mesh_of(points, dented), whole, passes=2)
