"""Penetrations too small to count: the survivors of each layer start anew, in numbers, and the shares multiply."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.capture.counting import Filter
from pipeline.capture.langevin import Motion
from pipeline.capture.starts import starts
from pipeline.capture.trajectories import PASSED, Pace, tracked
from pipeline.nouns.arrays import Floats
from pipeline.nouns.capture import RarePenetration

_STREAM = 2**30  # of random numbers, one per layer, that no particle's size uses
_Z = 1.959964  # half width of a normal 95 % interval in standard deviations


def split_penetration(
    filter: Filter, motion: Motion, pace: Pace, seed: int, count: int, planes: Floats
) -> RarePenetration | None:
    r"""Give the penetration as the product of what passes from plane to plane.

    Parameters
    ----------
    filter : Filter
    motion : Motion
        Of particles that forget their velocity within a small part of a fiber: they start anew with the air's.
    pace : Pace
    seed : int
    count : int
        Particles that start from each plane.
    planes : (n,) array [m]
        Heights z, rising; the last is the outlet.

    Returns
    -------
    RarePenetration or None
        None where no particle reached one of the planes.

    Notes
    -----
    Fixed effort splitting [1]_: :math:`P = \prod_k p_k`; the variance of :math:`\ln P` is
    :math:`\sum_k (1 - p_k)/(N p_k)`, as long as the places at a plane are many. The outlet moves from plane to plane
    while the air upstream stays, so that what diffuses back may return.

    References
    ----------
    .. [1] M. J. J. Garvels, The splitting method in rare event simulation, thesis, Twente 2000.
    """
    places = starts(0, count, seed, filter.duct, filter.cells, filter.fastest)
    rng = np.random.default_rng(seed)
    depth, variance = 0.0, 0.0
    for layer, height in enumerate(planes):
        duct = filter.duct._replace(outlet=float(height))
        fates = tracked(places, 0, seed, _STREAM + layer, motion, duct, pace, filter.cells, filter.grid)
        through = fates.place[fates.outcome == PASSED]
        if not len(through):
            return None
        share = len(through) / count
        depth -= np.log(share)
        variance += (1.0 - share) / (count * share)
        # each survivor as often as the others, and the rest of them by lot
        places = through[rng.permutation(np.arange(count) % len(through))]
    half = _Z * np.sqrt(variance)
    value, low, high = (float(np.exp(-depth + step)) for step in (0.0, -half, half))
    return RarePenetration(value, low, high, len(planes))
