"""Filters with closed-form answers: straight fibers in air whose velocity is known everywhere."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable

import numpy as np

from pipeline.analytics.settings import FilterSettings
from pipeline.capture.capture import Medium
from pipeline.geometry.box import Box
from pipeline.nouns.arrays import Floats
from pipeline.nouns.fibers import Mat, Pieces
from validation.closed_flows import brick, sampled

RADIUS = 0.7e-6
SIDE = 6e-6
SPEED = 0.05


def even(places: Floats) -> Floats:
    """Air at one velocity along z, as if no fiber were there."""
    velocity = np.zeros_like(places)
    velocity[:, 2] = SPEED
    return velocity


def straight_fibers(
    velocity: Callable[[Floats], Floats] = even, x: tuple[float, ...] = (0.5 * SIDE,), wraps: bool = False
) -> Medium:
    """Make a duct of 6 x 6 x 16 um with fibers of 1.4 um along y in its middle, at each x."""
    box = Box((0.0, 0.0, 0.0), (SIDE, SIDE, 16e-6))
    slab = Box((0.0, 0.0, 6e-6), (SIDE, SIDE, 10e-6))
    count = len(x)
    start, end = (np.column_stack([x, np.full(count, y), np.full(count, 8e-6)]) for y in (0.0, SIDE))
    nodes = np.stack([start, end], axis=1).reshape(-1, 3)
    mat = Mat(nodes, 2 * np.arange(count + 1), np.full(count, RADIUS), slab, -1, "drawn", periodic=wraps)
    beyond = np.array([0.0, 2e-6, 0.0])
    pieces = Pieces(start - beyond, end + beyond, np.arange(count), np.zeros((count, 2), bool))
    cells = sampled(*brick(np.array(box.lower), np.array(box.upper), (4, 4, 10)), velocity)
    model = FilterSettings(solidity=0.06, thickness=4e-6, fiber_diameter=2 * RADIUS)
    return Medium(mat, pieces, box, wraps, cells, 5.0, "closed form", model)
