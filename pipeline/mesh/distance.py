"""The distance to the fibers of a duct."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np

from pipeline.nouns.arrays import Floats
from pipeline.nouns.domain import FluidDomain

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

    pieces = domain.pieces
    return FiberDistance.about(
        pieces.start,
        pieces.end,
        domain.radius[pieces.fiber],
        pieces.flat,
        pieces.fiber,
        reach[pieces.fiber],
        np.array(domain.box.lower),
        np.array(domain.box.upper),
    )
