# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt
import pytest

from pipeline.geometry.adjacency import largest_part_of, neighbors
from pipeline.geometry.fibers import FiberDistance
from pipeline.geometry.tets import boundary, volumes
from pipeline.mesh.improve.corners import split_corners, split_longest
from pipeline.mesh.improve.crevices import in_crevice
from pipeline.mesh.improve.fit import fitted
from pipeline.mesh.improve.mend import mended
from pipeline.nouns.arrays import Floats, Ints
from tests.mesh.boxes import kuhn_box

CUBE = np.zeros(3), np.ones(3)


def shaken(points: Floats, free: npt.NDArray[np.bool_], by: float, seed: int) -> Floats:
    moved = points.copy()
    rng = np.random.default_rng(seed)
    moved[free] += by * rng.standard_normal((int(free.sum()), 3))
    return moved


def inside(points: Floats) -> npt.NDArray[np.bool_]:
    return np.asarray(((points > 0) & (points < 1)).all(axis=1))


def free_to_move(points: Floats) -> tuple[Floats, Floats]:
    return inside(points)[:, None] * np.ones(3), np.full(len(points), np.inf)


@pytest.mark.parametrize("seed", range(5))
def test_inverted_cells_are_turned_right_and_the_boundary_stays(seed: int) -> None:
    points, tets = kuhn_box(4)
    bad = shaken(points, inside(points), 0.12, seed)
    assert (volumes(bad, tets) <= 0).any()  # or there would be nothing to mend
    free, leash = free_to_move(points)
    good, faulty = mended(bad, tets, free, leash, 60, CUBE)
    assert (volumes(good, tets) > 0).all()
    assert faulty.sum() < 0.02 * len(tets)
    np.testing.assert_array_equal(good[~inside(points)], points[~inside(points)])
    assert volumes(good, tets).sum() == pytest.approx(1.0, rel=1e-12)


def test_a_good_mesh_is_left_alone() -> None:
    points, tets = kuhn_box(3)
    free, leash = free_to_move(points)
    same, faulty = mended(points, tets, free, leash, 5, CUBE)
    np.testing.assert_array_equal(same, points)
    assert not faulty.any()


def test_no_vertex_strays_farther_than_its_leash() -> None:
    points, tets = kuhn_box(4)
    bad = shaken(points, inside(points), 0.1, 1)
    free, _ = free_to_move(points)
    moved, _ = mended(bad, tets, free, np.full(len(points), 0.01), 10, CUBE)
    distance = np.linalg.norm(moved - bad, axis=1)
    assert 0 < distance.max() <= 0.01 * (1 + 1e-12)


def test_splitting_leaves_one_boundary_face_per_cell_and_the_same_space() -> None:
    points, tets = kuhn_box(2)
    assert np.bincount(boundary(tets)[1]).max() > 1
    more_points, more_tets = split_corners(points, tets)
    assert np.bincount(boundary(more_tets)[1]).max() == 1
    assert (volumes(more_points, more_tets) > 0).all()
    assert volumes(more_points, more_tets).sum() == pytest.approx(1.0, rel=1e-14)
    # conforming: every face belongs to one cell on the boundary or to two inside
    faces = np.sort(more_tets[:, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]].reshape(-1, 3), axis=1)
    _, repeats = np.unique(faces, axis=0, return_counts=True)
    assert set(repeats.tolist()) == {1, 2}


def test_a_single_tetrahedron_is_split_until_each_part_has_one_boundary_face() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    more_points, more_tets = split_corners(points, np.array([[0, 1, 2, 3]]))
    assert len(more_tets) == 4
    assert volumes(more_points, more_tets).sum() == pytest.approx(1 / 6)


def nearly_flat(place: float) -> FiberDistance:
    """A fiber so thick that its surface is the plane z = place within the unit cube, and lies above it."""
    radius = 1000.0
    start = np.array([[-10.0, 0.5, place + radius]])
    return FiberDistance.about(
        start, start + np.array([20.0, 0, 0]), np.array([radius]), np.zeros((1, 2), bool),
        np.zeros(1, np.int64), np.ones(1), *CUBE,
    )  # fmt: skip


