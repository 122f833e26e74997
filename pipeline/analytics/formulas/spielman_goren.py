r"""Spielman and Goren's pressure drop: each fiber stands in a porous medium that resists as all the others do [1]_.

With :math:`\xi = r/\sqrt{k}` (k the permeability) and :math:`R_k = K_1(\xi)/(\xi K_0(\xi))`, the balance of pressure
and drag is one equation for :math:`\xi`; the answer is :math:`f = d^2/k = 4\xi^2`.

With a slip length s (over the radius), a fiber across the flow has :math:`R_\perp = R_k (1 + 2s)/(1 + 2s + s\xi^2 R_k)`
and a fiber along it :math:`R_\parallel = R_k/(1 + s\xi^2 R_k)`: Brinkman's equation solved with Maxwell's condition,
see ``docs/theory.md``.

.. [1] L. Spielman and S. L. Goren, Model for predicting pressure drop and filtration efficiency in fibrous media,
   Environ. Sci. Technol. 2 (1968) 279-287, doi 10.1021/es60016a003.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Callable

import numpy as np

from pipeline.analytics.formulas.bessel import scaled_bessel_ratio
from pipeline.analytics.formulas.numbers import Numbers
from pipeline.nouns.arrays import Floats

_MOST, _EXACT = 100, 1e-14  # steps, and what is as good as nothing
_SCREENING = (-45.0, 12.0)  # ln xi: from solidity 1e-36 to where the medium is as good as solid


def spielman_goren_layers(solidity: Numbers, slip_length: Numbers = 0.0) -> Floats:
    r"""Fibers in all directions within layers across the flow: :math:`1/(4\alpha) = 1/2 + R_\perp`.

    Parameters
    ----------
    solidity : float or array [-]
        Has no answer (infinity) from 0.5 on.
    slip_length : float or array [-]
        Over the fiber's radius.

    Returns
    -------
    array [-]
        :math:`f = \Delta p\,d^2/(\eta U t)`.

    Examples
    --------
    >>> round(float(spielman_goren_layers(0.05)), 3)
    0.722
    """

    def balance(reach: float, slip: float) -> float:
        return 0.5 + _across(reach, slip)

    return _solve(balance, 0.5, solidity, slip_length)


def spielman_goren_isotropic(solidity: Numbers, slip_length: Numbers = 0.0) -> Floats:
    r"""Fibers in all directions of space: :math:`1/(4\alpha) = 1/3 + \tfrac23 R_\perp + \tfrac16 R_\parallel`.

    Without slip this is the published :math:`1/3 + \tfrac56 R_k`. The pressure on the ends of fibers along the flow is
    left out; with it the constant is 5/12.

    Parameters
    ----------
    solidity : float or array [-]
        Has no answer (infinity) from 0.75 on.
    slip_length : float or array [-]
        Over the fiber's radius.

    Returns
    -------
    array [-]
        :math:`f = \Delta p\,d^2/(\eta U t)`; tends to `pressure_drop.jackson_james` for dilute media.

    Examples
    --------
    >>> round(float(spielman_goren_isotropic(0.05)), 3)
    0.531
    """

    def balance(reach: float, slip: float) -> float:
        return 1.0 / 3.0 + 2.0 / 3.0 * _across(reach, slip) + _along(reach, slip) / 6.0

    return _solve(balance, 1.0 / 3.0, solidity, slip_length)


def _stuck(reach: float) -> float:
    return scaled_bessel_ratio(reach) / reach


def _across(reach: float, slip: float) -> float:
    stuck = _stuck(reach)
    return stuck * (1.0 + 2.0 * slip) / (1.0 + 2.0 * slip + slip * reach * reach * stuck)


def _along(reach: float, slip: float) -> float:
    stuck = _stuck(reach)
    return stuck / (1.0 + slip * reach * reach * stuck)


def _solve(balance: Callable[[float, float], float], floor: float, solidity: Numbers, slip_length: Numbers) -> Floats:
    def one(share: float, slip: float) -> float:
        if 1.0 / (4.0 * share) <= floor:
            return math.inf

        def surplus(log_reach: float) -> float:
            # nearly a straight line in the logarithms, which takes a dozen steps instead of a hundred
            return math.log(4.0 * share * balance(math.exp(log_reach), slip))

        if surplus(_SCREENING[1]) > 0:
            return math.inf
        return 4.0 * math.exp(2.0 * _root(surplus, *_SCREENING))

    values: Floats = np.vectorize(one, otypes=[np.float64])(solidity, slip_length)
    return values


def _root(surplus: Callable[[float], float], low: float, high: float) -> float:
    """Find where a falling function that is nearly straight crosses 0, by secants that keep the root between them."""
    at_low, at_high = surplus(low), surplus(high)
    for _ in range(_MOST):
        middle = high - at_high * (high - low) / (at_high - at_low)
        at_middle = surplus(middle)
        if at_middle * at_high < 0.0:
            low, at_low = high, at_high
        else:
            # the end that stays loses weight, or it would stay for good (Anderson and Bjorck, BIT 13 (1973) 253-264)
            weight = 1.0 - at_middle / at_high
            at_low *= weight if weight > 0.0 else 0.5
        high, at_high = middle, at_middle
        if abs(at_middle) < _EXACT or abs(high - low) < _EXACT:
            break
    return high
