"""The most penetrating size and the classes that follow, from efficiencies that were counted at a few sizes."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.capture import MostPenetratingSize

_SAMPLES = 2000


def depth_of_counts(captured: Floats, released: Ints) -> Floats:
    """Capture depth, -ln of the penetration, of counts; half a particle more on either side keeps it finite."""
    value: Floats = -np.log((released - captured + 0.5) / (released + 1.0))
    return value


def most_penetrating_size(diameter: Floats, captured: Ints, released: Ints, seed: int) -> MostPenetratingSize:
    """Find the size of highest penetration between the sizes that were counted.

    Parameters
    ----------
    diameter : (n,) array [m]
        Rising.
    captured, released : (n,) int arrays
    seed : int

    Returns
    -------
    MostPenetratingSize
        Its interval holds 95 % of what 2000 draws of the counts (binomial) give.

    Notes
    -----
    A parabola through the least capture depth and its two neighbors, over the logarithm of the diameter.

    Examples
    --------
    >>> size = most_penetrating_size(np.array([1e-7, 2e-7, 4e-7]), np.array([80, 50, 80]), np.full(3, 100), 1)
    >>> round(size.diameter * 1e9), size.inside
    (200, True)
    """
    log = np.log(diameter)
    at, depth, inside = _least(log, depth_of_counts(captured.astype(float), released))
    drawn = np.random.default_rng(seed).binomial(released, captured / released, (_SAMPLES, len(diameter)))
    sizes = np.exp([_least(log, depth_of_counts(each.astype(float), released))[0] for each in drawn])
    low, high = np.quantile(sizes, (0.025, 0.975))
    return MostPenetratingSize(float(np.exp(at)), float(low), float(high), float(np.exp(-depth)), inside)


def _least(x: Floats, depth: Floats) -> tuple[float, float, bool]:
    k = int(np.argmin(depth))
    if k in (0, len(x) - 1):
        return float(x[k]), float(depth[k]), False
    left, right = x[k] - x[k - 1], x[k + 1] - x[k]
    below, above = (depth[k] - depth[k - 1]) / left, (depth[k + 1] - depth[k]) / right
    bend = (above - below) / (left + right)
    slope = (below * right + above * left) / (left + right)
    if bend <= 0.0:
        return float(x[k]), float(depth[k]), True
    step = float(np.clip(-0.5 * slope / bend, -left, right))
    return float(x[k] + step), float(depth[k] + slope * step + bend * step * step), True
