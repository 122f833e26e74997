"""The single-fiber efficiency model as a whole: a record of the choices, and what it computes (Eqs. A5, A27 to A29)."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, get_args

import numpy as np

from pipeline.analytics.formulas import mechanisms, particles
from pipeline.analytics.formulas.numbers import Numbers
from pipeline.errors import CaseError
from pipeline.nouns.arrays import Floats
from pipeline.nouns.flow import Flow

MECHANISMS = ("interception", "diffusion", "diffusion_interception", "impaction", "gravity")
"""The mechanisms of Eq. A27; electrostatic forces are left out, as in the paper's figures."""

PresetName = Literal["paper", "table_a6", "hinds"]


@dataclass(frozen=True, slots=True)
class SingleFiberModel:
    """Which of the variants in use a single-fiber efficiency is computed with.

    Parameters
    ----------
    name : str
        For people to read.
    interception : {"exact", "simple", "slip"}
        Eq. A8, A9 or A11.
    cunningham : {"all", "simple"}
        Slip correction of the particles: Eq. A19 for all sizes, or Eq. A18.
    combination : {"sum", "product"}
        ``sum`` adds the mechanisms and may exceed 1; ``product`` is Eq. A27, each mechanism capped at 1 because
        the product is one of probabilities.
    gravity : {"across", "with", "against", "none"}
        Direction of gravity to the flow: G^2 (1 + R) across it, G (1 + R) with it, -G (1 + R) against it (Eq. A26).
    impaction_cutoff : float [-]
        Particle over fiber diameter above which J of Eq. A17 is 2.0; infinity where the formula is used everywhere.
    diffusion_factor : float [-]
        Of Eq. A23.
    boltzmann : float [J/K]
    source : str
    """

    name: str
    interception: Literal["exact", "simple", "slip"]
    cunningham: Literal["all", "simple"]
    combination: Literal["sum", "product"]
    gravity: Literal["across", "with", "against", "none"]
    impaction_cutoff: float = 0.4
    diffusion_factor: float = 2.0
    boltzmann: float = particles.BOLTZMANN
    source: str = ""


PRESETS = MappingProxyType(
    {
        "paper": SingleFiberModel(
            name="paper",
            interception="slip",
            cunningham="all",
            combination="sum",
            gravity="across",
            source="Beckman et al. 2021, as its Figs. 10 to 13 were computed",
        ),
        "table_a6": SingleFiberModel(
            name="table_a6",
            interception="simple",
            cunningham="all",
            combination="sum",
            gravity="across",
            source="Beckman et al. 2021, as its Table A6 was computed",
        ),
        "hinds": SingleFiberModel(
            name="hinds",
            interception="simple",
            cunningham="all",
            combination="product",
            gravity="with",
            boltzmann=1.380649e-23,
            source="Hinds, Aerosol Technology, 2nd ed., Wiley 1999, ch. 9, gravity with the flow",
        ),
    }
)
"""Models by name."""


def preset(name: str) -> SingleFiberModel:
    """Give the named model.

    Raises
    ------
    CaseError
        If there is no preset of that name.

    Examples
    --------
    >>> preset("table_a6").interception
    'simple'
    """
    if name not in PRESETS:
        raise CaseError(f"no single-fiber model {name!r}; write one of {', '.join(get_args(PresetName))}")
    return PRESETS[name]


@dataclass(frozen=True, eq=False, slots=True)
class Aerosol:
    """Particles in a given air: everything that does not depend on the filter. All arrays have the sizes' shape.

    Parameters
    ----------
    diameter : array [m]
    slip_correction : array [-]
    mobility : array [s/kg]
    diffusivity : array [m2/s]
    relaxation_time : array [s]
    settling_velocity : array [m/s]
    """

    diameter: Floats
    slip_correction: Floats
    mobility: Floats
    diffusivity: Floats
    relaxation_time: Floats
    settling_velocity: Floats


def aerosol(model: SingleFiberModel, flow: Flow, particle_diameter: Numbers, particle_density: float) -> Aerosol:
    """Work out how particles move in the air.

    Parameters
    ----------
    model : SingleFiberModel
    flow : Flow
    particle_diameter : float or array [m]
    particle_density : float [kg/m3]

    Returns
    -------
    Aerosol
    """
    diameter = np.asarray(particle_diameter, np.float64)
    correction = particles.cunningham if model.cunningham == "all" else particles.cunningham_simple
    slip = correction(diameter, flow.mean_free_path)
    mobility = np.asarray(particles.mobility(diameter, flow.viscosity, slip))
    relaxation = np.asarray(particles.relaxation_time(diameter, particle_density, flow.viscosity, slip))
    return Aerosol(
        diameter=diameter,
        slip_correction=slip,
        mobility=mobility,
        diffusivity=np.asarray(particles.diffusivity(mobility, flow.temperature, model.boltzmann)),
        relaxation_time=relaxation,
        settling_velocity=np.asarray(particles.settling_velocity(relaxation)),
    )


