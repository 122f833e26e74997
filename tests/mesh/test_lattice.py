"""The lattice that the fibers cut: it fills the duct, fits across its levels, and meets the true cylinders."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from pipeline.enclosure.duct import enclose
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.geometry.cylinders import away, distance, table
from pipeline.geometry.faces import tet_faces
from pipeline.geometry.fibers import FiberDistance
from pipeline.geometry.tets import boundary, volumes
from pipeline.mat.generate import generate
from pipeline.mat.settings import LayeredSettings
from pipeline.mesh.engines.lattice.lattice import lattice_mesh
from pipeline.mesh.engines.lattice.octree import Demand, Octree, octree
from pipeline.mesh.engines.lattice.tetrahedra import lattice_tetrahedra, lattice_vertices
from pipeline.mesh.fill import fill
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.wall_error import fidelity
from pipeline.nouns.arrays import Floats
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.patches import FIBERS
from pipeline.progress import silent
from pipeline.quality.judge import judge
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite

DIAMETER = 1.4e-6


def graded(counts: tuple[int, int, int], seed: int) -> Octree:
    """Cubes about a few fibers at random, in a box of small cubes with an edge of 1."""
    rng = np.random.default_rng(seed)
    start = rng.random((3, 3)) * counts
    end = start + rng.standard_normal((3, 3))
    demand = Demand(
        table(start, end, np.full(3, 0.1)), np.zeros((3, 2), bool), np.arange(3), np.array([1.0, 1.0, 2.0]),
        0.7, 4.0, 1.0,
    )  # fmt: skip
    return octree(demand, np.array(counts), np.ones(3), 0.0, np.zeros(3, bool), lambda cubes: None)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("counts", [(16, 16, 16), (9, 14, 23)])
def test_the_cubes_tetrahedra_fill_the_box_and_fit_across_levels(counts: tuple[int, int, int], seed: int) -> None:
    tree = graded(counts, seed)
    assert len(np.unique(tree.level)) == 3
    assert (8.0**tree.level).sum() == math.prod(counts)
    vertices = lattice_vertices(tree)
    places = vertices.places
    tets = lattice_tetrahedra(tree, vertices, np.ones(len(places)))
    cells = volumes(places / 2.0, tets)
    assert (cells > 0).all()
    assert cells.sum() == pytest.approx(math.prod(counts), rel=1e-12)
    # conforming: a face that belongs to one cell only lies on a plane of the box
    faces, _ = boundary(tets)
    corners = places[faces]
    planes = [(corners[:, :, k] == end).all(axis=1) for k in range(3) for end in (0, 2 * counts[k])]
    assert np.logical_or.reduce(planes).all()


@pytest.mark.parametrize("seed", range(3))
def test_neighboring_cubes_differ_by_one_level_at_the_most(seed: int) -> None:
    tree = graded((32, 32, 32), seed)
    level = np.full((32, 32, 32), -1)
    for low, of_cube in zip(tree.low, tree.level, strict=True):
        x, y, z = low
        size = 1 << of_cube
        assert (level[x : x + size, y : y + size, z : z + size] == -1).all()  # no two cubes share a place
        level[x : x + size, y : y + size, z : z + size] = of_cube
    for shift in itertools.product((0, 1), repeat=3):
        cut = tuple(slice(0, 32 - by) for by in shift)
        moved = tuple(slice(by, 32) for by in shift)
        assert np.abs(level[cut] - level[moved]).max() <= 1


def test_cubes_are_as_large_as_each_fiber_asks_for() -> None:
    tree = graded((32, 32, 32), 0)
    rng = np.random.default_rng(0)
    start = rng.random((3, 3)) * 32
    for fiber, edge in ((0, 1), (1, 1), (2, 2)):
        inside = ((start[fiber] >= tree.low) & (start[fiber] < tree.low + (1 << tree.level)[:, None])).all(axis=1)
        assert 1 << tree.level[inside][0] <= edge


def test_inside_one_level_the_mesh_is_perfectly_orthogonal() -> None:
    places = np.array(list(np.ndindex(6, 6, 6)))
    tree = Octree(np.full(3, 6), places, np.zeros(len(places), np.int64))
    vertices = lattice_vertices(tree)
    places = vertices.places
    tets = lattice_tetrahedra(tree, vertices, np.ones(len(places)))
    found = tet_faces(tets)
    centers = places[tets[found.order]].mean(axis=1)
    inner = found.triangles[: len(found.neighbour)]
    away = ((places[inner] > 2) & (places[inner] < 10)).all(axis=(1, 2))
    assert away.sum() > 100
    a, b, c = (places[inner[away, k]].astype(float) for k in range(3))
    normal = np.cross(b - a, c - a)
    line = centers[found.neighbour[away]] - centers[found.owner[: len(inner)][away]]
    np.testing.assert_allclose(np.cross(normal, line), 0.0, atol=1e-12)


def one_piece(flat: tuple[bool, bool]) -> FiberDistance:
    """A fiber of radius 0.5 from (1, 2, 2) to (3, 2, 2) in a box of 4."""
    start, end = np.array([[1.0, 2, 2]]), np.array([[3.0, 2, 2]])
    return FiberDistance.about(
        start, end, np.array([0.5]), np.array([flat]), np.zeros(1, np.int64), np.full(1, 9.0),
        np.zeros(3), np.full(3, 4.0),
    )  # fmt: skip


def test_the_distance_is_that_to_a_cylinder_and_to_its_ends() -> None:
    points = np.array([[2.0, 2, 2], [2, 3, 2], [2, 2, 2.6], [0.2, 2, 2], [3.3, 2.4, 2], [3.3, 2.9, 2.0]])
    round_ends = [-0.5, 0.5, 0.1, 0.3, 0.0, math.hypot(0.3, 0.9) - 0.5]
    np.testing.assert_allclose(one_piece((False, False)).at(points), round_ends, atol=1e-12)
    flat_ends = [-0.5, 0.5, 0.1, 0.8, 0.3, math.hypot(0.3, 0.4)]
    np.testing.assert_allclose(one_piece((True, True)).at(points), flat_ends, atol=1e-12)


@pytest.mark.parametrize("flat", list(itertools.product((False, True), repeat=2)))
def test_the_way_away_from_a_fiber_is_the_gradient_of_the_distance(flat: tuple[bool, bool]) -> None:
    # by central differences, at places at random around, within and beyond the ends of a fiber
    field = one_piece(flat)
    rng = np.random.default_rng(3)
    points = rng.random((200, 3)) * [3.0, 2.0, 2.0] + [0.5, 1.0, 1.0]
    pieces, ends = field.field[:2]
    step = 1e-6
    for point in points:
        x, y, z = point.tolist()
        found = away(x, y, z, pieces, ends, 0)
        slope = [
            (field.at((point + step * axis)[None])[0] - field.at((point - step * axis)[None])[0]) / (2 * step)
            for axis in np.eye(3)
        ]
        np.testing.assert_allclose(found, slope, atol=1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_the_nearest_of_many_fibers_is_the_nearest_of_all(seed: int) -> None:
    # bins hold what is within reach of them: against a look at every piece
    rng = np.random.default_rng(seed)
    count = 60
    start, end = rng.random((count, 3)) * 10, rng.random((count, 3)) * 10
    radius = 10.0 ** rng.uniform(-2, 0, count)
    flat = rng.random((count, 2)) < 0.5
    reach = np.full(count, 1.5)
    field = FiberDistance.about(start, end, radius, flat, np.arange(count), reach, np.zeros(3), np.full(3, 10.0))
    points = rng.random((500, 3)) * 10
    pieces = table(start, end, radius)
    exact = np.array([[distance(x, y, z, pieces, flat, k) for k in range(count)] for x, y, z in points.tolist()])
    near = exact.min(axis=1) < 1.5
    assert near.sum() > 200
    found, piece = field.with_piece(points)
    np.testing.assert_allclose(found[near], exact.min(axis=1)[near], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(piece[near], exact.argmin(axis=1)[near])


def test_points_snap_to_the_nearest_place_of_the_surface_and_stay_on_their_plane() -> None:
    field = one_piece((False, False))
    points = np.array([[2.0, 2.6, 2.3], [2.0, 2.6, 2.3]])
    moved, done = field.on_surface(points, np.array([[1.0, 1, 1], [0, 1, 0]]), np.full(2, 0.5))
    assert done.all()
    outward = np.array([0.0, 0.6, 0.3]) / math.hypot(0.6, 0.3)
    np.testing.assert_allclose(moved[0], np.array([2, 2, 2]) + 0.5 * outward, atol=1e-6)
    np.testing.assert_allclose(moved[1], [2.0, 2 + math.sqrt(0.25 - 0.09), 2.3], atol=1e-6)
    _, reached = field.on_surface(points, np.ones((2, 3)), np.full(2, 0.01))
    assert not reached.any()


def across(edge: float) -> tuple[FluidDomain, TetmeshSettings]:
    """A duct with one straight fiber from side to side, aslant."""
    nodes = np.array([[0.0, 1e-6, 5e-6], [10e-6, 8e-6, 5.5e-6]])
    slab = Box((0.0, 0.0, 4e-6), (10e-6, 10e-6, 6.5e-6))
    mat = Mat(nodes, np.array([0, 2]), np.array([0.5 * DIAMETER]), slab, -1, "by hand")
    surface = unite(mat, SurfaceSettings(sides=96, ring_spacing=0.5, smallest_edge=0.0))
    return enclose(surface, EnclosureSettings(inlet=3e-6, outlet=3e-6)), TetmeshSettings(engine="lattice", edge=edge)


def wall_distances(edge: float) -> Floats:
    """Distance of each of the lattice's vertices on the fiber from the fiber's axis, in radii."""
    domain, settings = across(edge)
    raw, _ = lattice_mesh(domain, settings, silent)
    faces, _ = boundary(raw.tets)
    on_plane = np.zeros(len(faces), dtype=bool)
    for axis in range(3):
        for place in (domain.box.lower[axis], domain.box.upper[axis]):
            on_plane |= (raw.points[faces][:, :, axis] == place).all(axis=1)
    walls = raw.points[np.unique(faces[~on_plane])]
    start, end = domain.pieces.start[0], domain.pieces.end[0]
    line = (end - start) / np.linalg.norm(end - start)
    distances: Floats = np.linalg.norm(np.cross(walls - start, line), axis=1) / (0.5 * DIAMETER)
    return distances


@pytest.mark.parametrize("edge", [0.5, 0.25])
def test_every_vertex_on_a_fiber_lies_on_the_true_cylinder(edge: float) -> None:
    np.testing.assert_allclose(wall_distances(edge), 1.0, rtol=1e-6)


def test_the_fibers_volume_is_restored_by_its_own_walls() -> None:
    # chords lie within a circle by a sagitta that goes with the square of their length: of 0.5 diameters, by some
    # percent of the area, which moving the walls onto the fiber on average gives back
    domain, settings = across(0.5)
    mesh, measures = fill(domain, settings)
    assert measures.raw_volume_error < -0.02
    assert abs(measures.volume_error) < 0.005
    solid = domain.box.volume - domain.volume
    assert mesh.volume == pytest.approx(domain.volume, abs=0.005 * solid)


def test_the_walls_distance_from_the_true_fibers_is_measured() -> None:
    domain, settings = across(0.5)
    mesh, measures = fill(domain, settings)
    found = measures.fidelity
    assert found is not None
    assert found == fidelity(mesh, domain)
    (walls,) = found.fibers
    assert abs(walls.radius_error) < 0.01  # the walls stand on the fiber on average
    assert walls.in_air == 0.0
    assert 0 < found.mean_deviation < found.typical_deviation < found.largest_deviation < 0.1
    # fibers that are thicker by a tenth leave the same walls inside by a tenth
    thick = replace(domain, radius=1.1 * domain.radius)
    error = (1.0 + walls.radius_error) / 1.1 - 1.0
    assert fidelity(mesh, thick).fibers[0].radius_error == pytest.approx(error, abs=1e-3)


def test_walls_farther_off_than_allowed_are_refused_with_what_to_do() -> None:
    domain, _ = across(0.5)
    with pytest.raises(StageError, match=r"fiber 0 of 1 \(d 1.4 um\): a hundredth of its walls.*; lower tetmesh.edge"):
        fill(domain, TetmeshSettings(engine="lattice", edge=0.5, deviation=0.001))


def test_one_case_gives_one_mesh() -> None:
    domain, settings = across(0.6)
    (one, _), (two, _) = fill(domain, settings), fill(domain, settings)
    np.testing.assert_array_equal(one.points, two.points)
    np.testing.assert_array_equal(one.corners, two.corners)


@pytest.mark.parametrize("contact", ["paper", "clear"])
@pytest.mark.parametrize("seed", range(3))
def test_random_mats_keep_every_limit(contact: str, seed: int) -> None:
    settings = LayeredSettings.model_validate(
        {
            "generator": "layered", "side": "8 um", "fiber_diameter": "1.4 um", "relaxation_slope": 0.15,
            "contact": contact, "seed": seed, "stop": {"coverage": 1.0},
        }
    )  # fmt: skip
    surface = unite(generate(settings), SurfaceSettings())
    domain = enclose(surface, EnclosureSettings(inlet=4e-6, outlet=4e-6))
    mesh, measures = fill(domain, TetmeshSettings(engine="lattice", edge=0.7))
    report = judge(mesh)
    assert report.passed, report.reasons
    assert measures.faulty_cells == 0
    assert abs(measures.volume_error) < 0.02
    # air that was given to the fibers in crevices
    assert measures.filled_volume < 1e-3
    areas = np.linalg.norm(mesh.polyhedra().areas, axis=1)
    assert areas[mesh.patch("inlet")].sum() == pytest.approx(domain.box.face_area, rel=1e-12)
    assert areas[mesh.patch(FIBERS)].sum() > 0


def test_a_lattice_beyond_memory_is_refused_with_what_to_do() -> None:
    domain, _ = across(0.6)
    with pytest.raises(StageError, match=r"cells and take .* tetmesh.memory_limit allows .* raise tetmesh.edge"):
        fill(domain, TetmeshSettings(engine="lattice", edge=0.6, memory_limit=1e5))
