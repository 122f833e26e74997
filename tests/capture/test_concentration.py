"""The concentration against Graetz' series, and cells that are cut where particles touch."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.capture.concentration import Penetration, _cut, concentration_penetration
from pipeline.capture.contact import distances, fiber_grid
from pipeline.geometry.tets import boundary, volumes
from validation.closed_flows import between_plates, brick, sampled
from validation.exact_capture import plates_penetration


def test_graetz_penetration_between_plates_to_one_percent_without_scatter() -> None:
    length, diffusivity, radius = 40.0, 0.02, 5000.0
    lower, upper = np.array([-1.0, 0, 0]), np.array([1.0, 0.2, length])
    cells = sampled(*brick(lower, upper, (6, 1, 120)), between_plates)
    x = np.array([-1.0 - radius, 1.0 + radius])
    start = np.column_stack([x, np.full(2, 0.1), np.full(2, -10.0)])
    end = start + np.array([0.0, 0.0, length + 20.0])
    grid = fiber_grid(start, end, np.full(2, radius), np.zeros((2, 2), bool), lower, upper, 1.0)
    found = concentration_penetration(cells, grid, 0.0, diffusivity)
    assert found.value == pytest.approx(plates_penetration(diffusivity * length), rel=0.01)


def test_a_cut_mesh_is_closed_and_its_volume_is_that_beyond_the_fiber() -> None:
    lower, upper = np.zeros(3), np.array([4.0, 1.0, 4.0])
    points, tets = brick(lower, upper, (20, 2, 20))
    start, end = np.array([[2.0, -2.0, 2.0]]), np.array([[2.0, 3.0, 2.0]])
    grid = fiber_grid(start, end, np.array([0.8]), np.zeros((1, 2), bool), lower, upper, 1.0)
    points, tets, touching = _cut(points, tets, grid, 0.2)
    assert (volumes(points, tets) > 0).all()
    # facets of .28 at most cut off a share of 2 (1 - sin(x)/x)/3 of the circle, x = .28
    assert volumes(points, tets).sum() == pytest.approx(16.0 - np.pi, rel=0.005)
    assert np.abs(distances(points[touching], grid) - 0.2).max() < 0.02
    # cells that share a cut face halve it alike: what belongs to one cell alone lies on the box or on the cut
    corners = points[boundary(tets)[0]]
    on_box = ((corners == lower) | (corners == upper)).all(axis=1).any(axis=1)
    on_cut = touching[boundary(tets)[0]].all(axis=1)
    assert (on_box | on_cut).all()


def test_the_extrapolated_depth_goes_on_a_third_of_the_last_step() -> None:
    found = Penetration(fine=np.exp(-1.0), coarse=np.exp(-1.3))
    assert found.value == pytest.approx(np.exp(-0.9))
    assert found.error == pytest.approx(1 / 9)
