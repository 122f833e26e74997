"""What the export leaves that other stages read."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class OpenFoamCase:
    """A complete case for OpenFOAM's solver, by its folder."""

    folder: Path
