"""The case file's ``[capture]``: which particles are sent through the filter, how many, and what moves them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, field_validator, model_validator

from pipeline.units import Density, Fraction, Length, written

Mechanism = Literal["interception", "diffusion", "inertia", "gravity"]
MECHANISMS: tuple[Mechanism, ...] = ("interception", "diffusion", "inertia", "gravity")
"""What brings a particle to a fiber: its size, its Brownian motion, its mass, its weight."""

PARTICLES = 10_000
"""Particles of each size where the case says neither how many nor how sure."""


class _SizeRange(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    smallest: Length
    largest: Length
    count: int = Field(ge=2, le=100)


class CaptureSettings(BaseModel):
    """Particles on their way through the solved flow.

    Examples
    --------
    >>> CaptureSettings(particle_diameters=("100 nm", "1 um")).diameters()
    (1e-07, 1e-06)
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    particle_diameters: tuple[Length, ...] = Field(
        default=(30e-9, 100e-9, 300e-9, 1e-6, 3e-6),
        description="particle sizes, or a table { smallest, largest, count } for even steps of the logarithm",
    )
    particles: int | None = Field(
        default=None, ge=1, le=100_000_000, description="Particles of each size; 10,000 where no half_width is given."
    )
    half_width: Fraction | None = Field(
        default=None,
        description="Particles are added until the efficiency's 95 % interval is at most this wide to either side.",
    )
    density: Density | None = Field(
        default=None, description="Density of the particles; that of [flow] particle_density unless given."
    )
    seed: int = Field(default=1, ge=0, le=2**63 - 1, description="Seed of starts and Brownian motion.")
    mechanisms: tuple[Mechanism, ...] = Field(
        default=MECHANISMS, description="What brings particles to the fibers; all unless given."
    )
    gravity: Literal["across", "with", "against"] | None = Field(
        default=None,
        description="Direction of gravity to the flow (across: along x); that of [flow] preset unless given.",
    )

    @field_validator("particle_diameters", mode="before")
    @classmethod
    def _range_written_out(cls, value: Any, info: ValidationInfo) -> Any:
        if not isinstance(value, dict):
            return value
        try:
            sizes = _SizeRange.model_validate(value, context=info.context)
        except ValidationError as problem:
            wrong = problem.errors(include_url=False)[0]
            message = str(wrong["msg"]).removeprefix("Value error, ")
            raise ValueError(
                f"{'.'.join(map(str, wrong['loc']))}: {message[:1].lower()}{message[1:]}; "
                'a range is { smallest = "30 nm", largest = "3 um", count = 9 }'
            ) from None
        if sizes.smallest >= sizes.largest:
            raise ValueError("the smallest diameter is not below the largest")
        step = math.log(sizes.largest / sizes.smallest) / (sizes.count - 1)
        inner = [sizes.smallest * math.exp(k * step) for k in range(1, sizes.count - 1)]
        # as text again, which a case file has to hold
        return [written(float(f"{size:.6g}"), "m") for size in (sizes.smallest, *inner, sizes.largest)]

    @model_validator(mode="after")
    def _says_one_thing(self) -> Self:
        if self.particles is not None and self.half_width is not None:
            raise ValueError("give particles or half_width, not both")
        if not self.particle_diameters:
            raise ValueError("particle_diameters is empty; name at least one size")
        if len(set(self.particle_diameters)) < len(self.particle_diameters):
            raise ValueError("a size stands twice in particle_diameters")
        if not self.mechanisms:
            raise ValueError("mechanisms is empty: nothing would be caught; leave it out for all of them")
        if len(set(self.mechanisms)) < len(self.mechanisms):
            raise ValueError("a mechanism stands twice")
        return self

    def diameters(self) -> tuple[float, ...]:
        """Give the particle diameters [m], rising."""
        return tuple(sorted(self.particle_diameters))
