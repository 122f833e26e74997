"""Aerosols of many sizes: anything that depends on the size, averaged over a lognormal distribution."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable

import numpy as np

from pipeline.nouns.arrays import Floats

_REACH, _POINTS = 8.0, 4001  # standard deviations to both sides; points of the trapezoidal rule


def lognormal_mean(of: Callable[[Floats], Floats], median: float, deviation: float) -> float:
    r"""Average over a lognormal distribution of sizes.

    .. math:: \bar f = \int f(d)\,\frac{1}{\sqrt{2\pi}\,\sigma}\,e^{-(\ln d - \ln m)^2/2\sigma^2}\,d\ln d,
              \qquad \sigma = \ln\sigma_g

    Parameters
    ----------
    of : callable
        Of an array of sizes [m], gives an array.
    median : float [m]
        m, above 0.
    deviation : float [-]
        Geometric standard deviation :math:`\sigma_g`, 1 or more; 1 is a single size.

    Returns
    -------
    float

    Notes
    -----
    The trapezoidal rule in :math:`\ln d` converges faster than any power for a smooth `of`.

    Examples
    --------
    >>> round(lognormal_mean(lambda d: d, 1.0, 2.0), 9) == round(float(np.exp(np.log(2.0) ** 2 / 2)), 9)
    True
    """
    spread = float(np.log(deviation))
    if spread == 0.0:
        return float(of(np.array([median]))[0])
    steps = np.linspace(-_REACH, _REACH, _POINTS)
    weights = np.exp(-0.5 * steps * steps)
    return float(np.average(of(median * np.exp(spread * steps)), weights=weights))


def mass_median(count_median: float, deviation: float) -> float:
    r"""Median by mass of sizes with this median by count (Hatch and Choate): :math:`m\,e^{3\ln^2\sigma_g}` [m].

    Its geometric standard deviation is the same.

    Examples
    --------
    >>> round(mass_median(1.0, 2.0), 3)
    4.226
    """
    return count_median * float(np.exp(3.0 * np.log(deviation) ** 2))
