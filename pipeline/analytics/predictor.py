"""A filter's performance as a quick function of what changes while it grows: for mats that stop at a target."""

from collections.abc import Callable

from pipeline.analytics import single_fiber, slip
from pipeline.analytics.pressure_drop import pressure_drop
from pipeline.analytics.pressure_models import pressure_model
from pipeline.analytics.settings import FlowSettings
from pipeline.errors import CaseError

Predictor = Callable[[float, float, float], float]
"""Of solidity [-], thickness [m] and fiber diameter [m]."""


def predictor(stop: str, settings: FlowSettings) -> Predictor:
    """Make the function that a growing mat asks after each fiber.

    Parameters
    ----------
    stop : {"pressure_drop", "efficiency"}
        What the mat's target is: a pressure drop [Pa] by ``settings.pressure_model``, or a filter efficiency [-] at
        ``settings.particle_diameter`` by ``settings.preset``.
    settings : FlowSettings

    Returns
    -------
    callable
        (solidity [-], thickness [m], fiber diameter [m]) -> float. Some 10 us a call for the pressure drop, some 50 us
        for the efficiency.

    Raises
    ------
    CaseError
        If nothing is to be predicted for that stop.

    Examples
    --------
    >>> fig12 = 0.1198, 42.3e-6, 0.5e-6
    >>> settings = FlowSettings(face_velocity=0.025)
    >>> round(predictor("pressure_drop", settings)(*fig12), 1), round(predictor("efficiency", settings)(*fig12), 4)
    (223.1, 0.9997)
    """
    if stop == "pressure_drop":
        return _pressure_drop(settings)
    if stop == "efficiency":
        return _efficiency(settings)
    raise CaseError(f"no analytical prediction for a mat that stops at {stop!r}; pressure_drop and efficiency have one")


def _pressure_drop(settings: FlowSettings) -> Predictor:
    flow = settings.flow()
    coefficient = pressure_model(settings.pressure_model).coefficient

    def predict(solidity: float, thickness: float, fiber_diameter: float) -> float:
        slip_length = slip.slip_length(slip.knudsen(flow.mean_free_path, fiber_diameter))
        f = coefficient(solidity, slip_length)
        return float(pressure_drop(f, flow.viscosity, flow.face_velocity, thickness, fiber_diameter))

    return predict


def _efficiency(settings: FlowSettings) -> Predictor:
    flow = settings.flow()
    model = single_fiber.preset(settings.preset)
    aerosol = single_fiber.aerosol(model, flow, settings.particle_diameter, settings.particle_density)

    def predict(solidity: float, thickness: float, fiber_diameter: float) -> float:
        parts = single_fiber.single_fiber_efficiencies(model, aerosol, flow, solidity, fiber_diameter)
        single = single_fiber.combined(model, parts)
        return 1.0 - float(single_fiber.penetration(single, solidity, thickness, fiber_diameter))

    return predict
