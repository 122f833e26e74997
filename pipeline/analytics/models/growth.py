"""A filter's performance as a quick function of what changes while it grows: for mats that stop at a target."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from typing import Protocol

from pipeline.analytics.formulas import slip
from pipeline.analytics.formulas.pressure_drop import pressure_drop
from pipeline.analytics.models import single_fiber
from pipeline.analytics.models.pressure_models import pressure_model
from pipeline.analytics.settings import FlowSettings

Predictor = Callable[[float, float, float], float]
"""Of solidity [-], thickness [m] and fiber diameter [m]."""


class Stop(Protocol):
    """What has to be known of the end of a mat (the mat's own settings have it)."""

    @property
    def quantity(self) -> str:
        """Name of the quantity that ends the mat."""

    @property
    def model(self) -> str | None:
        """Pressure-drop model, where the stop names one."""

    @property
    def particle_diameter(self) -> float | None:
        """Particle size, where the stop names one [m]."""


def predictor(stop: Stop, settings: FlowSettings) -> Predictor | None:
    """Make the function that a growing mat asks after each fiber.

    Parameters
    ----------
    stop : Stop
        What ends the mat. A pressure drop [Pa] is predicted by ``stop.model`` (``settings.pressure_model`` unless
        given), a filter efficiency [-] at ``stop.particle_diameter`` (``settings.particle_diameter`` unless given)
        by ``settings.preset``.
    settings : FlowSettings

    Returns
    -------
    callable or None
        (solidity [-], thickness [m], fiber diameter [m]) -> float, microseconds a call; None for a stop that needs no
        prediction.

    Raises
    ------
    CaseError
        If there is no model of that name.
    """
    if stop.quantity == "pressure_drop":
        return _pressure_drop(stop.model or settings.pressure_model, settings)
    if stop.quantity == "efficiency":
        return _efficiency(stop.particle_diameter or settings.particle_diameter, settings)
    return None


def _pressure_drop(name: str, settings: FlowSettings) -> Predictor:
    flow = settings.flow()
    coefficient = pressure_model(name).coefficient

    def predict(solidity: float, thickness: float, fiber_diameter: float) -> float:
        slip_length = slip.slip_length(slip.knudsen(flow.mean_free_path, fiber_diameter))
        f = coefficient(solidity, slip_length)
        return float(pressure_drop(f, flow.viscosity, flow.face_velocity, thickness, fiber_diameter))

    return predict


def _efficiency(particle_diameter: float, settings: FlowSettings) -> Predictor:
    flow = settings.flow()
    model = single_fiber.preset(settings.preset)
    aerosol = single_fiber.aerosol(model, flow, particle_diameter, settings.particle_density)

    def predict(solidity: float, thickness: float, fiber_diameter: float) -> float:
        parts = single_fiber.single_fiber_efficiencies(model, aerosol, flow, solidity, fiber_diameter)
        depth = single_fiber.capture_depth(single_fiber.combined(model, parts), solidity, thickness, fiber_diameter)
        return float(single_fiber.filter_efficiency(depth))

    return predict
