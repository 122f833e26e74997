"""Kuwabara's cell: one fiber in its share of the air, and the hydrodynamic factor that comes of it.

Table A1 and Eqs. A1 to A7 of the source paper (Beckman et al. 2021, doi 10.3390/fib9120084).
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.analytics.formulas.numbers import Numbers, Real
from pipeline.nouns.arrays import Floats


def reynolds(density: Numbers, fiber_diameter: Numbers, velocity: Numbers, viscosity: Numbers) -> Numbers:
    r"""Reynolds number of a fiber, Eq. A1: :math:`Re = \rho_g d_f U / \eta`.

    Parameters
    ----------
    density : float or array [kg/m3]
        Of the air.
    fiber_diameter : float or array [m]
    velocity : float or array [m/s]
        Face velocity.
    viscosity : float or array [Pa s]

    Returns
    -------
    float or array [-]
        The cell models neglect inertia; the paper asks for 0.05 or less.

    Examples
    --------
    >>> round(reynolds(1.2, 2e-6, 0.1, 1.813e-5), 5)
    0.01324
    """
    return density * fiber_diameter * velocity / viscosity


def hydrodynamic_factor(solidity: Real) -> Real:
    r"""Kuwabara's hydrodynamic factor, Eq. A2 [1]_.

    .. math:: Ku = -\tfrac12\ln\alpha - \tfrac34 + \alpha - \tfrac{\alpha^2}{4}

    Parameters
    ----------
    solidity : float or array [-]
        Between 0 and 1.

    Returns
    -------
    float or array [-]
        Above 0; 0 only at solidity 1.

    References
    ----------
    .. [1] S. Kuwabara, The forces experienced by randomly distributed parallel circular cylinders or spheres in a
       viscous flow at small Reynolds numbers, J. Phys. Soc. Japan 14 (1959) 527-532, doi 10.1143/JPSJ.14.527.

    Examples
    --------
    >>> round(float(hydrodynamic_factor(0.05)), 3)
    0.797
    """
    factor: Real = -0.5 * np.log(solidity) - 0.75 + solidity - 0.25 * solidity * solidity
    return factor


def cell_radius(fiber_radius: Numbers, solidity: Numbers) -> Floats:
    r"""Outer radius of the cell, Table A1: :math:`b = r_f / \sqrt{\alpha}` [m].

    Examples
    --------
    >>> f"{cell_radius(1e-6, 0.04):.1e}"
    '5.0e-06'
    """
    radius: Floats = fiber_radius / np.sqrt(solidity)
    return radius


def stream_function(
    radius: Numbers, angle: Numbers, solidity: Numbers, velocity: Numbers, fiber_radius: Numbers
) -> Floats:
    r"""Stream function in Kuwabara's cell, Eq. A3 as it must read.

    .. math:: \psi = \frac{\nu r}{2 Ku}\left(2\ln\frac{r}{r_f} - 1 + \alpha
              + \frac{r_f^2}{r^2}\left(1 - \frac{\alpha}{2}\right) - \frac{\alpha}{2}\frac{r^2}{r_f^2}\right)\sin\theta

    Parameters
    ----------
    radius : float or array [m]
        Distance from the fiber's axis, from `fiber_radius` to `cell_radius`.
    angle : float or array [rad]
        From the direction of the flow.
    solidity : float or array [-]
    velocity : float or array [m/s]
        Of the air at the cell's boundary.
    fiber_radius : float or array [m]

    Returns
    -------
    array [m2/s]
        0 on the fiber, :math:`\nu\,b\sin\theta` on the cell's boundary (Eq. A4).

    Notes
    -----
    Erratum: the print has :math:`r_f^2 (1 - \alpha/2)` for the third term; only with :math:`r_f^2/r^2` does the
    fiber's surface become a streamline and Eq. A8 follow. Table A1 gives the boundary the velocity
    :math:`U_0/(1-\alpha)`; the cell model's drag is right only with the face velocity :math:`U_0` there.

    Examples
    --------
    >>> round(float(stream_function(5e-6, 1.5707963, 0.04, 0.1, 1e-6)) / (0.1 * 5e-6), 9)
    1.0
    """
    ratio = np.asarray(radius / fiber_radius)
    bracket = 2.0 * np.log(ratio) - 1.0 + solidity + (1.0 - solidity / 2.0) / ratio**2 - 0.5 * solidity * ratio**2
    value: Floats = velocity * radius / (2.0 * hydrodynamic_factor(np.asarray(solidity))) * bracket * np.sin(angle)
    return value
