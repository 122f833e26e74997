r"""How a small particle moves in air: Stokes' drag with slip, Brownian motion, settling, by Langevin's equation.

.. math:: \dot x = v, \qquad \tau \dot v = u + w - v + \sqrt{2D}\,\dot W

with the air's velocity u, the settling velocity w, the relaxation time :math:`\tau` and the diffusivity D.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import NamedTuple

from pipeline.geometry.compiled import compiled


class Motion(NamedTuple):
    """A particle as the steps see it.

    Parameters
    ----------
    contact : float [m]
        Distance of its center from a fiber's surface at which it touches: its radius, or 0 for a point.
    relaxation : float [s]
        0 for a particle without inertia.
    diffusivity : float [m2/s]
        0 for a particle without Brownian motion.
    settling_x, settling_y, settling_z : float [m/s]
        Terminal velocity in resting air.
    """

    contact: float
    relaxation: float
    diffusivity: float
    settling_x: float
    settling_y: float
    settling_z: float


class Step(NamedTuple):
    """What one step of a given length does to every particle of a kind, along each axis.

    Parameters
    ----------
    decay : float [-]
        Share of its velocity that a particle keeps.
    carried : float [s]
        How far that velocity carries it, per velocity.
    position : float [m]
        Standard deviation of the random part of the way.
    velocity_with_position : float [1/s]
        Random part of the velocity per random part of the way.
    velocity : float [m/s]
        Standard deviation of the rest of the velocity's random part.
    """

    decay: float
    carried: float
    position: float
    velocity_with_position: float
    velocity: float


@compiled
def step_of(dt: float, relaxation: float, diffusivity: float) -> Step:
    r"""Work out the exact update of position and velocity over a step (Ornstein and Uhlenbeck 1930 [1]_).

    Parameters
    ----------
    dt : float [s]
        Above 0, of any size against the relaxation time.
    relaxation : float [s]
    diffusivity : float [m2/s]

    Returns
    -------
    Step

    Notes
    -----
    With :math:`h = \Delta t/\tau` and :math:`e = e^{-h}`: the variance of the velocity's random part is
    :math:`(D/\tau)(1 - e^2)`, that of the way :math:`D\tau(2h - 3 + 4e - e^2)`, their covariance :math:`D(1 - e)^2`.
    So :math:`\langle v^2\rangle = D/\tau = kT/m`, whatever the step.

    References
    ----------
    .. [1] G. E. Uhlenbeck and L. S. Ornstein, Phys. Rev. 36 (1930) 823; D. L. Ermak and H. Buckholz, J. Comput. Phys.
       35 (1980) 169, doi:10.1016/0021-9991(80)90084-4.

    Examples
    --------
    >>> step = step_of(1e3, 1.0, 0.5)  # far beyond the relaxation time: 2 D t, less 3 D tau
    >>> round(step.position ** 2, 6)
    998.5
    """
    if relaxation <= 0.0:
        return Step(0.0, 0.0, math.sqrt(2.0 * diffusivity * dt), 0.0, 0.0)
    h = dt / relaxation
    lost = -math.expm1(-h)
    decay = 1.0 - lost
    if diffusivity <= 0.0:
        return Step(decay, relaxation * lost, 0.0, 0.0, 0.0)
    # the sum cancels to its third order
    spread = h**3 * (2.0 / 3.0 - 0.5 * h) if h < 1e-4 else 2.0 * h - 2.0 * lost - lost * lost
    way = diffusivity * relaxation * spread
    covariance = diffusivity * lost * lost
    variance = diffusivity / relaxation * lost * (1.0 + decay)
    rest = max(variance - covariance * covariance / way, 0.0)
    return Step(decay, relaxation * lost, math.sqrt(way), covariance / way, math.sqrt(rest))


@compiled
def moved(
    velocity: float, air: float, change: float, dt: float, relaxation: float, step: Step, first: float, second: float
) -> tuple[float, float]:
    r"""Give the way along one axis and the new velocity, for air whose velocity changes evenly over the step.

    Parameters
    ----------
    velocity : float [m/s]
        Of the particle, at the start.
    air, change : float [m/s]
        Of the air and settling together: at the start, and by how much it changes.
    dt, relaxation : float [s]
    step : Step
        Of this length.
    first, second : float [-]
        Independent normal numbers.

    Returns
    -------
    way : float [m]
    velocity : float [m/s]

    Notes
    -----
    Langevin's equation integrated: the way is that of the air less :math:`\tau` times the change of the particle's
    velocity, which keeps the drift of inertia for steps far longer than the relaxation time.
    """
    way = step.position * first
    if relaxation <= 0.0:
        return (air + 0.5 * change) * dt + way, air + change
    lost = 1.0 - step.decay
    share = step.carried / dt
    after = velocity * step.decay + air * lost + change * (1.0 - share)
    carried = (air + 0.5 * change) * dt - relaxation * (after - velocity)
    return carried + way, after + step.velocity_with_position * way + step.velocity * second
