# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.geometry.adjacency import cells_at_vertices, neighbors
from pipeline.geometry.tets import FACES, boundary, volume_between, volumes
from pipeline.geometry.triangles import Floats, enclosed_volume
from tests.mesh.boxes import kuhn_box

heights = st.floats(-1.0, 2.0, allow_nan=False)


def test_the_boundary_of_a_box_encloses_what_its_tetrahedra_fill() -> None:
    points, tets = kuhn_box(3)
    faces, cell = boundary(tets)
    assert len(faces) == 6 * 3 * 3 * 2  # six sides of nine squares of two triangles
    assert len(cell) == len(faces)
    assert enclosed_volume(points, faces) == pytest.approx(volumes(points, tets).sum(), rel=1e-14)


@settings(deadline=None, max_examples=60)
@given(heights, heights)
def test_the_volume_between_two_planes_of_a_box_is_its_share_of_height(one: float, other: float) -> None:
    low, high = sorted((one, other))
    points, tets = kuhn_box(2)
    share = np.clip(high, 0, 1) - np.clip(low, 0, 1)
    assert volume_between(points, boundary(tets)[0], low, high) == pytest.approx(share, abs=1e-14)


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32), st.lists(heights, min_size=3, max_size=3))
def test_volumes_between_planes_add_up(seed: int, planes: list[float]) -> None:
    rng = np.random.default_rng(seed)
    points: Floats = rng.random((4, 3))
    tets = np.array([[0, 1, 2, 3]])
    if volumes(points, tets)[0] < 0:
        tets = tets[:, [1, 0, 2, 3]]
    low, middle, high = sorted(planes)
    faces = tets[0][FACES]
    parts = volume_between(points, faces, low, middle) + volume_between(points, faces, middle, high)
    assert parts == pytest.approx(volume_between(points, faces, low, high), abs=1e-13)
    assert volume_between(points, faces, -1, 3) == pytest.approx(volumes(points, tets)[0], rel=1e-12)


def test_a_plane_cuts_a_random_tetrahedron_as_counting_points_does() -> None:
    rng = np.random.default_rng(5)
    points: Floats = rng.random((4, 3))
    tets = np.array([[0, 1, 2, 3]]) if volumes(points, np.array([[0, 1, 2, 3]]))[0] > 0 else np.array([[1, 0, 2, 3]])
    inside = rng.dirichlet(np.ones(4), 400_000) @ points[tets[0]]
    for level in np.linspace(points[:, 2].min(), points[:, 2].max(), 7):
        share = volume_between(points, tets[0][FACES], -9.0, level) / volumes(points, tets)[0]
        # three standard deviations of counting 400,000 points
        assert share == pytest.approx((inside[:, 2] < level).mean(), abs=3 * 0.5 / 400_000**0.5)


def test_neighbors_are_mutual_and_share_three_vertices() -> None:
    _, tets = kuhn_box(3)
    across = neighbors(tets)
    for cell, side in np.argwhere(across >= 0):
        other = across[cell, side]
        assert cell in across[other]
        assert len(set(tets[cell]) & set(tets[other])) == 3
    assert (across < 0).sum() == len(boundary(tets)[0])


def test_every_tetrahedron_is_listed_at_each_of_its_vertices() -> None:
    points, tets = kuhn_box(2)
    first, cells = cells_at_vertices(tets.astype(np.int32), len(points))
    for vertex in range(len(points)):
        listed = cells[first[vertex] : first[vertex + 1]]
        assert sorted(listed) == sorted(np.flatnonzero((tets == vertex).any(axis=1)))
