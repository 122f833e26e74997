"""Fiber diameters, drawn from the distribution that the settings name."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.geometry.triangles import Floats
from pipeline.mat.settings import Constant, Lognormal, Mixture, Normal, Uniform


def draw_diameters(
    settings: Constant | Uniform | Normal | Lognormal | Mixture, count: int, rng: np.random.Generator
) -> Floats:
    """Draw fiber diameters.

    Draws outside the bounds of a truncated distribution are drawn again, so the moments of what comes out are
    those of the truncated distribution, not those that the settings name.

    Parameters
    ----------
    settings : settings of the distribution
    count : int
    rng : numpy.random.Generator

    Returns
    -------
    (count,) array [m]

    Examples
    --------
    >>> draw_diameters(Constant(diameter=1.4e-6), 2, np.random.default_rng(1)).tolist()
    [1.4e-06, 1.4e-06]
    """
    match settings:
        case Constant():
            return np.full(count, settings.diameter)
        case Uniform():
            return settings.min + (settings.max - settings.min) * rng.random(count)
        case Mixture():
            return _mixed(settings, count, rng)
    low, high = settings.bounds
    drawn = _untruncated(settings, count, rng)
    while len(outside := np.flatnonzero(~((drawn > 0) & (drawn >= low) & (drawn <= high)))):
        drawn[outside] = _untruncated(settings, len(outside), rng)
    return drawn


def _untruncated(settings: Normal | Lognormal, count: int, rng: np.random.Generator) -> Floats:
    score = rng.standard_normal(count)
    if isinstance(settings, Normal):
        return settings.mean + settings.std * score
    return settings.median * np.exp(math.log(settings.geometric_std) * score)


def _mixed(settings: Mixture, count: int, rng: np.random.Generator) -> Floats:
    weights = np.array([part.weight for part in settings.parts])
    kind = rng.choice(len(weights), size=count, p=weights / weights.sum())
    drawn = np.empty(count)
    for number, part in enumerate(settings.parts):
        members = np.flatnonzero(kind == number)
        drawn[members] = draw_diameters(part.diameter, len(members), rng)
    return drawn
