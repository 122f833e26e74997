"""The walk through cells, and the velocity in them, on fields that elements of second order hold exactly."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.capture.cells import cells_of, near_cell, shares, velocity_in, walked
from pipeline.nouns.arrays import Floats
from validation.closed_flows import brick, sampled


def quadratic(places: Floats) -> Floats:
    """Give a velocity without divergence that has every kind of second-order term."""
    x, y, z = places.T
    return np.stack([x * x + y * z, z - 2 * x * y, 1 + y * y - 3 * x + x * y], axis=1)


def test_a_quadratic_velocity_is_given_exactly_at_any_place_and_from_any_cell() -> None:
    cells = sampled(*brick(np.zeros(3), np.array([2.0, 1.0, 3.0]), (3, 2, 5)), quadratic)
    rng = np.random.default_rng(1)
    for x, y, z in rng.uniform(0, 1, (100, 3)) * np.array([2.0, 1.0, 3.0]):
        cell, inside = walked(x, y, z, int(rng.integers(len(cells.nodes))), cells)
        assert inside
        assert min(shares(x, y, z, cell, cells)) > -1e-9
        assert velocity_in(x, y, z, cell, cells) == pytest.approx(quadratic(np.array([[x, y, z]]))[0], abs=1e-9)
        near, _ = walked(x, y, z, near_cell(x, y, z, cells), cells)
        assert min(shares(x, y, z, near, cells)) > -1e-9


def test_a_curved_cell_gives_the_velocity_of_the_place_and_not_of_the_straight_cell() -> None:
    points, tets = brick(np.zeros(3), np.ones(3), (2, 2, 2))
    straight = sampled(points, tets, quadratic)
    # every middle of an edge moves by up to .03 of its length
    position = straight.position.copy()
    position[len(points) :] += np.random.default_rng(2).uniform(-0.015, 0.015, position[len(points) :].shape)
    x, y, z = position.T
    # a velocity that is linear in space is linear in the curved map too; its flux density nearly so
    cells = cells_of(straight.nodes, position, np.stack([x, y - z, 1 - 2 * z], 1))
    assert cells.curved.all()
    cell, _ = walked(0.41, 0.37, 0.22, 0, cells)
    assert velocity_in(0.41, 0.37, 0.22, cell, cells) == pytest.approx([0.41, 0.15, 0.56], abs=5e-3)


def test_a_place_outside_ends_the_walk_at_the_wall() -> None:
    cells = sampled(*brick(np.zeros(3), np.ones(3), (2, 2, 2)), quadratic)
    cell, inside = walked(0.3, 0.3, 1.2, 0, cells)
    assert not inside
    assert cells.position[cells.nodes[cell, :4], 2].max() == 1.0
