"""The most penetrating particle size: by refinement, and by Lee and Liu's formulas (Eqs. A30, A31)."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.analytics.formulas.cell import hydrodynamic_factor
from pipeline.analytics.formulas.numbers import Numbers
from pipeline.analytics.formulas.particles import BOLTZMANN
from pipeline.analytics.models import single_fiber
from pipeline.analytics.models.single_fiber import SingleFiberModel
from pipeline.nouns.arrays import Floats
from pipeline.nouns.flow import Flow

SMALLEST, LARGEST = 1e-9, 1e-5
"""Particle diameters between which the most penetrating one is sought [m]."""
_REFINEMENTS, _FINER = 6, 21  # each makes the grid ten times as fine


@dataclass(frozen=True, slots=True)
class MostPenetrating:
    """The particle size that a filter is least efficient at.

    Parameters
    ----------
    diameter : float [m]
    single_fiber : float [-]
        Combined single-fiber efficiency there.
    inside : bool
        Whether it is a true minimum; False where efficiency still falls at the end of the range searched.
    """

    diameter: float
    single_fiber: float
    inside: bool


def most_penetrating(
    model: SingleFiberModel, flow: Flow, solidity: float, fiber_diameter: float, particle_density: float
) -> MostPenetrating:
    """Find the particle size of least efficiency: on a grid that is refined about its least value.

    The thickness does not matter to it, since penetration falls with the single-fiber efficiency alone.

    Parameters
    ----------
    model : SingleFiberModel
    flow : Flow
    solidity : float [-]
    fiber_diameter : float [m]
    particle_density : float [kg/m3]

    Returns
    -------
    MostPenetrating
        Its diameter good to 1e-6 relative.
    """

    def efficiency(log_diameter: Numbers) -> Floats:
        aerosol = single_fiber.aerosol(model, flow, np.exp(log_diameter), particle_density)
        parts = single_fiber.single_fiber_efficiencies(model, aerosol, flow, solidity, fiber_diameter)
        return single_fiber.combined(model, parts)

    grid = np.linspace(np.log(SMALLEST), np.log(LARGEST), 241)
    lowest = int(np.argmin(efficiency(grid)))
    inside = 0 < lowest < len(grid) - 1
    for _ in range(_REFINEMENTS):
        here = int(np.argmin(efficiency(grid)))
        grid = np.linspace(grid[max(here - 1, 0)], grid[min(here + 1, len(grid) - 1)], _FINER)
    least = grid[int(np.argmin(efficiency(grid)))]
    return MostPenetrating(diameter=float(np.exp(least)), single_fiber=float(efficiency(least)), inside=inside)


def lee_liu_efficiency(solidity: Numbers, flow: Flow, fiber_diameter: Numbers, boltzmann: float = BOLTZMANN) -> Floats:
    r"""Least single-fiber efficiency, Eq. A30 [1]_.

    .. math:: \hat E_\Sigma = 1.44\left[\left(\frac{1-\alpha}{Ku}\right)^5 \left(\frac{\sqrt\lambda k T}{\eta}\right)^4
              \frac{1}{U_0^4 d_f^{10}}\right]^{1/9}

    Parameters
    ----------
    solidity : float or array [-]
    flow : Flow
    fiber_diameter : float or array [m]
    boltzmann : float [J/K]

    Returns
    -------
    array [-]

    Notes
    -----
    Interception and diffusion alone, with other constants than Eqs. A9 and A23: do not expect it to match
    `most_penetrating` (Fig. 10: 235 nm against 215 nm).

    References
    ----------
    .. [1] K. W. Lee and B. Y. H. Liu, On the minimum efficiency and the most penetrating particle size for fibrous
       filters, J. Air Pollut. Control Assoc. 30 (1980) 377-381.
    """
    share = np.asarray(solidity)
    crowding = (1.0 - share) / hydrodynamic_factor(share)
    value: Floats = 1.44 * (
        crowding**5 * _lee_liu_group(flow, boltzmann) ** 4 / (flow.face_velocity**4 * np.asarray(fiber_diameter) ** 10)
    ) ** (1.0 / 9.0)
    return value


def lee_liu_diameter(solidity: Numbers, flow: Flow, fiber_diameter: Numbers, boltzmann: float = BOLTZMANN) -> Floats:
    r"""Most penetrating particle diameter, Eq. A31 (source and caveat as for `lee_liu_efficiency`).

    .. math:: \hat d_p = 0.885\left[\frac{Ku}{1-\alpha}\,\frac{\sqrt\lambda k T}{\eta}\,\frac{d_f^2}{U_0}\right]^{2/9}

    Parameters
    ----------
    solidity : float or array [-]
    flow : Flow
    fiber_diameter : float or array [m]
    boltzmann : float [J/K]

    Returns
    -------
    array [m]
    """
    share = np.asarray(solidity)
    crowding = hydrodynamic_factor(share) / (1.0 - share)
    group = _lee_liu_group(flow, boltzmann) * np.asarray(fiber_diameter) ** 2 / flow.face_velocity
    value: Floats = 0.885 * (crowding * group) ** (2.0 / 9.0)
    return value


def _lee_liu_group(flow: Flow, boltzmann: float) -> float:
    return float(np.sqrt(flow.mean_free_path)) * boltzmann * flow.temperature / flow.viscosity
