"""Everything the analytical models say of one filter, as one record that writes to JSON."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.analytics.formulas import merit, slip
from pipeline.analytics.formulas.cell import reynolds
from pipeline.analytics.formulas.diameters import mat_diameters
from pipeline.analytics.formulas.penetrating import lee_liu_diameter, lee_liu_efficiency, most_penetrating
from pipeline.analytics.formulas.polydisperse import lognormal_mean, mass_median
from pipeline.analytics.formulas.pressure_drop import pressure_drop
from pipeline.analytics.models import single_fiber
from pipeline.analytics.models.comparison import nominal_solidity
from pipeline.analytics.models.pressure_models import MODELS, pressure_model
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.errors import CaseError
from pipeline.nouns.arrays import Floats
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Flow


@dataclass(frozen=True, slots=True)
class Prediction:
    """What the models say of one filter; `dataclasses.asdict` of it is what ``fibertwin predict --json`` prints.

    Parameters
    ----------
    solidity : float [-]
    thickness, fiber_diameter, particle_diameter : float [m]
    face_velocity : float [m/s]
    temperature : float [K]
    viscosity : float [Pa s]
    density : float [kg/m3]
    mean_free_path : float [m]
    preset : str
        Single-fiber model.
    pressure_model : str
        The pressure-drop model that figure of merit and HEPA check use.
    reynolds, knudsen : float [-]
        Of the fiber.
    regime : str
        Flow regime (Table A3).
    pressure_drop : dict of str to float or None [Pa]
        By model; None where a model has no answer.
    notes : dict of str to tuple of str
        What is outside a model's range, by model.
    single_fiber : dict of str to float [-]
        Single-fiber efficiency at `particle_diameter`: ``total`` and one per mechanism.
    efficiency : dict of str to float [-]
        The filter's efficiency at `particle_diameter`: ``total``, and what each mechanism would reach alone (the curves
        of Fig. A8).
    aerosol : dict of str to float
        ``spread`` [-] of the particle sizes; the filter's efficiency over all of them by ``count`` and by ``mass`` [-].
    mpps : dict of str to float
        ``diameter`` [m] of the most penetrating particles and the filter's ``efficiency`` [-] there; the same after Lee
        and Liu (``lee_liu_diameter``, ``lee_liu_efficiency``).
    figure_of_merit : dict of str to float or None [1/Pa]
        ``a34``: -ln(P)/dp of Eq. A34; ``paper``: E/dp, what the paper prints. At `particle_diameter`.
    hepa : dict of str to float or bool or None
        ``efficiency`` [-] at 300 nm and 2.5 cm/s, ``pressure_drop`` [Pa] at 2.5 cm/s, ``passes``.
    warnings : tuple of str
        What is odd about the whole.
    """

    solidity: float
    thickness: float
    fiber_diameter: float
    particle_diameter: float
    face_velocity: float
    temperature: float
    viscosity: float
    density: float
    mean_free_path: float
    preset: str
    pressure_model: str
    reynolds: float
    knudsen: float
    regime: str
    pressure_drop: dict[str, float | None]
    notes: dict[str, tuple[str, ...]]
    single_fiber: dict[str, float]
    efficiency: dict[str, float]
    aerosol: dict[str, float]
    mpps: dict[str, float]
    figure_of_merit: dict[str, float | None]
    hepa: dict[str, float | bool | None]
    warnings: tuple[str, ...]


def predict(medium: FilterSettings, settings: FlowSettings) -> Prediction:
    """Apply every model to one filter.

    Parameters
    ----------
    medium : FilterSettings
    settings : FlowSettings

    Returns
    -------
    Prediction

    Examples
    --------
    >>> figure_12 = FilterSettings(solidity=0.1198, thickness=42.3e-6, fiber_diameter=0.5e-6)
    >>> prediction = predict(figure_12, FlowSettings(face_velocity=0.025))
    >>> round(prediction.pressure_drop["davies"], 1), round(prediction.efficiency["total"], 4)
    (223.1, 0.9997)
    """
    flow = settings.flow()
    kn = float(slip.knudsen(flow.mean_free_path, medium.fiber_diameter))
    re = float(reynolds(flow.density, medium.fiber_diameter, flow.face_velocity, flow.viscosity))
    drops = {name: _finite(_pressure_drop(name, medium, flow)) for name in MODELS}
    single = single_fiber_at(medium, settings, settings.particle_diameter)
    depth = {name: float(depth_of(medium, value)) for name, value in single.items()}
    lowest = most_penetrating(
        single_fiber.preset(settings.preset), flow, medium.solidity, medium.fiber_diameter, settings.particle_density
    )
    efficiency = {name: float(single_fiber.filter_efficiency(value)) for name, value in depth.items()}
    drop = drops[settings.pressure_model]
    warnings = _warnings(medium, settings, single, re, lowest.inside)
    return Prediction(
        solidity=medium.solidity,
        thickness=medium.thickness,
        fiber_diameter=medium.fiber_diameter,
        particle_diameter=settings.particle_diameter,
        face_velocity=flow.face_velocity,
        temperature=flow.temperature,
        viscosity=flow.viscosity,
        density=flow.density,
        mean_free_path=flow.mean_free_path,
        preset=settings.preset,
        pressure_model=settings.pressure_model,
        reynolds=re,
        knudsen=kn,
        regime=slip.regime(kn),
        pressure_drop=drops,
        notes={name: model.notes(medium.solidity, kn, re) for name, model in MODELS.items()},
        single_fiber={name: float(value) for name, value in single.items()},
        efficiency=efficiency,
        aerosol=_aerosol(medium, settings),
        mpps={
            "diameter": lowest.diameter,
            "efficiency": float(single_fiber.filter_efficiency(depth_of(medium, lowest.single_fiber))),
            "lee_liu_diameter": float(lee_liu_diameter(medium.solidity, flow, medium.fiber_diameter)),
            "lee_liu_efficiency": float(
                single_fiber.filter_efficiency(
                    depth_of(medium, lee_liu_efficiency(medium.solidity, flow, medium.fiber_diameter))
                )
            ),
        },
        figure_of_merit={
            "a34": None if drop is None else float(merit.figure_of_merit(depth["total"], drop)),
            "paper": None if drop is None else float(merit.efficiency_per_pascal(efficiency["total"], drop)),
        },
        hepa=_hepa(medium, settings),
        warnings=warnings,
    )


def single_fiber_at(
    medium: FilterSettings, settings: FlowSettings, particle_diameter: float | Floats
) -> dict[str, Floats]:
    """Single-fiber efficiencies of a filter over particle size: ``total``, then one per mechanism.

    Parameters
    ----------
    medium : FilterSettings
    settings : FlowSettings
    particle_diameter : float or array [m]

    Returns
    -------
    dict of str to array [-]
        Of the sizes' shape.
    """
    flow, model = settings.flow(), single_fiber.preset(settings.preset)
    aerosol = single_fiber.aerosol(model, flow, particle_diameter, settings.particle_density)
    parts = single_fiber.single_fiber_efficiencies(model, aerosol, flow, medium.solidity, medium.fiber_diameter)
    return {"total": single_fiber.combined(model, parts), **parts}


def depth_of(medium: FilterSettings, efficiency: float | Floats) -> Floats:
    """Capture depth of a filter whose single fibers have this efficiency [-]."""
    return single_fiber.capture_depth(efficiency, medium.solidity, medium.thickness, medium.fiber_diameter)


def efficiency_over(medium: FilterSettings, settings: FlowSettings, particle_diameter: Floats) -> dict[str, Floats]:
    """Filter efficiency over particle size: ``total``, then what each mechanism would reach alone (Fig. A8) [-]."""
    parts = single_fiber_at(medium, settings, particle_diameter)
    return {name: single_fiber.filter_efficiency(depth_of(medium, value)) for name, value in parts.items()}


def filter_of_mat(mat: Mat, flow: Flow) -> FilterSettings:
    """Describe a mat as a filter: nominal solidity, its slab's thickness, the diameter that keeps length and volume.

    Raises
    ------
    CaseError
        If the fibers overlap so much that their summed volume fills the slab.
    """
    solidity = nominal_solidity(mat)
    if solidity >= 1.0:
        raise CaseError(f"the fibers' summed volume is {solidity:.2f} of the slab; no model holds for such a mat")
    diameter = mat_diameters(mat, flow, solidity)["volume"]
    return FilterSettings(solidity=solidity, thickness=mat.thickness, fiber_diameter=diameter)


def filter_of_comparison(comparison: Mapping[str, Any], which: str = "mesh") -> FilterSettings:
    """Describe a finished run as a filter, from the content of its ``comparison.json``.

    Parameters
    ----------
    comparison : mapping
    which : {"nominal", "surface", "mesh"}
        Whose solidity.

    Returns
    -------
    FilterSettings
    """
    return FilterSettings(
        solidity=float(comparison["solidity"][which]),
        thickness=float(comparison["thickness"]),
        fiber_diameter=float(comparison["fiber_diameter"]),
    )


def _pressure_drop(name: str, medium: FilterSettings, flow: Flow) -> float:
    slip_length = slip.slip_length(slip.knudsen(flow.mean_free_path, medium.fiber_diameter))
    f = pressure_model(name).coefficient(medium.solidity, slip_length)
    return float(pressure_drop(f, flow.viscosity, flow.face_velocity, medium.thickness, medium.fiber_diameter))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _aerosol(medium: FilterSettings, settings: FlowSettings) -> dict[str, float]:
    median, spread = settings.particle_diameter, settings.particle_spread

    def efficiency(diameter: Floats) -> Floats:
        return single_fiber.filter_efficiency(depth_of(medium, single_fiber_at(medium, settings, diameter)["total"]))

    return {
        "spread": spread,
        "count": lognormal_mean(efficiency, median, spread),
        "mass": lognormal_mean(efficiency, mass_median(median, spread), spread),
    }


def _hepa(medium: FilterSettings, settings: FlowSettings) -> dict[str, float | bool | None]:
    test = settings.model_copy(update={"face_velocity": merit.HEPA_VELOCITY})
    single = single_fiber_at(medium, test, merit.HEPA_PARTICLE)["total"]
    efficiency = float(single_fiber.filter_efficiency(depth_of(medium, single)))
    drop = _pressure_drop(settings.pressure_model, medium, test.flow())
    check = merit.HepaCheck(efficiency=efficiency, pressure_drop=drop)
    return {"efficiency": efficiency, "pressure_drop": _finite(drop), "passes": check.passes}


def _warnings(
    medium: FilterSettings, settings: FlowSettings, single: Mapping[str, Floats], reynolds: float, inside: bool
) -> tuple[str, ...]:
    warnings = []
    ratio = settings.particle_diameter / medium.fiber_diameter
    if 1.0 + ratio > 1.0 / math.sqrt(medium.solidity):
        warnings.append(f"particles of {ratio:.3g} fiber diameters do not fit into Kuwabara's cell")
    above = [name for name, value in single.items() if float(np.asarray(value)) > 1.0]
    if above:
        warnings.append(f"single-fiber efficiency above 1: {', '.join(above)}; the formula does not hold there")
    below = [name for name, value in single.items() if float(np.asarray(value)) < 0.0]
    if below:
        warnings.append(f"single-fiber efficiency below 0: {', '.join(below)}")
    if reynolds > 0.05:
        warnings.append(f"fiber Reynolds number {reynolds:.3g} above 0.05: every model here neglects inertia")
    if not inside:
        warnings.append("no most penetrating size between 1 nm and 10 um: efficiency falls to the end of that range")
    return tuple(warnings)
