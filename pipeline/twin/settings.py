"""What was measured on a filter: the keys of ``fibertwin twin``, in a TOML file or as options."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from pipeline.analytics.formulas import air
from pipeline.analytics.models.pressure_models import PressureModelName
from pipeline.analytics.settings import FlowSettings
from pipeline.mat.settings import Diameters, Orientation
from pipeline.twin.measurement import (
    USUAL,
    DropAtVelocity,
    MeasuredLength,
    MeasuredShare,
    MeasuredWeight,
    Measurement,
    read_measurement,
)
from pipeline.units import Density, Fraction, Length, Pressure, Temperature, Velocity, written

SIZES = ("basis_weight", "solidity", "thickness", "pressure_drop")
"""What tells how much mat there is and how dense it is: a twin takes two of them."""


class MeasuredFilter(BaseModel):
    """What was measured on a filter.

    Examples
    --------
    >>> filter_ = MeasuredFilter(fiber_diameter="1.4 um", solidity="8 %", thickness="60 um +- 2 um")
    >>> filter_.thickness.low
    5.8e-05
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    micrograph: Path | None = Field(
        default=None, description="Picture of the fibers, or what `fibertwin measure --json` told of one."
    )
    pixel: Length | None = Field(default=None, description="Length of the picture's pixel, unless its file tells.")
    bar: Length | None = Field(default=None, description="Length that the bar in the picture's strip stands for.")
    fiber_diameter: Diameters | None = Field(
        default=None, description="Diameter of the fibers, or their distribution, where there is no picture."
    )
    diameter_tolerance: Fraction = Field(
        default=USUAL,
        description="By which share of it the mean of fiber_diameter may be off; also written into its text.",
    )
    orientation: Orientation | None = Field(
        default=None, description="Law of the directions, as a case file has it; the picture's unless given."
    )
    fiber_density: Density | None = Field(default=None, description="Density of what the fibers are made of.")
    basis_weight: MeasuredWeight | None = Field(default=None, description="Mass over the face's area.")
    solidity: MeasuredShare | None = Field(default=None, description="Fiber volume over the medium's volume.")
    thickness: MeasuredLength | None = Field(default=None, description="Of the medium, along the flow.")
    pressure_drop: DropAtVelocity | None = Field(default=None, description="Measured, and at which face velocity.")
    face_velocity: Velocity | None = Field(
        default=None, description="Of the pressure drop, where that does not tell; 2.5 cm/s without a pressure drop."
    )
    temperature: Temperature = Field(default=293.0, description="Of the air.")
    pressure: Pressure = Field(default=air.REFERENCE_PRESSURE, description="Absolute pressure of the air.")
    pressure_model: PressureModelName = Field(
        default="davies", description="Model of the pressure drop, which the search goes by."
    )
    side: Length | None = Field(
        default=None, description="Edge of the twin's square plan; 30 mean diameters unless given."
    )
    contact: Literal["paper", "clear"] = Field(
        default="clear",
        description="How fibers rest on each other: clear of each other, so that their volumes add up as masses do, or "
        "overlapping a little as the paper's do.",
    )
    seeds: int = Field(
        default=8, ge=2, le=1000, description="Mats that every step looks at; the best of them is the twin."
    )

    @property
    def drop(self) -> Measurement | None:
        """Pressure drop [Pa], without its velocity."""
        return None if self.pressure_drop is None else self.pressure_drop.drop

    def flow(self) -> FlowSettings:
        """Give the air that the pressure drop was measured with."""
        told = None if self.pressure_drop is None else self.pressure_drop.face_velocity
        return FlowSettings(
            face_velocity=told or self.face_velocity or 0.025,
            temperature=self.temperature,
            pressure=self.pressure,
            pressure_model=self.pressure_model,
        )

    @model_validator(mode="before")
    @classmethod
    def _tolerance_apart(cls, content: Any) -> Any:
        text = content.get("fiber_diameter") if isinstance(content, dict) else None
        if not isinstance(text, str):
            return content
        try:
            measured = read_measurement(text, "m")
        except ValueError:
            # told of the key, by the type that it has
            return content
        given = {"diameter_tolerance": measured.tolerance / measured.value, **content}
        return {**given, "fiber_diameter": written(measured.value, "m")}

    @model_validator(mode="after")
    def _tells_the_fibers(self) -> Self:
        if (self.micrograph is None) == (self.fiber_diameter is None):
            both = "not both" if self.micrograph is not None else "one of them"
            raise ValueError(f"the fibers come from a micrograph or from a fiber_diameter: give {both}")
        if self.micrograph is None and (self.pixel is not None or self.bar is not None):
            raise ValueError("pixel and bar are a picture's: give the micrograph")
        return self

    @model_validator(mode="after")
    def _tells_a_mat(self) -> Self:
        given = [name for name in SIZES if getattr(self, name) is not None]
        if len(given) < 2:
            raise ValueError(
                f"{given[0] if given else 'none'} of {', '.join(SIZES)} is given, and a mat takes two: how much of it "
                'there is and how dense it is, as thickness = "60 um +- 5 %" and solidity = "8 % +- 5 %"'
            )
        if self.basis_weight is not None and self.fiber_density is None:
            raise ValueError(
                'a basis weight takes the fibers\' density: fiber_density = "2500 kg/m^3" is that of glass'
            )
        if self.solidity is not None and not self.solidity.value < 1:
            raise ValueError(f"solidity = {self.solidity.value:g} is above 1; in percent it is written with its sign")
        return self

    @model_validator(mode="after")
    def _tells_one_velocity(self) -> Self:
        if self.pressure_drop is not None and (self.pressure_drop.face_velocity is None) == (
            self.face_velocity is None
        ):
            raise ValueError('a pressure drop has one face velocity: write "45 Pa at 5.3 cm/s +- 10 %"')
        # its own checks of the air, told beside those of the rest
        self.flow()
        return self
