# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt
import pytest

from pipeline.geometry.adjacency import largest_part_of, neighbors
from pipeline.geometry.box import Box
from pipeline.geometry.tets import boundary, volumes
from pipeline.mesh.improve.crevices import at_walls, beside_fibers, in_crevice
from pipeline.mesh.improve.smooth import smoothed
from pipeline.mesh.improve.split import split_corners, split_longest
from pipeline.mesh.improve.walls import on_fibers
from pipeline.mesh.working_mesh import WorkingMesh
from pipeline.nouns.arrays import Floats, Ints
from tests.mesh.boxes import kuhn_box
from tests.mesh.meshes import freedom, working

NONE = np.empty(0, np.int64)
WIDE = Box((-9.0, -9.0, -9.0), (9.0, 9.0, 9.0))


def shaken(points: Floats, free: npt.NDArray[np.bool_], by: float, seed: int) -> Floats:
    moved = points.copy()
    rng = np.random.default_rng(seed)
    moved[free] += by * rng.standard_normal((int(free.sum()), 3))
    return moved


def inside(points: Floats) -> npt.NDArray[np.bool_]:
    return np.asarray(((points > 0) & (points < 1)).all(axis=1))


def split(points: Floats, tets: Ints) -> tuple[Floats, Ints]:
    mesh = split_corners(working(points, tets))
    return mesh.points, mesh.tets.astype(np.int64)


@pytest.mark.parametrize("seed", range(5))
def test_inverted_cells_are_turned_right_and_the_boundary_stays(seed: int) -> None:
    points, tets = kuhn_box(4)
    bad = shaken(points, inside(points), 0.12, seed)
    assert (volumes(bad, tets) <= 0).any()  # or there would be nothing to mend
    # a hair within its duct, so that its whole boundary is a wall, which may not move
    mesh, faulty = smoothed(working(bad, tets, freedom(0.0, box=Box((-1e-9,) * 3, (1 + 1e-9,) * 3))), NONE, 60)
    good = mesh.points
    assert (volumes(good, tets) > 0).all()
    assert faulty.sum() < 0.02 * len(tets)
    np.testing.assert_array_equal(good[~inside(points)], points[~inside(points)])
    assert volumes(good, tets).sum() == pytest.approx(1.0, rel=1e-12)


def test_a_good_mesh_is_left_alone() -> None:
    points, tets = kuhn_box(3)
    mesh = working(*split(points, tets))
    same, faulty = smoothed(mesh, NONE, 5)
    np.testing.assert_array_equal(same.points, mesh.points)
    assert not faulty.any()


def test_no_vertex_of_a_wall_moves_farther_than_it_may() -> None:
    # a wall far from the fiber, whose diameter is 1
    points, tets = kuhn_box(4)
    bad = shaken(points, np.ones(len(points), bool), 0.1, 1)
    mesh, _ = smoothed(working(bad, tets, freedom(0.01, box=WIDE)), NONE, 10)
    distance = np.linalg.norm(mesh.points - bad, axis=1)
    assert 0 < distance[~inside(points)].max() <= 0.01 * (1 + 1e-12)
    assert distance[inside(points)].max() > 0.01


def test_a_vertex_moves_the_same_whatever_moves_far_from_it() -> None:
    # two cubes far apart in one mesh: each of them as it is alone
    points, tets = kuhn_box(4)
    wide = freedom(0.01, box=WIDE)
    one, other = (shaken(points, inside(points), 0.12, seed) for seed in (1, 2))
    both = working(np.concatenate([one, other + 4.0]), np.concatenate([tets, tets + len(points)]), wide)
    moved = smoothed(both, NONE)[0].points
    assert (moved[: len(points)] != one).any()
    np.testing.assert_array_equal(moved[: len(points)], smoothed(working(one, tets, wide), NONE)[0].points)


def test_splitting_leaves_one_boundary_face_per_cell_and_the_same_space() -> None:
    points, tets = kuhn_box(2)
    assert np.bincount(boundary(tets)[1]).max() > 1
    more_points, more_tets = split(points, tets)
    assert np.bincount(boundary(more_tets)[1]).max() == 1
    assert (volumes(more_points, more_tets) > 0).all()
    assert volumes(more_points, more_tets).sum() == pytest.approx(1.0, rel=1e-14)
    # conforming: every face belongs to one cell on the boundary or to two inside
    faces = np.sort(more_tets[:, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]].reshape(-1, 3), axis=1)
    _, repeats = np.unique(faces, axis=0, return_counts=True)
    assert set(repeats.tolist()) == {1, 2}


def test_a_single_tetrahedron_is_split_until_each_part_has_one_boundary_face() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    more_points, more_tets = split(points, np.array([[0, 1, 2, 3]]))
    assert len(more_tets) == 4
    assert volumes(more_points, more_tets).sum() == pytest.approx(1 / 6)


