"""Means over the seeds, each with its 95 % confidence interval."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Estimate:
    """A mean over runs.

    Parameters
    ----------
    n : int
        Runs that gave a number.
    mean : float
        NaN where there is none.
    std : float
        Standard deviation of one run; NaN for fewer than two.
    half_width : float
        The 95 % confidence interval is mean +- half_width (Student's t); NaN for fewer than two.
    """

    n: int
    mean: float
    std: float
    half_width: float


def estimate(values: Sequence[float], confidence: float = 0.95) -> Estimate:
    r"""Estimate the mean of a population of which a few are known.

    .. math:: \bar x \pm t_{n-1,\,(1+c)/2}\; s/\sqrt n

    Parameters
    ----------
    values : sequence of float
        NaN counts as none.
    confidence : float [-]
        c, between 0 and 1.

    Examples
    --------
    >>> result = estimate([9.0, 10.0, 11.0])
    >>> result.mean, result.std, round(result.half_width, 4)
    (10.0, 1.0, 2.4841)
    """
    known = np.array([value for value in values if not math.isnan(value)])
    n = len(known)
    if n < 2:
        return Estimate(n, float(known[0]) if n else math.nan, math.nan, math.nan)
    from scipy.special import stdtrit

    std = float(known.std(ddof=1))
    t = float(stdtrit(n - 1, 0.5 * (1.0 + confidence)))
    return Estimate(n, float(known.mean()), std, t * std / math.sqrt(n))
