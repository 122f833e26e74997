"""The distance to the fibers of a duct, in fiber diameters from its lower corner."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

import numpy as np

from pipeline.nouns.arrays import Ints
from pipeline.nouns.domain import FluidDomain

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance


def fiber_distance(domain: FluidDomain, unit: float, counts: Ints, reach: float) -> "FiberDistance":
    """Measure the distance to the fibers on a lattice that fills the duct.

    Parameters
    ----------
    domain : FluidDomain
    unit : float [m]
        Mean fiber diameter.
    counts : (3,) int array
        Intervals of the lattice along each axis.
    reach : float
        Diameters beyond which distances are not told apart.

    Returns
    -------
    FiberDistance
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.fibers import FiberDistance

    lower, pieces = np.array(domain.box.lower), domain.pieces
    x, y, z = counts.tolist()
    return FiberDistance.about(
        (pieces.start - lower) / unit,
        (pieces.end - lower) / unit,
        domain.radius[pieces.fiber] / unit,
        pieces.flat,
        np.zeros(3),
        (np.array(domain.box.upper) - lower) / unit,
        (x, y, z),
        reach,
    )
