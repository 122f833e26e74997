"""A mesh whose planes have dents is found out: fTetWild can leave triangles of its input out."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.box import Box
from pipeline.geometry.tets import boundary
from pipeline.mesh.boundary import assign, blunted_edges, flattened, planes
from pipeline.mesh.engines.flawed import FlawedMeshError
from pipeline.mesh.engines.ftetwild.ftetwild import _plane_errors, lost_part
from pipeline.mesh.improve.finish import _check_patches
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.patches import FIBERS, PATCHES
from tests.mesh.boxes import kuhn_box
from tests.mesh.meshes import working
from tests.sample_meshes import NO_PIECES, TetMesh

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
    return FluidDomain(mesh.points, mesh.faces, mesh.patch, PATCHES, fiber, np.array([0.1]), UNIT, UNIT, NO_PIECES)


def test_whole_planes_have_no_error() -> None:
    points, tets = hollow_box()
    errors = _plane_errors(points, tets, domain_of(mesh_of(points, tets)))
    assert list(errors) == list(PATCHES[:-1])
    assert list(errors.values()) == pytest.approx([0.0] * 6, abs=1e-14)


@pytest.mark.parametrize(("axis", "name"), [(0, "xmin"), (1, "ymin"), (2, "inlet")])
def test_a_dent_is_missing_from_its_plane(axis: int, name: str) -> None:
    points, tets = hollow_box()
    whole = domain_of(mesh_of(points, tets))
    # each of the plane's 5 x 5 squares is the face of two cells
    on_plane = ((points[:, axis] == 0.0)[tets].sum(axis=1) == 3) & ~(points[tets] > 0.9).any(axis=(1, 2))
    inner = np.flatnonzero(on_plane & (np.delete(points[tets].mean(axis=1), axis, axis=1) > 0.2).all(axis=1))
    errors = _plane_errors(points, np.delete(tets, inner[0], axis=0), whole)
    assert errors.pop(name) == pytest.approx(-1 / 50)
    assert list(errors.values()) == pytest.approx([0.0] * 5, abs=1e-14)
    found = lost_part(points, np.delete(tets, inner[0], axis=0), whole)
    assert found is not None
    assert found[0] == name
    assert found[1] == pytest.approx(-1 / 50)
    assert lost_part(points, tets, whole) is None


def test_sharp_air_that_is_filled_beside_a_fiber_is_no_dent() -> None:
    points, tets = hollow_box()
    middle = points[tets].mean(axis=1)
    # the fiber reaches from the cube's middle down to the inlet, less the cell of air at its foot
    reaching = tets[~((np.abs(middle[:, :2] - 0.5) < 0.1).all(axis=1) & (middle[:, 2] < 0.5))]
    whole = domain_of(mesh_of(points, reaching))
    center = points[reaching].mean(axis=1)
    beside = ((points[:, 2] == 0.0)[reaching].sum(axis=1) == 3) & (np.abs(center[:, :2] - 0.5) < 0.3).all(axis=1)
    filled = reaching[np.arange(len(reaching)) != np.flatnonzero(beside)[0]]
    assert _plane_errors(points, filled, whole)["inlet"] == pytest.approx(-1 / 48)
    assert lost_part(points, filled, whole) is None


def test_a_way_that_the_mesh_closes_says_what_keeps_it_open() -> None:
    # square arrays of solidity 0.75 and more: gaps between fibers narrower than fTetWild's envelope
    points, tets = hollow_box()
    whole = domain_of(mesh_of(points, tets))
    closed = tets[(points[tets][:, :, 2] > 0.0).all(axis=1)]
    said = r"reaches inlet, though .* lower tetmesh\.tetwild\.envelope .* raise surface\.sides"
    with pytest.raises(FlawedMeshError, match=said):
        _check_patches(working(points, closed), whole, TetmeshSettings())


@pytest.mark.parametrize("seed", range(4))
def test_faces_across_an_edge_of_the_duct_belong_to_one_of_its_planes(seed: int) -> None:
    # triangles in a tube about a random edge of the duct: all go to one plane, and what lies on the other ends on the
    # edge; triangles elsewhere, however near to one plane, cut off no edge
    rng = np.random.default_rng(seed)
    box, within = Box((-1.0, 0.0, 2.0), (1.0, 3.0, 7.0)), 0.05
    pairs = [(one, other) for one in planes(box) for other in planes(box) if one.axis != other.axis]
    first, second = pairs[rng.integers(len(pairs))]
    along = 3 - first.axis - second.axis
    points = rng.uniform(np.array(box.lower) + 0.3, np.array(box.upper) - 0.3, (60, 3))
    for plane in (first, second):
        points[:30, plane.axis] = plane.value - plane.sign * rng.uniform(0.0, within, 30)
    points[30:, first.axis] = first.value - first.sign * rng.uniform(0.0, within, 30)
    faces = np.arange(60).reshape(20, 3)
    found = blunted_edges(points, faces, box, within)
    assert set(found[:10].tolist()) <= {first.patch, second.patch}
    assert len(set(found[:10].tolist())) == 1
    assert (found[10:] == -1).all()
    flat = flattened(points, faces[:10], found[:10], box)[:30]
    kept = next(plane for plane in (first, second) if plane.patch == found[0])
    assert (flat[:, kept.axis] == kept.value).all()
    np.testing.assert_array_equal(flat[:, along], points[:30, along])
