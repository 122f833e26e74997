"""The distance to the fibers of a duct."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np

from pipeline.nouns.arrays import Floats
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Pieces

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance


def fiber_distance(domain: FluidDomain, reach: Floats) -> "FiberDistance":
    """Measure the distance to the fibers of a duct.

    Parameters
    ----------
    domain : FluidDomain
    reach : (fibers,) array [m]
        Distance from each fiber beyond which it does not matter.

    Returns
    -------
    FiberDistance
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.fibers import FiberDistance

    pieces, lower, upper = domain.pieces, np.array(domain.box.lower), np.array(domain.box.upper)
    if len(pieces) == 0:
        # nobody knows the axes of a surface's fibers: one that lies out of reach of the duct stands for them
        away = upper[None] + 1e3 * domain.mean_diameter * np.array([[1.0, 0, 0], [2.0, 0, 0]])
        none = np.zeros(1, np.int64)
        pieces = Pieces(away[:1], away[1:], none, np.zeros((1, 2), np.bool_))
        reach = 1e-3 * domain.radius
    start, end, fiber, flat = pieces.start, pieces.end, pieces.fiber, pieces.flat
    if domain.cyclic:
        # a fiber that passes a side closely is as near to the opposite one, though it does not meet it
        shifts = [np.array([x, y, 0.0]) * (upper - lower) for x in (0, -1, 1) for y in (0, -1, 1)]
        start, end = (np.concatenate([ends + shift for shift in shifts]) for ends in (start, end))
        fiber, flat = np.tile(fiber, len(shifts)), np.tile(flat, (len(shifts), 1))
        margin = (domain.radius + reach)[fiber, None]
        near = ((np.minimum(start, end) < upper + margin) & (np.maximum(start, end) > lower - margin)).all(axis=1)
        start, end, fiber, flat = start[near], end[near], fiber[near], flat[near]
    return FiberDistance.about(start, end, domain.radius[fiber], flat, fiber, reach[fiber], lower, upper)
