"""Which solver runs, how exactly, and when it is done."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from pipeline.units import Duration, Fraction, Memory

SolverName = Literal["stokes", "openfoam"]


class StokesSettings(BaseModel):
    """Settings of the engine `stokes`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    tolerance: Fraction = Field(
        default=1e-4,
        description="The pressure drop has settled once its own error, as the iterations know it, is below this "
        "share of it, and the forces balance.",
    )
    max_iterations: int = Field(default=1000, ge=1, description="Iterations after which the run is given up.")
    memory_limit: Memory | None = Field(
        default=None,
        description="A flow that would take more memory is refused; if left out, 85 % of the machine's free memory.",
    )


class OpenFoamSettings(BaseModel):
    """Settings of the engine `openfoam`."""

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


class SolveSettings(BaseModel):
    """The run of the solver; a case file with the table ``[solve]`` is solved in every run."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    engine: SolverName = Field(
        default="stokes",
        description='"stokes": second-order elements on curved walls, for steady flow through tetrahedra, with '
        'nothing to install; "openfoam": OpenFOAM runs the exported case.',
    )
    stokes: StokesSettings | None = Field(default=None, description='Of solve.engine = "stokes".')
    openfoam: OpenFoamSettings | None = Field(default=None, description='Of solve.engine = "openfoam".')

    @model_validator(mode="before")
    @classmethod
    def _chosen_table_is_there(cls, content: Any) -> Any:
        if not isinstance(content, dict):
            return content
        moved = sorted(OpenFoamSettings.model_fields.keys() & content.keys())
        if moved:
            raise ValueError(
                f"{moved[0]} belongs to one solver now: write solve.openfoam.{moved[0]}"
                + (f" or solve.stokes.{moved[0]}" if moved[0] in StokesSettings.model_fields else "")
            )
        engine = content.get("engine", "stokes")
        known = engine in ("stokes", "openfoam")
        return {**content, engine: {}} if known and content.get(engine) is None else content

    @model_validator(mode="after")
    def _nothing_is_silently_ignored(self) -> Self:
        other = "openfoam" if self.engine == "stokes" else "stokes"
        if getattr(self, other) is not None:
            raise ValueError(f'the table [solve.{other}] means nothing to solve.engine = "{self.engine}"; leave it out')
        return self

    @model_serializer(mode="wrap")
    def _chosen_table_alone(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {key: value for key, value in handler(self).items() if value is not None}
