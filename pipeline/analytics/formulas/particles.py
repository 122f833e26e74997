"""What air does to a small particle: slip, drag, mobility, diffusion, inertia, settling (Eqs. A12 to A25)."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.analytics.formulas.numbers import Numbers
from pipeline.nouns.arrays import Floats

BOLTZMANN = 1.38e-23
"""Boltzmann's constant as the paper rounds it [J/K]."""

GRAVITY = 9.81
"""Acceleration of gravity [m/s2], Table A5."""


def cunningham_simple(particle_diameter: Numbers, mean_free_path: Numbers) -> Floats:
    r"""Slip correction for particles above 0.1 um, Eq. A18 (Hinds): :math:`C_c = 1 + 2.52\,\lambda/d_p`.

    Parameters
    ----------
    particle_diameter, mean_free_path : float or array [m]

    Returns
    -------
    array [-]
        10 % below `cunningham` at 0.1 um, within 2 % of it from 0.25 um.

    Examples
    --------
    >>> round(float(cunningham_simple(300e-9, 65.3e-9)), 4)
    1.5485
    """
    value: Floats = 1.0 + 2.52 * np.asarray(mean_free_path / particle_diameter)
    return value


def cunningham(particle_diameter: Numbers, mean_free_path: Numbers) -> Floats:
    r"""Slip correction for all sizes, Eq. A19 (Hinds).

    .. math:: C_c = 1 + \frac{\lambda}{d_p}\left(2.34 + 1.05\,e^{-0.39\,d_p/\lambda}\right)

    Parameters
    ----------
    particle_diameter, mean_free_path : float or array [m]

    Returns
    -------
    array [-]
        Stokes' drag is too large by this factor; 1 for particles large against the mean free path.

    Examples
    --------
    >>> round(float(cunningham(300e-9, 65.3e-9)), 3)
    1.547
    """
    ratio = np.asarray(mean_free_path / particle_diameter)
    value: Floats = 1.0 + ratio * (2.34 + 1.05 * np.exp(-0.39 / ratio))
    return value


def mass(particle_diameter: Numbers, particle_density: Numbers) -> Numbers:
    """Mass of a ball [kg].

    Erratum: Table A6 prints 14.14 ag; it is 14.14 fg, as its own SI column says.

    Examples
    --------
    >>> f"{mass(300e-9, 1000.0):.3e}"
    '1.414e-17'
    """
    return np.pi / 6.0 * particle_density * particle_diameter**3


def drag(velocity: Numbers, particle_diameter: Numbers, viscosity: Numbers, slip_correction: Numbers = 1.0) -> Numbers:
    r"""Drag on a particle, Eq. A12 as it must read: :math:`F_d = 3\pi\eta v d_p / C_c` [N].

    Erratum: the paper leaves out the slip correction, and its Table A6 enters the face velocity;
    with `slip_correction` 1 this is the printed form.

    Examples
    --------
    >>> f"{drag(0.1, 300e-9, 1.813e-5):.2e}"
    '5.13e-12'
    """
    return 3.0 * np.pi * viscosity * velocity * particle_diameter / slip_correction


def mobility(particle_diameter: Numbers, viscosity: Numbers, slip_correction: Numbers) -> Numbers:
    r"""Velocity per force, Eq. A13: :math:`B = C_c / (3\pi\eta d_p)` [s/kg].

    Examples
    --------
    >>> f"{mobility(300e-9, 1.813e-5, 1.547):.2e}"
    '3.02e+10'
    """
    return slip_correction / (3.0 * np.pi * viscosity * particle_diameter)


def relaxation_time(
    particle_diameter: Numbers, particle_density: Numbers, viscosity: Numbers, slip_correction: Numbers
) -> Numbers:
    r"""Time in which a particle takes on 63 % of a new velocity, Eq. A14: :math:`\tau = \rho_p d_p^2 C_c / 18\eta` [s].

    Examples
    --------
    >>> f"{relaxation_time(300e-9, 1000.0, 1.813e-5, 1.547):.2e}"
    '4.27e-07'
    """
    return particle_density * particle_diameter**2 * slip_correction / (18.0 * viscosity)


def stopping_distance(relaxation_time: Numbers, velocity: Numbers) -> Numbers:
    r"""Way that a particle coasts, Eq. A15: :math:`S = \tau v_0` [m].

    Examples
    --------
    >>> f"{stopping_distance(4.27e-7, 0.1):.2e}"
    '4.27e-08'
    """
    return relaxation_time * velocity


def stokes_number(relaxation_time: Numbers, velocity: Numbers, fiber_diameter: Numbers) -> Numbers:
    r"""Inertia of a particle against a fiber's size, Eq. A16: :math:`Stk = \tau U_0 / d_f`.

    Examples
    --------
    >>> round(stokes_number(4.268e-7, 0.1, 2e-6), 5)
    0.02134
    """
    return stopping_distance(relaxation_time, velocity) / fiber_diameter


def diffusivity(mobility: Numbers, temperature: Numbers, boltzmann: float = BOLTZMANN) -> Numbers:
    r"""Diffusion coefficient of a particle, Eq. A21: :math:`D = k T B` [m2/s].

    Examples
    --------
    >>> f"{diffusivity(3.019e10, 293.0):.3e}"
    '1.221e-10'
    """
    return boltzmann * temperature * mobility


def peclet(velocity: Numbers, fiber_diameter: Numbers, diffusivity: Numbers) -> Numbers:
    r"""Advection over diffusion, Eq. A22: :math:`Pe = U_0 d_f / D`.

    Erratum: the print names the velocity in the cell; Table A6 enters the face velocity, and so does this.

    Examples
    --------
    >>> round(peclet(0.1, 2e-6, 1.221e-10))
    1638
    """
    return velocity * fiber_diameter / diffusivity


def settling_velocity(relaxation_time: Numbers) -> Numbers:
    r"""Terminal velocity under gravity: :math:`V_{TS} = \tau g` [m/s].

    Examples
    --------
    >>> f"{settling_velocity(4.27e-7):.2e}"
    '4.19e-06'
    """
    return relaxation_time * GRAVITY


def gravity_number(settling_velocity: Numbers, velocity: Numbers) -> Numbers:
    r"""Settling velocity over face velocity, Eq. A25: :math:`G = V_{TS}/U_0 = \rho_p d_p^2 C_c g / (18\eta U_0)`.

    Erratum: the print has the air's density; Table A6 comes out only with the particle's.

    Examples
    --------
    >>> f"{gravity_number(4.19e-6, 0.1):.2e}"
    '4.19e-05'
    """
    return settling_velocity / velocity
