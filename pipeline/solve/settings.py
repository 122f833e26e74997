"""How long and on how many cores the solver runs, and when it is done."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pydantic import BaseModel, ConfigDict, Field

from pipeline.units import Duration, Fraction


class SolveSettings(BaseModel):
    """The run of the solver."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    cores: int = Field(default=1, ge=1, le=4096, description="Processes that share the mesh; above 1 needs MPI.")
    max_iterations: int = Field(default=2000, ge=1, description="Iterations after which the run is given up.")
    tolerance: Fraction = Field(
        default=1e-4,
        description="The pressure drop has settled once it changed by less than this share of itself over the "
        "last `window` iterations.",
    )
    window: int = Field(default=20, ge=2, le=1000, description="Iterations over which a settled pressure drop stays.")
    time_limit: Duration = Field(default=7200.0, description="Time after which the run is stopped.")
