"""What a user may say about the duct around the mat."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from pipeline.units import Length


class EnclosureSettings(BaseModel):
    """The duct (case file: ``[enclosure]``).

    Examples
    --------
    >>> EnclosureSettings(inlet="12 um").inlet
    1.2e-05
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    inlet: Length | None = Field(
        default=None,
        description="Length of the empty duct before the mat; when not given, three mean fiber spacings, "
        "the spacing being that of a square array of the same solidity.",
    )
    outlet: Length | None = Field(
        default=None, description="Length of the empty duct behind the mat; when not given, as for the inlet."
    )
    sides: Literal["symmetry", "slip", "cyclic"] = Field(
        default="symmetry",
        description="What the solver gets on the four sides: a symmetry plane, a frictionless wall, or, for a "
        "periodic mat, the opposite side.",
    )