def test_fitting_moves_walls_onto_their_fiber_and_not_across_the_planes() -> None:
    points, tets = kuhn_box(4)
    faces, _ = boundary(tets)
    walls = faces[(points[faces, 2] == 1.0).all(axis=1)]
    free = np.ones_like(points)
    for axis in (0, 1):
        on_side = (points[:, axis] == 0) | (points[:, axis] == 1)
        free[on_side, axis] = 0.0
    moved = fitted(points, tets, walls, free, nearly_flat(1.02), (CUBE[0], CUBE[1] + 0.1))
    assert volumes(moved, tets).sum() == pytest.approx(1.02, rel=1e-3)
    np.testing.assert_array_equal(moved[:, :2] == 0, points[:, :2] == 0)
    np.testing.assert_array_equal(moved[:, :2] == 1, points[:, :2] == 1)


def test_no_vertex_of_a_wall_leaves_the_duct() -> None:
    points, tets = kuhn_box(4)
    faces, _ = boundary(tets)
    walls = faces[(points[faces, 2] == 1.0).all(axis=1)]
    moved = fitted(points, tets, walls, np.ones_like(points), nearly_flat(1.02), CUBE)
    np.testing.assert_array_equal(moved, points)


def test_walls_far_from_every_fiber_stay_where_they_are() -> None:
    # they bridge a gap: to move them onto a fiber would thin or thicken it elsewhere
    points, tets = kuhn_box(4)
    faces, _ = boundary(tets)
    walls = faces[(points[faces, 2] == 1.0).all(axis=1)]
    moved = fitted(points, tets, walls, np.ones_like(points), nearly_flat(300.0), (CUBE[0], CUBE[1] + 300.0))
    np.testing.assert_array_equal(moved, points)


def test_a_long_row_of_corners_is_split_whatever_its_numbers() -> None:
    # a row of cubes: all its cells lie on the boundary with two faces or more, and their edges ascend along it
    points, tets = kuhn_box(40)
    row = (points[tets][:, :, :2].mean(axis=1) < 1 / 40).all(axis=1)
    more_points, more_tets = split_corners(points, tets[row])
    assert np.bincount(boundary(more_tets)[1]).max() == 1
    assert volumes(more_points, more_tets).sum() == pytest.approx(40 / 40**3, rel=1e-12)


def test_only_cells_in_the_tip_of_a_wedge_are_filled_at_first() -> None:
    _, tets = kuhn_box(1)
    faulty = np.ones(len(tets), dtype=bool)
    assert in_crevice(
        tets, *boundary(tets), 8, faulty, stuck=False
    ).all()  # one cube: every vertex lies on the boundary
    _, inner = kuhn_box(3)
    faulty = np.ones(len(inner), dtype=bool)
    touching = np.bincount(boundary(inner)[1], minlength=len(inner)) > 0
    np.testing.assert_array_equal(in_crevice(inner, *boundary(inner), 64, faulty, stuck=True), touching)


def test_the_largest_part_is_kept() -> None:
    _, tets = kuhn_box(2)
    apart: Ints = np.concatenate([tets, np.array([[100, 101, 102, 103]])])
    np.testing.assert_array_equal(largest_part_of(neighbors(apart)), np.arange(len(apart)) < len(tets))


def test_splitting_the_longest_edges_fills_the_same_space() -> None:
    points, tets = kuhn_box(3)
    chosen = np.zeros(len(tets), dtype=bool)
    chosen[[3, 40, 41, 100]] = True
    more_points, more_tets = split_longest(points, tets, chosen)
    assert len(more_tets) > len(tets)
    assert (volumes(more_points, more_tets) > 0).all()
    assert volumes(more_points, more_tets).sum() == pytest.approx(1.0, rel=1e-14)
    new = more_points[len(points) :]
    # a cube's diagonal is the longest edge of each of its cells: its middle is the cube's
    assert np.allclose(new * 6 % 2, 1.0)
