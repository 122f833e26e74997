"""How the picture of a mat is taken, and which measured one stands beside it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from pipeline.units import Length, Ratio


class MicrographSettings(BaseModel):
    """The mat seen from above as a scanning electron microscope would."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    file: Path | None = Field(
        default=None, description="Micrograph of the real medium (TIFF or PNG), shown beside at the same scale."
    )
    pixel: Length | None = Field(
        default=None,
        description="Length of a pixel: of the file, unless it tells itself; without a file a twentieth of the mean "
        "diameter unless given.",
    )
    depth: Length | None = Field(
        default=None,
        description="Depth over which brightness falls by a factor of e; three mean diameters unless given.",
    )
    edge: Ratio = Field(default=1.0, description="By how much rims are brighter than a level surface, as a share.")
    blur: Ratio = Field(default=1.0, description="Standard deviation of the beam's width, in pixels.")
    noise: Ratio = Field(default=0.05, description="Standard deviation of each pixel, as a share of the brightness.")
    seed: int = Field(default=0, ge=0, lt=2**63, description="Seed of the noise.")