def under_a_fiber(place: float, above: float = 0.0) -> WorkingMesh:
    """The unit cube in a duct that is so much higher, so that its top is a wall; the fiber lies above z = place."""
    return working(*kuhn_box(4), freedom(0.0, place, Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0 + above))))


def test_walls_move_onto_their_fiber_and_not_across_the_planes() -> None:
    mesh = under_a_fiber(1.02, above=0.1)
    moved = on_fibers(mesh).points
    assert volumes(moved, mesh.tets).sum() == pytest.approx(1.02, rel=1e-3)
    np.testing.assert_array_equal(moved[:, :2] == 0, mesh.points[:, :2] == 0)
    np.testing.assert_array_equal(moved[:, :2] == 1, mesh.points[:, :2] == 1)


def test_no_vertex_of_a_wall_leaves_the_duct() -> None:
    # a fiber beyond a duct that ends a hair above the wall
    mesh = under_a_fiber(1.02, above=0.001)
    np.testing.assert_array_equal(on_fibers(mesh).points, mesh.points)


def test_walls_far_from_every_fiber_stay_where_they_are() -> None:
    # they bridge a gap: to move them onto a fiber would thin or thicken it elsewhere
    mesh = under_a_fiber(300.0, above=300.0)
    np.testing.assert_array_equal(on_fibers(mesh).points, mesh.points)


def test_a_long_row_of_corners_is_split_whatever_its_numbers() -> None:
    # a row of cubes: all its cells lie on the boundary with two faces or more, and their edges ascend along it
    points, tets = kuhn_box(40)
    row = (points[tets][:, :, :2].mean(axis=1) < 1 / 40).all(axis=1)
    more_points, more_tets = split(points, tets[row])
    assert np.bincount(boundary(more_tets)[1]).max() == 1
    assert volumes(more_points, more_tets).sum() == pytest.approx(40 / 40**3, rel=1e-12)


def test_only_cells_in_the_tip_of_a_wedge_are_filled_at_first() -> None:
    one = working(*kuhn_box(1))
    faulty = np.ones(one.cells, dtype=bool)
    assert in_crevice(one, faulty, stuck=False).all()  # one cube: every vertex lies on the boundary
    three = working(*kuhn_box(3))
    faulty = np.ones(three.cells, dtype=bool)
    touching = np.bincount(boundary(three.tets)[1], minlength=three.cells) > 0
    np.testing.assert_array_equal(in_crevice(three, faulty, stuck=True), touching)


def test_only_cells_with_a_vertex_on_a_fiber_may_be_given_to_it() -> None:
    points, tets = kuhn_box(5)
    # the cube in the middle, from 0.4 to 0.6, is the fiber
    hollow = tets[~(np.abs(points[tets].mean(axis=1) - 0.5) < 0.1).all(axis=1)]
    near = at_walls(working(points, hollow))
    on_cube = np.asarray(((points > 0.39) & (points < 0.61)).all(axis=1))
    np.testing.assert_array_equal(near, on_cube[hollow].any(axis=1))
    assert near.any()
    assert not near.all()


def test_only_cells_beside_a_fiber_with_every_vertex_may_be_given_to_it() -> None:
    # layers of cells .2 high under a fiber of diameter 1: all vertices of the uppermost lie within a quarter of it
    mesh = under_a_fiber(1.0, above=0.1)
    five = working(*kuhn_box(5), mesh.freedom)
    found = beside_fibers(five, np.arange(five.cells))
    np.testing.assert_array_equal(found, (five.points[five.tets][:, :, 2] > 0.79).all(axis=1))
    # where nobody knows the fibers' axes every cell may be one
    assert beside_fibers(working(*kuhn_box(2), freedom(place=300.0)), np.arange(48)).all()


def test_the_largest_part_is_kept() -> None:
    _, tets = kuhn_box(2)
    apart: Ints = np.concatenate([tets, np.array([[100, 101, 102, 103]])])
    np.testing.assert_array_equal(largest_part_of(neighbors(apart)), np.arange(len(apart)) < len(tets))


def test_splitting_the_longest_edges_fills_the_same_space() -> None:
    points, tets = kuhn_box(3)
    chosen = np.zeros(len(tets), dtype=bool)
    chosen[[3, 40, 41, 100]] = True
    mesh = split_longest(working(points, tets), chosen)
    more_points, more_tets = mesh.points, mesh.tets
    assert len(more_tets) > len(tets)
    assert (volumes(more_points, more_tets) > 0).all()
    assert volumes(more_points, more_tets).sum() == pytest.approx(1.0, rel=1e-14)
    new = more_points[len(points) :]
    # a cube's diagonal is the longest edge of each of its cells: its middle is the cube's
    assert np.allclose(new * 6 % 2, 1.0)
