"""How one fiber catches particles: interception, impaction, diffusion, their interplay, gravity (Eqs. A6 to A26).

Each function gives the single-fiber efficiency of one mechanism, the share of the particles heading for the
fiber's cross section that it catches. All broadcast over their arguments.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.analytics.formulas.cell import hydrodynamic_factor
from pipeline.analytics.formulas.numbers import Numbers
from pipeline.nouns.arrays import Floats


def usual_mechanisms(particle_diameter: float) -> tuple[str, ...]:
    """Name the mechanisms that usually catch particles of this size, Table A2.

    Parameters
    ----------
    particle_diameter : float [m]

    Returns
    -------
    tuple of str
        Empty from 200 to 300 nm, where the table names none: near the most penetrating size.

    Notes
    -----
    Erratum: the table prints its sizes as micrometers; they are nanometers.

    Examples
    --------
    >>> usual_mechanisms(50e-9), usual_mechanisms(600e-9)
    (('diffusion',), ('impaction', 'gravity'))
    """
    size = particle_diameter / 1e-9
    ranges = {"diffusion": (0.0, 100.0), "interception": (100.0, 200.0), "impaction": (300.0, np.inf)}
    ranges["gravity"] = (500.0, np.inf)
    return tuple(name for name, (low, high) in ranges.items() if low < size < high)


def interception_exact(solidity: Numbers, ratio: Numbers) -> Floats:
    r"""Single-fiber efficiency of interception in Kuwabara's cell without approximation, Eqs. A6 and A8 [1]_.

    .. math:: E_R = \frac{1+R}{2Ku}\left(2\ln(1+R) - 1 + \alpha + \frac{1 - \alpha/2}{(1+R)^2}
              - \frac{\alpha}{2}(1+R)^2\right)

    Parameters
    ----------
    solidity : float or array [-]
    ratio : float or array [-]
        Particle diameter over fiber diameter, R (Eq. A7); the particle must fit into the cell,
        1 + R below 1 / sqrt(solidity).

    Returns
    -------
    array [-]

    Notes
    -----
    It is Eq. A6: the stream function of `cell.stream_function` one particle radius off the fiber, over
    :math:`\nu r_f`.

    References
    ----------
    .. [1] K. W. Lee and B. Y. H. Liu, Theoretical study of aerosol filtration by fibrous filters,
       Aerosol Sci. Technol. 1 (1982) 147-161, doi 10.1080/02786828208958584.

    Examples
    --------
    >>> round(float(interception_exact(0.05, 0.15)), 4)
    0.0243
    """
    edge = 1.0 + np.asarray(ratio)
    bracket = 2.0 * np.log(edge) - 1.0 + solidity + (1.0 - solidity / 2.0) / edge**2 - 0.5 * solidity * edge**2
    value: Floats = edge * bracket / (2.0 * hydrodynamic_factor(np.asarray(solidity)))
    return value


def interception(solidity: Numbers, ratio: Numbers) -> Floats:
    r"""Single-fiber efficiency of interception, Lee and Liu's simple form, Eq. A9 [1]_.

    .. math:: E_R = \frac{(1-\alpha)R^2}{Ku\,(1+R)}

    Parameters
    ----------
    solidity : float or array [-]
    ratio : float or array [-]
        Particle diameter over fiber diameter.

    Returns
    -------
    array [-]
        Up to 5 % below `interception_exact` for R up to 0.15, up to 11 % for R up to 0.4 (solidity up to 0.3).

    References
    ----------
    .. [1] K. W. Lee and B. Y. H. Liu, Theoretical study of aerosol filtration by fibrous filters,
       Aerosol Sci. Technol. 1 (1982) 147-161, doi 10.1080/02786828208958584.

    Examples
    --------
    >>> round(float(interception(0.05, 0.15)), 4)
    0.0233
    """
    return _lee_liu_interception(solidity, ratio, hydrodynamic_factor(np.asarray(solidity)))


def interception_slip(solidity: Numbers, ratio: Numbers, knudsen: Numbers) -> Floats:
    r"""Single-fiber efficiency of interception with the paper's slip term, Eq. A11.

    .. math:: E_R = \frac{(1-\alpha)R^2}{(Ku + Kn)(1+R)}

    Parameters
    ----------
    solidity : float or array [-]
    ratio : float or array [-]
        Particle diameter over fiber diameter.
    knudsen : float or array [-]
        Of the fiber, twice the mean free path over its diameter (Eq. A10).

    Returns
    -------
    array [-]

    Notes
    -----
    Erratum: air that slips along the fiber carries more particles past it within reach, so the usual slip
    corrections raise interception; this one lowers it. It is offered because the paper computed with it.

    Examples
    --------
    >>> round(float(interception_slip(0.0948, 3 / 14, 2 * 65.3e-9 / 1.4e-6)), 4)
    0.0558
    """
    return _lee_liu_interception(solidity, ratio, hydrodynamic_factor(np.asarray(solidity)) + knudsen)


def _lee_liu_interception(solidity: Numbers, ratio: Numbers, factor: Numbers) -> Floats:
    value: Floats = (1.0 - solidity) * ratio**2 / (factor * (1.0 + np.asarray(ratio)))
    return value


def impaction_shape(solidity: Numbers, ratio: Numbers, cutoff: float = 0.4, plateau: float = 2.0) -> Floats:
    r"""Factor J of inertial impaction, Eq. A17 [1]_: :math:`J = (29.6 - 28\alpha^{0.62})R^2 - 27.5 R^{2.8}`.

    Parameters
    ----------
    solidity : float or array [-]
        0.0035 to 0.111.
    ratio : float or array [-]
        Particle diameter over fiber diameter, 0.01 to 0.4 for the formula.
    cutoff : float [-]
        Above this ratio J is `plateau`; infinity uses the formula everywhere, as the paper prints it.
    plateau : float [-]

    Returns
    -------
    array [-]

    Notes
    -----
    Erratum: the paper prints no range, but the formula turns negative beyond R of about 0.8, and its Figs. 12 and
    13 come out only with Hinds' J = 2.0 for R > 0.4.

    References
    ----------
    .. [1] W. C. Hinds, Aerosol Technology, 2nd ed., Wiley 1999, ch. 9; after H. C. Yeh and B. Y. H. Liu, Aerosol
       filtration by fibrous filters I, J. Aerosol Sci. 5 (1974) 191-204.

    Examples
    --------
    >>> round(float(impaction_shape(0.05, 0.15)), 3)
    0.432
    """
    size = np.asarray(ratio)
    formula = (29.6 - 28.0 * np.asarray(solidity) ** 0.62) * size**2 - 27.5 * size**2.8
    value: Floats = np.where(size > cutoff, plateau, formula)
    return value


def impaction(solidity: Numbers, stokes: Numbers, shape: Numbers) -> Floats:
    r"""Inertial impaction, Eq. A17: :math:`E_I = Stk\,J / (2 Ku^2)`.

    Parameters
    ----------
    solidity : float or array [-]
    stokes : float or array [-]
        Stokes number on the fiber's diameter (Eq. A16); small against 1.
    shape : float or array [-]
        J, see `impaction_shape`.

    Returns
    -------
    array [-]
        Exceeds 1 at large Stokes numbers, where the formula no longer holds.

    Examples
    --------
    >>> round(float(impaction(0.05, 0.02134, 0.432)), 5)
    0.00725
    """
    value: Floats = stokes * shape / (2.0 * hydrodynamic_factor(np.asarray(solidity)) ** 2)
    return value


def diffusion(peclet: Numbers, factor: float = 2.0) -> Floats:
    r"""Brownian diffusion, Eq. A23 (Hinds): :math:`E_D = 2\,Pe^{-2/3}`.

    Parameters
    ----------
    peclet : float or array [-]
        Of fiber diameter and face velocity (Eq. A22); large against 1.
    factor : float [-]
        2 in the paper.

    Returns
    -------
    array [-]
        Exceeds 1 for Pe below 2.8, where the formula no longer holds.

    Examples
    --------
    >>> round(float(diffusion(1638.2)), 5)
    0.01439
    """
    value: Floats = factor * np.asarray(peclet) ** (-2.0 / 3.0)
    return value


def diffusion_interception(solidity: Numbers, ratio: Numbers, peclet: Numbers) -> Floats:
    r"""Extra catch of diffusing particles by interception, Eq. A24: :math:`E_{DR} = 1.24\,R^{2/3} / \sqrt{Ku\,Pe}`.

    Parameters
    ----------
    solidity : float or array [-]
    ratio : float or array [-]
        Particle diameter over fiber diameter.
    peclet : float or array [-]

    Returns
    -------
    array [-]

    Examples
    --------
    >>> round(float(diffusion_interception(0.05, 0.15, 1638.2)), 5)
    0.00969
    """
    factor = hydrodynamic_factor(np.asarray(solidity))
    value: Floats = 1.24 * np.asarray(ratio) ** (2.0 / 3.0) / np.sqrt(factor * peclet)
    return value


def settling_along(gravity: Numbers, ratio: Numbers) -> Floats:
    r"""Settling where gravity and flow point the same way, Eq. A26: :math:`E_G = G (1 + R)`.

    Against the flow it counts negative. `gravity` is G of Eq. A25, `ratio` is R.

    Examples
    --------
    >>> f"{float(settling_along(4.19e-5, 0.15)):.2e}"
    '4.82e-05'
    """
    value: Floats = gravity * (1.0 + np.asarray(ratio))
    return value


def settling_across(gravity: Numbers, ratio: Numbers) -> Floats:
    r"""Settling across the flow: :math:`E_G = G^2 (1 + R)`, what Table A6 computes for its gravity row.

    Erratum: Table A6 does not use Eq. A26. `gravity` is G of Eq. A25, `ratio` is R.

    Examples
    --------
    >>> f"{float(settling_across(4.19e-5, 0.15)):.2e}"
    '2.02e-09'
    """
    value: Floats = np.asarray(gravity) ** 2 * (1.0 + np.asarray(ratio))
    return value
