"""The grid of fibers against a look at every piece."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.capture.contact import fiber_grid, surface_distance, touching_fibers
from pipeline.geometry.fibers import to_piece


@pytest.mark.parametrize("seed", range(3))
def test_the_grid_knows_the_nearest_surface_within_its_reach_and_no_other(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count, reach = 30, 1.5
    start = rng.uniform(-1, 11, (count, 3))
    end = start + rng.uniform(-8, 8, (count, 3))
    radius = rng.uniform(0.05, 1.0, count)
    flat = rng.random((count, 2)) < 0.5
    grid = fiber_grid(start, end, radius, flat, np.zeros(3), np.full(3, 10.0), reach)
    for x, y, z in rng.uniform(0, 10, (60, 3)):
        every = [to_piece(x, y, z, start[k], end[k], radius[k], flat[k, 0], flat[k, 1]) for k in range(count)]
        found, piece = surface_distance(x, y, z, grid)
        nearest = min(every)
        if nearest >= reach:
            assert (found, piece) == (reach, -1)
        elif nearest > 0:
            # a piece cut into short ones has balls at the cuts only inside of itself
            assert found == pytest.approx(nearest, abs=1e-9)
            assert every[grid.source[piece]] == pytest.approx(nearest, abs=1e-9)


def test_a_particle_between_two_fibers_touches_both_and_two_pieces_of_one_fiber_count_once() -> None:
    start = np.array([[0, 0, 0], [5.0, 0, 0], [0, 3.0, 0]])
    end = np.array([[5.0, 0, 0], [10.0, 0, 0], [10.0, 3.0, 0]])
    grid = fiber_grid(start, end, np.ones(3), np.zeros((3, 2), bool), np.full(3, -2.0), np.full(3, 12.0), 2.0)
    fiber = np.array([0, 0, 1])[grid.source]
    places = np.array([[5.0, 1.5, 0.0], [5.0, -1.5, 0.0], [5.0, 6.0, 0.0]])
    assert touching_fibers(places, grid, fiber, 0.6).tolist() == [2, 1, 0]
