"""Cases and meshes that solvers and viewers read."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.export.openfoam import FiberSlip, fiber_radius
from pipeline.export.read import read_mesh
from pipeline.export.write import export

__all__ = ["FiberSlip", "export", "fiber_radius", "read_mesh"]
