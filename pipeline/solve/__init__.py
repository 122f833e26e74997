"""OpenFOAM runs of an exported case."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.openfoam.environment import openfoam_missing
from pipeline.solve.running import Bed, solve
from pipeline.solve.settings import SolveSettings

__all__ = ["Bed", "SolveSettings", "openfoam_missing", "solve"]
