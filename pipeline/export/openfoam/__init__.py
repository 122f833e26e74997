"""OpenFOAM: the mesh, the complete case around it, and the way back."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.export.openfoam.case import write_openfoam
from pipeline.export.openfoam.slip import FiberSlip, fiber_radius
from pipeline.openfoam.read import read_openfoam

__all__ = ["FiberSlip", "fiber_radius", "read_openfoam", "write_openfoam"]
