"""What three resolutions tell of the error that is left: observed order, extrapolation, grid convergence index."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

FORMAL_ORDER = 2.0
"""Of the finite volumes that we write; second-order elements reach it or more, so it is on the safe side for them."""

_LOWEST_ORDER = 0.5
_HIGHEST_ORDER = 20.0  # no discretization has it
_ASYMPTOTIC = 0.1  # relative distance of the observed from the formal order within which the mesh counts as fine
_SAFETY, _CAUTIOUS_SAFETY = 1.25, 3.0
_ROUNDS = 200


@dataclass(frozen=True, slots=True)
class Convergence:
    """What three resolutions tell.

    Parameters
    ----------
    order : float [-]
        Observed order of convergence; nan where the answers swing about a value, or meshes are too alike to tell one.
    extrapolated : float
        Richardson's estimate of the answer on an infinitely fine mesh.
    index : float [-]
        Grid convergence index of the finest answer: a band about it, relative, that should hold the exact one.
    asymptotic : bool
        Whether the observed order is so near the formal one that the index may be small.
    """

    order: float
    extrapolated: float
    index: float
    asymptotic: bool


def convergence(spacings: tuple[float, float, float], answers: tuple[float, float, float]) -> Convergence:
    r"""Judge the answers on three meshes, coarse to fine.

    .. math:: p \ln r_{21} = \left| \ln|\varepsilon_{32}/\varepsilon_{21}| + q(p) \right|, \qquad
        q = \ln \frac{r_{21}^p - s}{r_{32}^p - s}

    with :math:`s` the sign of :math:`\varepsilon_{32}/\varepsilon_{21}` [1]_ (subscript 1 is the finest mesh). The
    index is :math:`F_s |\varepsilon_{21}| / (r_{21}^p - 1)` relative to the finest answer; where the observed order is
    more than a tenth off the formal one, :math:`F_s = 3` and p is held between 0.5 and the formal order [2]_.

    Parameters
    ----------
    spacings : tuple of 3 floats
        Representative mesh spacing, (volume / cells)^(1/3), strictly falling.
    answers : tuple of 3 floats

    Returns
    -------
    Convergence

    Raises
    ------
    ValueError
        If the spacings do not fall.

    References
    ----------
    .. [1] I. B. Celik et al., J. Fluids Eng. 130, 078001 (2008), doi 10.1115/1.2960953.
    .. [2] W. L. Oberkampf and C. J. Roy, Verification and Validation in Scientific Computing (2010), section 8.6.

    Examples
    --------
    >>> found = convergence((0.4, 0.2, 0.1), (10.16, 10.04, 10.01))
    >>> round(found.order, 3), round(found.extrapolated, 3), found.asymptotic
    (2.0, 10.0, True)
    """
    coarse, middle, fine = answers
    if not spacings[0] > spacings[1] > spacings[2] > 0:
        raise ValueError(f"spacings {spacings} do not fall")
    ratio_fine, ratio_coarse = spacings[1] / spacings[2], spacings[0] / spacings[1]
    step_fine, step_coarse = middle - fine, coarse - middle
    if step_fine == 0.0:
        return Convergence(math.nan, fine, 0.0, asymptotic=False)
    swings = step_coarse / step_fine <= 0.0
    order = math.nan if swings else _observed_order(step_coarse / step_fine, ratio_fine, ratio_coarse)
    asymptotic = abs(order - FORMAL_ORDER) <= _ASYMPTOTIC * FORMAL_ORDER
    known = 0.0 if math.isnan(order) else order
    safe_order = FORMAL_ORDER if asymptotic else min(max(_LOWEST_ORDER, known), FORMAL_ORDER)
    gain = ratio_fine**safe_order - 1.0
    factor = _SAFETY if asymptotic else _CAUTIOUS_SAFETY
    return Convergence(order, fine - step_fine / gain, factor * abs(step_fine / fine) / gain, asymptotic)


def _observed_order(change: float, ratio_fine: float, ratio_coarse: float) -> float:
    order = abs(math.log(change)) / math.log(ratio_fine)
    for _ in range(_ROUNDS):
        if order < 1e-6:
            break
        if order > _HIGHEST_ORDER:
            # two meshes so alike that hardly any power tells them apart
            return math.nan
        shift = math.log((ratio_fine**order - 1.0) / (ratio_coarse**order - 1.0))
        order = 0.5 * (order + abs(math.log(change) + shift) / math.log(ratio_fine))
    return order
