"""What a user may say about the fibers' surface."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from pipeline.units import PositiveRatio, Ratio


class SurfaceSettings(BaseModel):
    """How center lines become closed surfaces (case file: ``[surface]``).

    Examples
    --------
    >>> SurfaceSettings().joint
    'miter'
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    sides: Annotated[int, Field(ge=6, le=256)] = Field(
        default=10,
        description="Corners of a fiber's cross-section, a regular polygon; the tube keeps the cylinder's volume.",
    )
    ring_spacing: PositiveRatio = Field(
        default=0.6, description="Distance between rings of points along a fiber, in diameters of that fiber."
    )
    joint: Literal["miter", "sphere"] = Field(
        default="miter",
        description="How a bend is closed: both pieces run on to the plane that halves the angle (miter), "
        "or a ball of the fiber's radius sits on the bend (sphere). Bends too sharp for a miter get a sphere.",
    )
    caps: Literal["flat", "hemisphere"] = Field(
        default="flat", description="How a fiber's end inside the mat is closed."
    )
    smallest_edge: Annotated[Ratio, Field(le=0.2)] = Field(
        default=0.05,
        description="Edges shorter than this, in fiber diameters, are collapsed where fibers meet; no point moves "
        "farther. 0 keeps the union as it comes, with splinters that slow the mesher down.",
    )

    @model_validator(mode="after")
    def _edges_outlast_the_clearing(self) -> Self:
        shortest = min(math.pi / self.sides, self.ring_spacing)
        if self.smallest_edge > 0.5 * shortest:
            raise ValueError(
                f"smallest_edge = {self.smallest_edge:g} would collapse the tubes themselves, whose edges are "
                f"{shortest:.3g} diameters with {self.sides} sides and ring_spacing = {self.ring_spacing:g}; "
                f"make it {0.5 * shortest:.2g} or less"
            )
        return self
