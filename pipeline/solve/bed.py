"""What the air goes through, as far as the meaning of a pressure drop depends on it."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

from pipeline.nouns.flow import Flow


@dataclass(frozen=True, slots=True)
class Bed:
    """What the air goes through.

    Parameters
    ----------
    face_area : float [m2]
        Of the duct, across the flow.
    thickness : float [m]
        Of the mat.
    pressure_factor : float [-], optional
        f(solidity) of a model with ``pressure drop = f x viscosity x velocity x thickness / diameter^2``; gives
        the effective fiber diameter.
    fiber_length : float [m], optional
        Of all fibers of an array of parallel ones; gives F*.
    """

    face_area: float
    thickness: float
    pressure_factor: float | None = None
    fiber_length: float | None = None

    def permeability(self, flow: Flow, drop: float) -> float:
        """Darcy's permeability [m2] of the mat at this pressure drop [Pa]."""
        return flow.viscosity * flow.face_velocity * self.thickness / drop

    def effective_diameter(self, flow: Flow, drop: float) -> float | None:
        """Fiber diameter [m] at which the model gives this pressure drop [Pa]."""
        return None if self.pressure_factor is None else math.sqrt(self.pressure_factor * self.permeability(flow, drop))

    def f_star(self, flow: Flow, drag: float) -> float | None:
        """Drag [N] per length of an array's fibers over viscosity and face velocity."""
        if self.fiber_length is None:
            return None
        return drag / (self.fiber_length * flow.viscosity * flow.face_velocity)
