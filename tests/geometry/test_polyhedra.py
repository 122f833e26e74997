# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.polyhedra import polygons, polyhedra


def test_a_regular_hexagon_has_its_area_and_center() -> None:
    turn = np.arange(6) * np.pi / 3
    hexagon = np.stack([3 + 2 * np.cos(turn), 1 + 2 * np.sin(turn), np.full(6, 5.0)], axis=1)
    areas, centers = polygons(hexagon, np.arange(6), np.array([0, 6]))
    # 3 sqrt(3) / 2 times the side squared
    assert areas[0] == pytest.approx([0, 0, 6 * np.sqrt(3)], rel=1e-14)
    assert centers[0] == pytest.approx([3, 1, 5], rel=1e-14)


def test_a_lopsided_polygon_s_center_is_its_centroid() -> None:
    # bases 3 and 1, height 1
    trapezoid = np.array([[0, 0, 0], [3, 0, 0], [2, 1, 0], [1, 1, 0.0]])
    areas, centers = polygons(trapezoid, np.arange(4), np.array([0, 4]))
    assert areas[0, 2] == pytest.approx(2.0, rel=1e-14)
    assert centers[0] == pytest.approx([1.5, (3 + 2 * 1) / (3 * (3 + 1)), 0], rel=1e-14)


def test_a_prism_far_from_the_origin_keeps_its_volume() -> None:
    triangle = np.array([[0, 0], [1, 0], [0, 1.0]])
    points = np.array([[x, y, z] for z in (0.0, 2.0) for x, y in triangle]) * 1e-6 + 1.0
    corners = np.array([0, 2, 1, 3, 4, 5, 0, 1, 4, 3, 1, 2, 5, 4, 2, 0, 3, 5])
    shape = polyhedra(points, corners, np.array([0, 3, 6, 10, 14, 18]), np.zeros(5, np.int64), np.empty(0, np.int64), 1)
    # a micrometer one meter away holds 10 digits
    assert shape.volumes[0] == pytest.approx(1e-18, rel=1e-9)
    assert shape.cell_centers[0] - 1.0 == pytest.approx([1e-6 / 3, 1e-6 / 3, 1e-6], rel=1e-9)
