"""The case file's ``[flow]``: the air, its speed, and the particles it carries."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from pipeline.analytics.formulas import air
from pipeline.analytics.models.pressure_models import PressureModelName
from pipeline.analytics.models.single_fiber import PresetName
from pipeline.nouns.flow import Flow
from pipeline.units import Density, Fraction, Length, PositiveRatio, Pressure, Temperature, Velocity, Viscosity

INCOMPRESSIBLE = 0.3
"""Mach number below which air's density changes by less than 5 %, as the equations of every stage take for granted."""

FiberWall = Literal["slip", "no_slip"]


class FlowSettings(BaseModel):
    """Air on its way into the duct, and the particles it carries."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    face_velocity: Velocity = Field(
        default=0.025, description="flow rate over the face's area; HEPA media are tested at 2.5 cm/s"
    )
    temperature: Temperature = Field(default=293.0, description="absolute temperature of the air")
    pressure: Pressure = Field(default=air.REFERENCE_PRESSURE, description="absolute pressure of the air")
    viscosity: Viscosity | None = Field(
        default=None, description="dynamic viscosity of the air; from the temperature by Sutherland's law unless given"
    )
    density: Density | None = Field(
        default=None, description="density of the air; from temperature and pressure as an ideal gas unless given"
    )
    mean_free_path: Length | None = Field(
        default=None,
        description="mean free path of the air; 65.3 nm at 293 K and 1 atm, scaled by Willeke's law, unless given",
    )
    fiber_wall: FiberWall = Field(
        default="slip",
        description="what the air does on the fibers, for every solver and exported case: slip by the length that "
        "belongs to its mean free path, or stand still (right above a fiber diameter of about 10 um)",
    )
    particle_diameter: Length = Field(default=300e-9, description="particle size for which efficiencies are told")
    particle_density: Density = Field(default=1000.0, description="density of the particles")
    preset: PresetName = Field(
        default="paper",
        description="single-fiber model: what the paper computed (its slip term lowers interception, where slip raises "
        "it), what its Table A6 computes, or Hinds' textbook form",
    )
    particle_spread: PositiveRatio = Field(
        default=1.0,
        ge=1.0,
        description="geometric standard deviation of the particle sizes, whose median by count is particle_diameter",
    )
    pressure_model: PressureModelName = Field(
        default="davies",
        description="pressure-drop model of the figure of merit and the HEPA check, and of a mat whose stop names none",
    )

    @model_validator(mode="after")
    def _is_within_the_equations(self) -> Self:
        if not air.COLDEST <= self.temperature <= air.HOTTEST:
            raise ValueError(
                f"temperature is {self.temperature:g} K: the properties of air are known from {air.COLDEST:g} to "
                f"{air.HOTTEST:g} K, and it is liquid below 79 K"
            )
        if self.density is None and self.pressure > air.DENSEST:
            raise ValueError(
                f"pressure is {self.pressure:g} Pa: air is an ideal gas up to {air.DENSEST:g} Pa; give density"
            )
        mach = self.face_velocity / air.sound_speed(self.temperature)
        if mach > INCOMPRESSIBLE:
            raise ValueError(
                f"face_velocity is {self.face_velocity:g} m/s, Mach {mach:.2g}: the equations hold for incompressible "
                f"flow, up to Mach {INCOMPRESSIBLE} ({INCOMPRESSIBLE * air.sound_speed(self.temperature):.0f} m/s at "
                f"{self.temperature:g} K)"
            )
        return self

    def flow(self) -> Flow:
        """Air with every property known.

        Examples
        --------
        >>> flow = FlowSettings(face_velocity=0.1).flow()
        >>> f"{flow.viscosity:.3e} {flow.density:.3f} {flow.mean_free_path:.2e}"
        '1.813e-05 1.205 6.53e-08'
        """
        return Flow(
            face_velocity=self.face_velocity,
            temperature=self.temperature,
            viscosity=self.viscosity or air.viscosity(self.temperature),
            density=self.density or air.density(self.temperature, self.pressure),
            mean_free_path=self.mean_free_path or air.mean_free_path(self.temperature, self.pressure),
        )


class FilterSettings(BaseModel):
    """A filter as the analytical models see it."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    solidity: Fraction = Field(description="fiber volume over filter volume")
    thickness: Length = Field(description="extent along the flow")
    fiber_diameter: Length = Field(description="diameter of the fibers, taken as equal")
