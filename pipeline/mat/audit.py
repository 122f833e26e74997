"""Whether the fibers of a mat keep clear of each other: an exact check of every pair."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.mat.neighbors import near_fibers
from pipeline.nouns.fibers import Mat

_BESIDE = 0.1
"""Pairs are looked at up to this share of the mean radius beyond what is allowed, to tell how clear the mat is."""


@dataclass(frozen=True, slots=True)
class Audit:
    """Which fibers stand too close.

    Parameters
    ----------
    violations : int
        Pairs of fibers whose axes are closer than the sum of their radii and the spacing.
    fibers : int
        Fibers in such a pair.
    deepest : float [m]
        How much the worst pair is too close; 0 without violations.
    least_gap : float [m] or None
        Smallest distance between the surfaces of two fibers, negative where they overlap; None where no two fibers
        come near each other.
    closest : tuple of two ints or None
        The fibers of that pair.
    """

    violations: int
    fibers: int
    deepest: float
    least_gap: float | None
    closest: tuple[int, int] | None


def audit(mat: Mat, spacing: float = 0.0) -> Audit:
    """Compare every pair of fibers, crossing or not, by the exact distance of their segments.

    In a periodic mat the images across the sides count too. Nothing is sampled, and no tolerance is given.

    Parameters
    ----------
    mat : Mat
    spacing : float [m]
        Gap asked between surfaces, 0 or more.

    Returns
    -------
    Audit

    Examples
    --------
    >>> from pipeline.mat.generate import generate
    >>> from pipeline.mat.settings import LayeredSettings, Stop
    >>> asked = {"side": 2e-5, "fiber_diameter": 1e-6, "relaxation_slope": 0.15, "stop": Stop(count=20)}
    >>> audit(generate(LayeredSettings(**asked, contact="clear"))).violations
    0
    >>> audit(generate(LayeredSettings(**asked, contact="paper"))).violations > 10
    True
    """
    beside = _BESIDE * float(mat.radius.mean())
    pairs = near_fibers(mat, mat.radius + 0.5 * (spacing + beside))
    allowed = mat.radius[pairs.first] + mat.radius[pairs.second] + spacing
    close = pairs.distance < allowed
    if len(pairs.distance) == 0:
        return Audit(0, 0, 0.0, None, None)
    gap = pairs.distance - (mat.radius[pairs.first] + mat.radius[pairs.second])
    tightest = int(np.argmin(gap))
    return Audit(
        violations=int(close.sum()),
        fibers=len(np.union1d(pairs.first[close], pairs.second[close])),
        deepest=float((allowed - pairs.distance)[close].max(initial=0.0)),
        least_gap=float(gap[tightest]),
        closest=(int(pairs.first[tightest]), int(pairs.second[tightest])),
    )
