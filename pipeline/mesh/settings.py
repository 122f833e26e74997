"""What a user may ask of the tetrahedral mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from pipeline.units import Duration, Fraction, Memory, PositiveRatio, Ratio

MEMORY_SHARE = 0.85
"""Share of the machine's memory that an engine may use where the case names no limit."""


class TetmeshSettings(BaseModel):
    """Settings of the stage `tetmesh`; lengths are in mean fiber diameters, so that a case scales as a whole."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    engine: Literal["lattice", "tetwild", "snappy"] = Field(
        default="lattice",
        description="The mesher: a body-centered cubic lattice cut by the fibers (quick, the same every time), "
        "fTetWild, or OpenFOAM's snappyHexMesh (hexahedra split near the fibers; OpenFOAM has to be installed; runs on "
        "many cores and machines).",
    )
    cores: int = Field(default=1, ge=1, le=4096, description="Processes that snappyHexMesh runs in; above 1 needs MPI.")
    edge: PositiveRatio = Field(
        default=0.6,
        le=20,
        description="Edge length of the tetrahedra at the fibers, in mean fiber diameters; snappyHexMesh's cubes "
        "have half of it and the same volume.",
    )
    growth: Ratio = Field(
        default=1.0,
        le=3,
        description="How much longer the edges become per distance from the fibers; 0 for the same length everywhere.",
    )
    largest_edge: PositiveRatio = Field(
        default=3.0, description="Longest edge length far from the fibers, in mean fiber diameters."
    )
    envelope: PositiveRatio = Field(
        default=0.04,
        le=0.25,
        description="How far the mesh's boundary may stray from the fibers' surface, in mean fiber diameters.",
    )
    passes: int = Field(
        default=2,
        ge=1,
        le=200,
        description="Rounds of splitting, collapsing, swapping and smoothing before the edge lengths are refined.",
    )
    stop_energy: PositiveRatio = Field(
        default=100.0,
        ge=3.0,
        description="Conformal energy of the worst tetrahedron at which rounds end (3 is ideal); "
        "the few cells that a solver would object to are mended afterwards.",
    )
    volume_error: Fraction = Field(
        default=0.02, description="Largest error of the fibers' volume against the surface that is accepted."
    )
    deviation: PositiveRatio = Field(
        default=0.5,
        description="Distance from the true fibers within which 99 % of the walls' area has to lie, in mean fiber "
        "diameters.",
    )
    time_limit: Duration = Field(default=3600.0, description="The mesher is ended after this time.")
    memory_limit: Memory | None = Field(
        default=None, description="The mesher is ended above this much memory; if left out, 85 % of the machine's."
    )

    @model_validator(mode="after")
    def _nothing_is_silently_ignored(self) -> Self:
        others = ("envelope", "passes", "stop_energy") if self.engine == "snappy" else ("cores",)
        for name in others:
            if getattr(self, name) != type(self).model_fields[name].default:
                raise ValueError(f'{name} means nothing to the engine "{self.engine}"; leave it out')
        return self
