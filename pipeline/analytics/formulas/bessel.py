r"""The modified Bessel functions that screened flow needs, without a library that takes longer to load than to compute.

.. math:: e^x K_\nu(x) = \int_0^\infty e^{-x(\cosh t - 1)} \cosh(\nu t)\, dt

(DLMF 10.32.9). The integrand ends doubly exponentially, so that the trapezoidal rule is good to rounding.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

_POINTS = 400
_NOTHING = 45.0  # exponent at which a term is below rounding of the sum


def scaled_bessel_ratio(x: float) -> float:
    r"""Give :math:`K_1(x)/K_0(x)` for x above 0 [-]; the plain functions underflow where their ratio does not.

    Examples
    --------
    >>> round(scaled_bessel_ratio(1.0), 12)
    1.42962539826
    """
    # far out the terms grow like cosh t before they end
    t = np.linspace(0.0, math.acosh(1.0 + _NOTHING / x) + 1.0, _POINTS)
    with np.errstate(over="ignore", under="ignore"):
        terms = np.exp(-x * (np.cosh(t) - 1.0))
        terms[0] *= 0.5
        return float((terms * np.cosh(t)).sum() / terms.sum())
