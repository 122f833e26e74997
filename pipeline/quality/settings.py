"""The limits that a good mesh keeps to; the defaults are those of OpenFOAM's `checkMesh`, with their sources."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pydantic import BaseModel, ConfigDict, Field

from pipeline.units import Angle, Fraction, PositiveRatio


class QualitySettings(BaseModel):
    """Limits of the mesh quality; a mesh that breaks one is told so, and how often and where."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    non_orthogonality: Angle = Field(
        default=70.0,
        description="Largest angle between a face's normal and the line between its cells' centers. Above it the "
        "solver's correction costs accuracy (checkMesh's nonOrthThreshold); 90 deg always fails.",
    )
    skewness: PositiveRatio = Field(
        default=4.0,
        description="Largest distance between a face's center and where that line meets it, over the face's own "
        "extent (checkMesh's skewThreshold).",
    )
    aspect_ratio: PositiveRatio = Field(
        default=1000.0, description="Largest ratio of a cell's extents (checkMesh's aspectThreshold)."
    )
    determinant: Fraction = Field(
        default=1e-3,
        description="Smallest determinant of a cell's normalized inner faces, 0 where they cannot carry a gradient "
        "(checkMesh -allGeometry).",
    )
    face_weight: Fraction = Field(
        default=0.05,
        description="Smallest share of the nearer cell in the interpolation to a face (checkMesh -allGeometry).",
    )
    volume_ratio: Fraction = Field(
        default=0.01, description="Smallest volume ratio of two neighbour cells (checkMesh -allGeometry)."
    )