def single_fiber_efficiencies(
    model: SingleFiberModel, aerosol: Aerosol, flow: Flow, solidity: Numbers, fiber_diameter: Numbers
) -> dict[str, Floats]:
    """Single-fiber efficiency of each mechanism.

    Parameters
    ----------
    model : SingleFiberModel
    aerosol : Aerosol
    flow : Flow
    solidity : float or array [-]
    fiber_diameter : float or array [m]

    Returns
    -------
    dict of str to array [-]
        In the order of `MECHANISMS`.
    """
    velocity = flow.face_velocity
    ratio = aerosol.diameter / fiber_diameter
    peclet = particles.peclet(velocity, fiber_diameter, aerosol.diffusivity)
    stokes = particles.stokes_number(aerosol.relaxation_time, velocity, fiber_diameter)
    shape = mechanisms.impaction_shape(solidity, ratio, model.impaction_cutoff)
    return {
        "interception": _interception(model, solidity, ratio, 2.0 * flow.mean_free_path / fiber_diameter),
        "diffusion": mechanisms.diffusion(peclet, model.diffusion_factor),
        "diffusion_interception": mechanisms.diffusion_interception(solidity, ratio, peclet),
        "impaction": mechanisms.impaction(solidity, stokes, shape),
        "gravity": _gravity(model, particles.gravity_number(aerosol.settling_velocity, velocity), ratio),
    }


def _interception(model: SingleFiberModel, solidity: Numbers, ratio: Floats, knudsen: Numbers) -> Floats:
    if model.interception == "exact":
        return mechanisms.interception_exact(solidity, ratio)
    if model.interception == "simple":
        return mechanisms.interception(solidity, ratio)
    return mechanisms.interception_slip(solidity, ratio, knudsen)


def _gravity(model: SingleFiberModel, gravity: Numbers, ratio: Floats) -> Floats:
    if model.gravity == "across":
        return mechanisms.settling_across(gravity, ratio)
    sign = {"with": 1.0, "against": -1.0, "none": 0.0}[model.gravity]
    return sign * mechanisms.settling_along(gravity, ratio)


def combined(model: SingleFiberModel, efficiencies: dict[str, Floats]) -> Floats:
    r"""Single-fiber efficiency of all mechanisms together, Eq. A27 or the sum.

    .. math:: E_\Sigma = 1 - \prod_i (1 - E_i) \quad\text{or}\quad E_\Sigma = \sum_i E_i

    Erratum: the paper prints the product, and computes the sum throughout (5.46 % and 82.4 % in Table A6; the
    product gives 5.36 %).
    """
    if model.combination == "sum":
        total: Floats = np.sum([*efficiencies.values()], axis=0)
        return total
    missed = [1.0 - np.minimum(value, 1.0) for value in efficiencies.values()]
    caught: Floats = 1.0 - np.prod(missed, axis=0)
    return caught


def capture_depth(single_fiber: Numbers, solidity: Numbers, thickness: Numbers, fiber_diameter: Numbers) -> Floats:
    r"""How much a filter catches, on the scale on which layers add up: :math:`4\alpha E_\Sigma t / (\pi d_f)`.

    Parameters
    ----------
    single_fiber : float or array [-]
        Combined single-fiber efficiency.
    solidity : float or array [-]
    thickness, fiber_diameter : float or array [m]

    Returns
    -------
    array [-]
        Its exponential, :math:`P_F = e^{-depth}`, is the share that passes (Eq. A28), see `penetration`.

    Notes
    -----
    Brown's form has a further :math:`1/(1-\alpha)`, for the velocity between the fibers; the paper leaves it out.

    Examples
    --------
    >>> round(float(capture_depth(0.0546, 0.05, 1e-3, 2e-6)), 3)
    1.738
    """
    value: Floats = 4.0 / np.pi * np.asarray(solidity) * single_fiber * thickness / fiber_diameter
    return value


def penetration(depth: Numbers) -> Floats:
    r"""Share of the particles that pass the filter, Eq. A28: :math:`P_F = e^{-depth}`, of `capture_depth`.

    0 to 1 as long as no single-fiber efficiency is negative.

    Examples
    --------
    >>> round(float(penetration(1.738)), 3)
    0.176
    """
    value: Floats = np.exp(-np.asarray(depth))
    return value


def filter_efficiency(depth: Numbers) -> Floats:
    r"""Share of the particles that the filter holds back, Eqs. 1 and A29: :math:`E_F = 1 - P_F`, of `capture_depth`.

    Examples
    --------
    >>> round(float(filter_efficiency(1.738)), 3)
    0.824
    """
    value: Floats = -np.expm1(-np.asarray(depth))
    return value
