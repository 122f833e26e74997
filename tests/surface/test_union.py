"""The united fibers: closed form solids, exact cuts, no fiber lost."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import pytest

from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.geometry.solids import Body
from pipeline.geometry.triangles import Floats, Ints, area_vectors, connected_pieces
from pipeline.nouns.fibers import Mat
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.size import expected_triangles
from pipeline.surface.union import fiber_bodies, spread, unite

from .mats import (
    BENT,
    BROKEN,
    COINCIDENT,
    CROSSING,
    EVERY_MAT,
    GRAZING_A_SIDE,
    HALF_FIBERS,
    RADIUS,
    RESTING,
    SIDE,
    WRAPPING,
    WRAPPING_A_CORNER,
    Line,
    mat_of,
)

ONE_FIBER = math.pi * RADIUS**2 * SIDE
FINE = SurfaceSettings(sides=256, smallest_edge=0)


@pytest.mark.parametrize("settings", [SurfaceSettings(), SurfaceSettings(joint="sphere", caps="hemisphere")])
@pytest.mark.parametrize("mat", EVERY_MAT.values(), ids=EVERY_MAT.keys())
def test_every_hand_made_mat_gives_a_closed_surface_within_the_plan(mat: Mat, settings: SurfaceSettings) -> None:
    surface = unite(mat, settings)  # closed and outward, or it would not exist
    assert np.linalg.norm(area_vectors(surface.points, surface.triangles), axis=1).min() > 0
    assert surface.points[:, :2].min() >= 0
    assert surface.points[:, :2].max() <= SIDE


def test_crossing_cylinders_share_the_steinmetz_solid() -> None:
    # two cylinders less the solid they share, 16 r^3 / 3; an inscribed polygon of n corners errs by about 1/n^2
    exact = 2 * ONE_FIBER - 16 / 3 * RADIUS**3
    assert unite(CROSSING, FINE).volume == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize("sides", [6, 12, 64])
def test_a_tube_has_the_cylinder_volume_whatever_its_corners(sides: int) -> None:
    # the polygon is scaled to the circle's area; the end rings are cut through antiprisms, hence not to the last digit
    assert unite(
        mat_of([(0, 5, 5), (10, 5, 5)]), SurfaceSettings(sides=sides, smallest_edge=0)
    ).volume == pytest.approx(ONE_FIBER, rel=2e-3)


def test_a_mitred_bend_keeps_the_volume_of_its_pieces() -> None:
    # a miter takes inside the bend what it gives outside
    length = float(BENT.segment_lengths().sum())
    assert unite(BENT, SurfaceSettings()).volume == pytest.approx(math.pi * RADIUS**2 * length, rel=2e-3)


def test_a_ball_on_a_bend_adds_the_wedge_of_a_sphere() -> None:
    # turning by t, the outside gains the lune 2/3 t r^3; inside, the two pieces share 4/3 tan(t/2) r^3
    turn = math.pi / 4
    pieces = math.pi * RADIUS**2 * float(BENT.segment_lengths().sum())
    exact = pieces + 2 * RADIUS**3 * (2 / 3 * turn - 4 / 3 * math.tan(turn / 2))
    united = unite(BENT, SurfaceSettings(sides=128, joint="sphere", smallest_edge=0)).volume
    assert united - pieces == pytest.approx(exact - pieces, rel=0.02)


def test_fibers_at_rest_on_each_other_keep_their_volumes() -> None:
    assert unite(RESTING, FINE).volume == pytest.approx(2 * ONE_FIBER, rel=1e-4)


def test_a_fiber_twice_is_that_fiber_once() -> None:
    assert unite(COINCIDENT, FINE).volume == pytest.approx(ONE_FIBER, rel=1e-4)


def test_a_symmetry_plane_cuts_fibers_in_half() -> None:
    assert unite(HALF_FIBERS, FINE).volume == pytest.approx(2 * ONE_FIBER, rel=1e-4)


def test_a_broken_fiber_ends_inside_with_half_balls() -> None:
    cylinder = math.pi * RADIUS**2 * float(BROKEN.segment_lengths().sum())
    flat = unite(BROKEN, SurfaceSettings()).volume
    round_ = unite(BROKEN, SurfaceSettings(sides=64, caps="hemisphere", smallest_edge=0)).volume
    assert flat == pytest.approx(cylinder, rel=1e-12)
    assert round_ - flat == pytest.approx(4 / 3 * math.pi * RADIUS**3, rel=5e-3)


def test_a_periodic_fiber_keeps_its_whole_volume() -> None:
    # what leaves through one side comes back through the other
    for mat in (WRAPPING, WRAPPING_A_CORNER):
        cylinder = math.pi * RADIUS**2 * float(mat.segment_lengths().sum())
        assert unite(mat, SurfaceSettings()).volume == pytest.approx(cylinder, rel=1e-9)


def test_cuts_lie_on_the_sides_to_the_last_bit() -> None:
    points = unite(CROSSING, SurfaceSettings()).points
    for axis in (0, 1):
        for place in (0.0, SIDE):
            off = np.abs(points[:, axis] - place)
            assert (off == 0).sum() >= 12
            assert not ((off > 0) & (off < 1e-6 * RADIUS)).any()


def test_a_grazing_fiber_reaches_the_side_it_ends_on() -> None:
    # its axis is 10 nm off the side x = 0: cut to nearly a half cylinder from y = 0 to y = 10 um
    assert unite(GRAZING_A_SIDE, FINE).volume == pytest.approx(ONE_FIBER / 2, rel=0.01)


def test_each_triangle_names_the_fiber_it_is_nearest_to() -> None:
    surface = unite(CROSSING, SurfaceSettings())
    middle = surface.points[surface.triangles].mean(axis=1) - 5e-6
    distance = np.stack([np.hypot(middle[:, 1], middle[:, 2]), np.hypot(middle[:, 0], middle[:, 2])])
    own = distance[surface.fiber, np.arange(len(middle))]
    assert own.max() < 1.02 * RADIUS
    assert set(surface.fiber.tolist()) == {0, 1}


def test_a_closed_void_is_filled() -> None:
    # six coarse fibers make a cage around a cube: three pairs at distance 2 a < 2 r sqrt 2
    a = 0.9
    lines: list[Line] = [[(0, 5 + s * a, 5), (10, 5 + s * a, 5)] for s in (-1, 1)]
    lines += [[(5, 0, 5 + s * a), (5, 10, 5 + s * a)] for s in (-1, 1)]
    lines += [[(5 + s * a, 5, 1), (5 + s * a, 5, 9)] for s in (-1, 1)]
    surface = unite(mat_of(*lines), SurfaceSettings())
    assert connected_pieces(surface.triangles).max() == 0


def test_labels_spread_over_a_closed_surface() -> None:
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    assert spread(tetrahedron, np.array([-1, -1, 4, -1])).tolist() == [4, 4, 4, 4]
    with pytest.raises(ValueError, match="no label"):
        spread(tetrahedron, np.full(4, -1))


def test_clearing_that_would_eat_the_tubes_is_refused() -> None:
    with pytest.raises(ValueError, match=r"smallest_edge = 0\.05 would collapse the tubes.*make it 0\.012 or less"):
        SurfaceSettings(sides=128)


def test_a_surface_that_fits_in_no_memory_is_refused_with_the_fiber_that_takes_it() -> None:
    lines = [np.array(line) * 1e-6 for line in ([(0, 3, 5), (10, 3, 5)], [(0, 7, 5), (10, 7, 5)])]
    mat = Mat(np.concatenate(lines), np.array([0, 2, 4]), np.array([RADIUS, 1e-13]), CROSSING.slab, -1, "test")
    with pytest.raises(StageError, match=r"fiber 1 alone, 2e-07 um thick, takes 100%.*raise surface\.ring_spacing"):
        unite(mat, SurfaceSettings())


@pytest.mark.parametrize("mat", [CROSSING, BENT, RESTING])
def test_the_size_that_is_told_is_that_of_the_tubes(mat: Mat) -> None:
    # less the two caps of each fiber, a disc of ten triangles, and what running out through the sides adds
    tubes = sum(len(triangles) for _, triangles in fiber_bodies(mat, SurfaceSettings())[0])
    assert expected_triangles(mat, SurfaceSettings()).sum() == pytest.approx(tubes, rel=0.2)


def test_a_surface_that_cuts_itself_does_not_leave(monkeypatch: pytest.MonkeyPatch) -> None:
    # two tubes put together as if their union had failed
    def together(bodies: list[Body], limits: Box) -> tuple[Floats, Ints, Ints]:
        (one, faces), (two, others) = bodies
        count = np.repeat([0, 1], [len(faces), len(others)])
        return np.concatenate([one, two]), np.concatenate([faces, others + len(one)]), count

    monkeypatch.setattr("pipeline.surface.union.unite_within", together)
    with pytest.raises(StageError, match=r"triangles of the united surface cut another.*of fibers 0, 1"):
        unite(CROSSING, SurfaceSettings(smallest_edge=0))
