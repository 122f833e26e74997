"""Which files are written for solvers and viewers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from pipeline.cad.surfaces import LengthUnit
from pipeline.export.formats.registry import WRITTEN, why_not
from pipeline.openfoam.foam_file import Encoding

if TYPE_CHECKING:
    Format = str
else:
    Format = Literal[tuple(WRITTEN)]
Dialect = Literal["com", "org"]


class ExportSettings(BaseModel):
    """The files that the mesh ends in."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    formats: tuple[Format, ...] = Field(
        default=("openfoam", "vtk"), min_length=1, description="Formats to write, each into its own folder."
    )
    length_unit: LengthUnit = Field(
        default="um",
        description="Unit of the fibers' surface in stl, ply and obj; drawing programs join points that are nearer "
        "than some 1e-8 of their unit. Meshes are in meters.",
    )
    encoding: Encoding = Field(
        default="binary", description="How OpenFOAM's mesh is written; ascii has all 17 digits and ten times the size."
    )
    dialect: Dialect = Field(
        default="com", description="Whose OpenFOAM the case is written for: OpenFOAM.com or OpenFOAM.org."
    )

    @model_validator(mode="before")
    @classmethod
    def _wall_belongs_to_the_flow(cls, content: object) -> object:
        if isinstance(content, dict) and "fiber_wall" in content:
            raise ValueError("fiber_wall belongs to the flow now, for every solver: write flow.fiber_wall")
        return content

    @field_validator("formats", mode="before")
    @classmethod
    def _tell_why_not(cls, formats: object) -> object:
        for name in formats if isinstance(formats, (list, tuple)) else ():
            if isinstance(name, str) and (reason := why_not(name)):
                raise ValueError(f"{name} {reason}")
        return formats

    @field_validator("formats")
    @classmethod
    def _each_once(cls, formats: tuple[Format, ...]) -> tuple[Format, ...]:
        if len(set(formats)) < len(formats):
            raise ValueError("names a format twice")
        return formats
