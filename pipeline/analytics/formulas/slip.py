"""Air that slips along thin fibers: Knudsen number, flow regime (Table A3), Kuwabara's cell with slip."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Literal

import numpy as np

from pipeline.analytics.formulas.cell import hydrodynamic_factor
from pipeline.analytics.formulas.numbers import Numbers
from pipeline.nouns.arrays import Floats

Regime = Literal["continuum", "slip", "transition", "free molecule"]

SLIP_COEFFICIENT = 0.998
"""Slip length over mean free path, Maxwell's diffuse reflection."""

CONTINUUM_LIMIT, SLIP_LIMIT, TRANSITION_LIMIT = 0.01, 0.25, 10.0
"""Knudsen numbers at which one regime of Table A3 becomes the next."""


def knudsen(mean_free_path: Numbers, fiber_diameter: Numbers) -> Numbers:
    r"""Knudsen number of a fiber, Eq. A10: :math:`Kn = 2\lambda/d_f`, the mean free path over the fiber's radius.

    Parameters
    ----------
    mean_free_path, fiber_diameter : float or array [m]

    Returns
    -------
    float or array [-]

    Examples
    --------
    >>> round(knudsen(65.3e-9, 2e-6), 4)
    0.0653
    """
    return 2.0 * mean_free_path / fiber_diameter


def regime(knudsen: float) -> Regime:
    """Flow regime of a fiber, Table A3.

    Errata: the table prints 220 mean free paths for 200, and "transient" for transition.

    Examples
    --------
    >>> [regime(kn) for kn in (0.005, 0.1, 1.0, 20.0)]
    ['continuum', 'slip', 'transition', 'free molecule']
    """
    if knudsen < CONTINUUM_LIMIT:
        return "continuum"
    if knudsen < SLIP_LIMIT:
        return "slip"
    return "transition" if knudsen < TRANSITION_LIMIT else "free molecule"


def slip_length(knudsen: Numbers) -> Numbers:
    r"""Slip length over fiber radius, :math:`s = 0.998\,Kn`.

    Examples
    --------
    >>> round(slip_length(0.1), 4)
    0.0998
    """
    return SLIP_COEFFICIENT * knudsen


def kuwabara_slip(solidity: Numbers, slip_length: Numbers) -> Floats:
    r"""Kuwabara's cell around a fiber with slip [1]_.

    .. math:: F^* = \frac{4\pi(1 + 2s)}{Ku + 2s(-\tfrac12\ln\alpha - \tfrac14 + \tfrac{\alpha^2}{4})},
              \qquad f = \frac{4\alpha F^*}{\pi}

    Parameters
    ----------
    solidity : float or array [-]
        As for `pressure_drop.kuwabara`.
    slip_length : float or array [-]
        Over the fiber's radius, s; in the slip regime up to 0.25.

    Returns
    -------
    array [-]
        :math:`f = \Delta p\,d^2/(\eta U t)`; `pressure_drop.kuwabara` at s = 0, and never above it.

    Notes
    -----
    Follows from :math:`\psi = (A r + B/r + C r\ln r + D r^3)\sin\theta` with no vorticity on the cell's boundary and
    :math:`u_\theta = s\,r_f\,\tau_{r\theta}/\eta` on the fiber; ``docs/theory.md`` has the steps.

    References
    ----------
    .. [1] R. C. Brown, Air Filtration: An Integrated Approach to the Theory and Applications of Fibrous Filters,
       Pergamon 1993, ch. 3.

    Examples
    --------
    >>> round(float(kuwabara_slip(0.1, 0.1)) * 3.14159265 / 0.4, 2)
    22.19
    """
    ratio = np.asarray(solidity)
    stuck = hydrodynamic_factor(ratio)
    free = -0.5 * np.log(ratio) - 0.25 + 0.25 * ratio * ratio
    value: Floats = 16.0 * ratio * (1.0 + 2.0 * slip_length) / (stuck + 2.0 * slip_length * free)
    return value
