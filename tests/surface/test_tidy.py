"""Clearing splinters: fewer of them, and still the same closed surface."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.crossings import self_intersections
from pipeline.nouns.surface import Surface
from pipeline.surface.measures import measure_surface
from pipeline.surface.remesh import check_with_meshlab
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite

from .mats import BENT, RADIUS, SIDE, WRAPPING_A_CORNER, mat_of

_RNG = np.random.default_rng(5)
PILE = mat_of(
    *([(0, a, z), (10, b, z)] for a, b, z in zip(*_RNG.uniform(1, 9, (2, 14)), np.linspace(1, 9, 14), strict=True))
)
RAW = SurfaceSettings(smallest_edge=0)
TIDY = SurfaceSettings()


def shortest_edges(surface: Surface) -> float:
    corners = surface.points[surface.triangles]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2) / (2 * RADIUS)
    return float((edges.min(axis=1) < TIDY.smallest_edge).mean())


def test_most_short_edges_go_and_the_volume_stays() -> None:
    raw, tidy = unite(PILE, RAW), unite(PILE, TIDY)
    assert shortest_edges(tidy) < 0.5 * shortest_edges(raw)
    # a vertex moves by at most a twentieth of a diameter, and only where fibers meet
    assert tidy.volume == pytest.approx(raw.volume, rel=1e-3)


def test_no_triangle_cuts_another_one() -> None:
    surface = unite(PILE, TIDY)
    assert len(self_intersections(surface.points, surface.triangles)) == 0


def test_meshlab_finds_a_closed_manifold() -> None:
    check = check_with_meshlab(unite(PILE, TIDY))
    assert (check.boundary_edges, check.non_manifold_edges, check.non_manifold_vertices) == (0, 0, 0)


def test_meshlab_and_we_see_the_same_self_intersection() -> None:
    # a cube through a face of another one, put together without a union
    one, two = unite(mat_of([(0, 5, 5), (10, 5, 5)]), RAW), unite(mat_of([(5, 0, 5.3), (5, 10, 5.3)]), RAW)
    both = Surface(
        np.concatenate([one.points, two.points]),
        np.concatenate([one.triangles, two.triangles + len(one.points)]),
        np.concatenate([one.fiber, two.fiber]),
        one.radius,
        one.slab,
        one.pieces,
    )
    ours = len(self_intersections(both.points, both.triangles))
    assert ours > 20
    # MeshLab also counts triangles that merely touch
    assert ours <= check_with_meshlab(both).self_intersecting <= 1.2 * ours


def test_cuts_stay_on_the_sides() -> None:
    surface = unite(PILE, TIDY)
    for place in (0.0, SIDE):
        off = np.abs(surface.points[:, 0] - place)
        assert not ((off > 0) & (off < 1e-6 * RADIUS)).any()


def test_opposite_sides_of_a_periodic_mat_keep_the_same_points() -> None:
    points = unite(WRAPPING_A_CORNER, TIDY).points
    for axis in (0, 1):
        low, high = (points[points[:, axis] == place][:, [1 - axis, 2]] for place in (0.0, SIDE))
        assert len(low) > 5
        distance = np.linalg.norm(low[:, None] - high[None], axis=2)
        assert distance.min(axis=0).max() < 1e-9 * SIDE
        assert distance.min(axis=1).max() < 1e-9 * SIDE


def test_measures_of_a_cross() -> None:
    cross = mat_of([(0, 5, 5), (10, 5, 5)], [(5, 0, 5), (5, 10, 5)])
    settings = SurfaceSettings(sides=64, smallest_edge=0)
    measures = measure_surface(cross, unite(cross, settings), settings)
    # the Steinmetz solid is what two crossing cylinders share
    assert measures.overlap_volume == pytest.approx(16 / 3 * RADIUS**3, rel=0.03)
    assert (measures.components, measures.genus, measures.self_intersections) == (1, 0, 0)
    assert measures.radius_error_min < 0 < measures.radius_error_max < 1e-3


def test_what_two_pieces_share_in_the_ball_on_their_bend_is_no_overlap() -> None:
    settings = SurfaceSettings(joint="sphere", caps="hemisphere", smallest_edge=0)
    measures = measure_surface(BENT, unite(BENT, settings), settings)
    assert abs(measures.overlap_volume) < 1e-9 * measures.volume


def test_two_crossings_make_a_ring() -> None:
    # four fibers around a square hole: one handle
    hash_sign = mat_of(*([(0, y, 5), (10, y, 5)] for y in (3, 7)), *([(x, 0, 5), (x, 10, 5)] for x in (3, 7)))
    measures = measure_surface(hash_sign, unite(hash_sign, TIDY), TIDY)
    assert (measures.components, measures.genus) == (1, 1)


def test_a_pile_without_overlap_sums_up() -> None:
    apart = mat_of([(0, 2, 2), (10, 2, 2)], [(0, 8, 2), (10, 8, 2)])
    measures = measure_surface(apart, unite(apart, RAW), RAW)
    assert abs(measures.overlap_volume) < 1e-12 * measures.volume
    assert measures.components == 2
