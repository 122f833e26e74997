"""What a user may say about the fibers' surface."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from pipeline.units import PositiveRatio


class SurfaceSettings(BaseModel):
    """How center lines become closed surfaces (case file: ``[surface]``).

    Examples
    --------
    >>> SurfaceSettings().joint
    'miter'
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    sides: Annotated[int, Field(ge=6, le=256)] = Field(
        default=12, description="Corners of a fiber's cross-section, a regular polygon of the circle's area."
    )
    ring_spacing: PositiveRatio = Field(
        default=0.5, description="Distance between rings of points along a fiber, in diameters of that fiber."
    )
    joint: Literal["miter", "sphere"] = Field(
        default="miter",
        description="How a bend is closed: both pieces run on to the plane that halves the angle (miter), "
        "or a ball of the fiber's radius sits on the bend (sphere). Bends too sharp for a miter get a sphere.",
    )
    caps: Literal["flat", "hemisphere"] = Field(
        default="flat", description="How a fiber's end inside the mat is closed."
    )
