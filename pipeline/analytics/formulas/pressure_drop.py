r"""Pressure drop of fiber filters: one dimensionless function of solidity per author (Eqs. 2, A32, A33, Table A4).

Every function gives :math:`f = \Delta p\, d^2 / (\eta\, U\, t)`, takes a number or an array, and holds without slip
at low Reynolds numbers. `spielman_goren` and `slip` hold the models that need more than a line.
`pressure_models` lists them all with their ranges.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.analytics.formulas.cell import hydrodynamic_factor
from pipeline.analytics.formulas.numbers import Numbers, Real
from pipeline.nouns.arrays import Floats


def pressure_drop(
    coefficient: Numbers, viscosity: Numbers, velocity: Numbers, thickness: Numbers, fiber_diameter: Numbers
) -> Numbers:
    r"""Pressure drop of a filter, Eq. A32: :math:`\Delta p = f\,\eta\,U\,t/d^2`.

    Parameters
    ----------
    coefficient : float or array [-]
        f of one of the models.
    viscosity : float or array [Pa s]
    velocity : float or array [m/s]
        Face velocity.
    thickness, fiber_diameter : float or array [m]

    Returns
    -------
    float or array [Pa]

    Examples
    --------
    >>> round(pressure_drop(davies(0.05), 1.813e-5, 0.1, 1e-3, 2e-6), 1)
    326.6
    """
    return coefficient * viscosity * velocity * thickness / fiber_diameter**2


def effective_fiber_diameter(
    coefficient: Numbers, viscosity: Numbers, velocity: Numbers, thickness: Numbers, pressure_drop: Numbers
) -> Floats:
    r"""Diameter that a measured pressure drop stands for, Eq. A33: :math:`d_{fe} = \sqrt{f\,\eta\,U\,t/\Delta p}` [m].

    Parameters
    ----------
    coefficient : float or array [-]
        f of one of the models, at the filter's solidity.
    viscosity : float or array [Pa s]
    velocity : float or array [m/s]
        Face velocity.
    thickness : float or array [m]
    pressure_drop : float or array [Pa]

    Returns
    -------
    array [m]

    Examples
    --------
    >>> f"{effective_fiber_diameter(davies(0.05), 1.813e-5, 0.1, 1e-3, 326.59):.2e}"
    '2.00e-06'
    """
    diameter: Floats = np.sqrt(coefficient * viscosity * velocity * thickness / np.asarray(pressure_drop))
    return diameter


def drag_from_coefficient(coefficient: Numbers, solidity: Numbers) -> Numbers:
    r"""Drag per fiber length over :math:`\eta U`, :math:`F^* = \pi f / (4\alpha)`.

    The drag of all fibers in a volume is the pressure drop across it.

    Examples
    --------
    >>> round(drag_from_coefficient(0.4, 0.01), 4)
    31.4159
    """
    return np.pi * coefficient / (4.0 * solidity)


def davies(solidity: Real) -> Real:
    r"""Davies' fit to measured pads, Eq. 2 and Table A4 [1]_: :math:`f = 64\,\alpha^{3/2}(1 + 56\alpha^3)`.

    Parameters
    ----------
    solidity : float or array [-]
        0.006 to 0.3.

    Returns
    -------
    float or array [-]

    Notes
    -----
    Erratum: the paper prints the last exponent as -3; its Table A6 (0.7206 at 0.05) shows +3.

    References
    ----------
    .. [1] C. N. Davies, The separation of airborne dust and particles, Proc. Inst. Mech. Eng. 1B (1952) 185-213.

    Examples
    --------
    >>> round(davies(0.05), 4)
    0.7206
    """
    coefficient: Real = 64.0 * solidity**1.5 * (1.0 + 56.0 * solidity**3)
    return coefficient


def kuwabara(solidity: Real) -> Real:
    r"""Kuwabara's cell of no vorticity, Table A4 [1]_: :math:`f = 16\alpha/Ku`.

    Parameters
    ----------
    solidity : float or array [-]
        Parallel cylinders across the flow; within 0.4 % of the exact hexagonal array up to 0.3.

    Returns
    -------
    float or array [-]

    Notes
    -----
    Erratum: the paper prints :math:`-4\alpha^{(1+\alpha)}/[2\ln\alpha + 3 - 4\alpha + \alpha^2]`; the bracket is
    :math:`-4 Ku`, the numerator must be :math:`-64\alpha`.

    References
    ----------
    .. [1] S. Kuwabara, The forces experienced by randomly distributed parallel circular cylinders or spheres in a
       viscous flow at small Reynolds numbers, J. Phys. Soc. Japan 14 (1959) 527-532, doi 10.1143/JPSJ.14.527.

    Examples
    --------
    >>> round(float(kuwabara(0.05)), 4)
    1.0035
    """
    return 16.0 * solidity / hydrodynamic_factor(solidity)


def happel(solidity: Real) -> Real:
    r"""Happel's cell of no shear, Table A4 [1]_: :math:`f = 32\alpha/(-\ln\alpha - (1-\alpha^2)/(1+\alpha^2))`.

    Parameters
    ----------
    solidity : float or array [-]
        Parallel cylinders across the flow.

    Returns
    -------
    float or array [-]

    Notes
    -----
    Erratum: the paper prints :math:`(1-\alpha)^2/2` for the fraction, which gives 0.629 instead of 0.800 at 0.05.

    References
    ----------
    .. [1] J. Happel, Viscous flow relative to arrays of cylinders, AIChE J. 5 (1959) 174-177,
       doi 10.1002/aic.690050211.

    Examples
    --------
    >>> round(float(happel(0.05)), 4)
    0.7997
    """
    square = solidity * solidity
    coefficient: Real = 32.0 * solidity / (-np.log(solidity) - (1.0 - square) / (1.0 + square))
    return coefficient


def henry_ariman(solidity: Real) -> Real:
    r"""Henry and Ariman's fit to computed staggered arrays, Table A4 [1]_.

    .. math:: f = 4\,(2.446\alpha + 38.16\alpha^2 + 138.9\alpha^3)

    Parameters
    ----------
    solidity : float or array [-]
        A polynomial through 0 cannot follow the logarithm of the dilute limit: see `pressure_models` for the range
        in which it was found close to the exact hexagonal array.

    Returns
    -------
    float or array [-]

    Notes
    -----
    Erratum: the paper uses the polynomial with the fiber's diameter; it is on the radius, hence the factor 4.

    References
    ----------
    .. [1] F. S. Henry and T. Ariman, An evaluation of the Kuwabara model, Particul. Sci. Technol. 1 (1983) 1-20.

    Examples
    --------
    >>> round(henry_ariman(0.05), 3)
    0.94
    """
    return 4.0 * solidity * (2.446 + solidity * (38.16 + solidity * 138.9))


def rao_faghri(solidity: Real) -> Real:
    r"""Rao and Faghri's fit to computed staggered arrays, Table A4 [1]_.

    .. math:: f = 4\,(2.653\alpha + 39.34\alpha^2 + 144.5\alpha^3)

    Parameters
    ----------
    solidity : float or array [-]
        As for `henry_ariman`.

    Returns
    -------
    float or array [-]

    Notes
    -----
    Erratum: the paper uses the polynomial with the fiber's diameter; it is on the radius, hence the factor 4. With it
    the values at 0.05, 0.0948 and 0.2 are those of the exact hexagonal array within 0.6 %.

    References
    ----------
    .. [1] N. Rao and M. Faghri, Computer modeling of aerosol filtration by fibrous filters,
       Aerosol Sci. Technol. 8 (1988) 133-156.

    Examples
    --------
    >>> round(rao_faghri(0.05), 3), round(rao_faghri(0.0948), 3), round(rao_faghri(0.2), 2)
    (0.996, 2.913, 13.04)
    """
    return 4.0 * solidity * (2.653 + solidity * (39.34 + solidity * 144.5))


def drummond_tahir_square(solidity: Real) -> Real:
    r"""Drummond and Tahir's series for a square array across the flow [1]_.

    .. math:: \frac{k}{r^2} = \frac{1}{8\alpha}(-\ln\alpha - 1.47633597 + 2\alpha - 1.77428264\alpha^2
              + 4.07770444\alpha^3 - 4.84227402\alpha^4), \qquad f = 4 r^2/k

    Parameters
    ----------
    solidity : float or array [-]
        Within 0.01 % of the exact drag up to 0.1, 0.15 % at 0.2, 2.3 % at 0.3.

    Returns
    -------
    float or array [-]

    References
    ----------
    .. [1] J. E. Drummond and M. I. Tahir, Laminar viscous flow through regular arrays of parallel solid cylinders,
       Int. J. Multiphase Flow 10 (1984) 515-540, doi 10.1016/0301-9322(84)90079-X.

    Examples
    --------
    >>> round(float(drag_from_coefficient(drummond_tahir_square(0.05), 0.05)), 3)
    15.558
    """
    tail = solidity * (2.0 + solidity * (-1.77428264 + solidity * (4.07770444 - solidity * 4.84227402)))
    coefficient: Real = 32.0 * solidity / (-np.log(solidity) - 1.47633597 + tail)
    return coefficient


def drummond_tahir_hexagonal(solidity: Real) -> Real:
    r"""Drummond and Tahir's series for a hexagonal array across the flow [1]_.

    .. math:: \frac{k}{r^2} = \frac{1}{8\alpha}\left(-\ln\alpha - 1.497 + 2\alpha - \frac{\alpha^2}{2} - 0.739\alpha^4
              + \frac{2.534\alpha^5}{1 + 1.2758\alpha}\right), \qquad f = 4 r^2/k

    Parameters
    ----------
    solidity : float or array [-]
        Within 0.11 % of the exact drag up to 0.2, 0.3 % at 0.3.

    Returns
    -------
    float or array [-]

    References
    ----------
    .. [1] J. E. Drummond and M. I. Tahir, Laminar viscous flow through regular arrays of parallel solid cylinders,
       Int. J. Multiphase Flow 10 (1984) 515-540, doi 10.1016/0301-9322(84)90079-X.

    Examples
    --------
    >>> round(float(drummond_tahir_hexagonal(0.05)), 3)
    1.002
    """
    end = 2.534 * solidity / (1.0 + 1.2758 * solidity) - 0.739
    tail = solidity * (2.0 - 0.5 * solidity) + end * solidity**4
    coefficient: Real = 32.0 * solidity / (-np.log(solidity) - 1.497 + tail)
    return coefficient


def jackson_james(solidity: Real) -> Real:
    r"""Jackson and James' dilute limit for fibers in all directions [1]_.

    .. math:: \frac{k}{r^2} = \frac{3}{20\alpha}(-\ln\alpha - 0.931), \qquad f = 4 r^2/k

    Parameters
    ----------
    solidity : float or array [-]
        Dilute, up to about 0.05, where the terms left out come to 5 %; has no answer (infinity) above 0.394.

    Returns
    -------
    float or array [-]

    References
    ----------
    .. [1] G. W. Jackson and D. F. James, The permeability of fibrous porous media, Can. J. Chem. Eng. 64 (1986)
       364-374, doi 10.1002/cjce.5450640302.

    Examples
    --------
    >>> round(float(jackson_james(0.01)), 4)
    0.0726
    """
    room = np.maximum(-np.log(solidity) - 0.931, 0.0)
    with np.errstate(divide="ignore"):
        coefficient: Real = 80.0 / 3.0 * solidity / room
    return coefficient
