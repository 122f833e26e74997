"""The case file's ``[structure]``: how finely pores are measured, and how dense the fibers are."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pydantic import BaseModel, ConfigDict, Field

from pipeline.units import Density


class StructureSettings(BaseModel):
    """Measures of the air between the fibers; a case file with the table ``[structure]`` has them in every run."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    voxels_per_diameter: int = Field(
        default=6,
        ge=2,
        le=32,
        description="Voxels to a mean fiber diameter: pores are known to a voxel, the tortuosity at a solidity of "
        "10 % to .5 % at 6 and .1 % at 12.",
    )
    fiber_density: Density | None = Field(
        default=None, description="Density of the fibers' material; with it the surface is told by mass, too."
    )
