"""OpenFOAM: the mesh, the complete case around it, and the way back."""

from pipeline.export.openfoam.case import write_openfoam
from pipeline.export.openfoam.read import read_openfoam
from pipeline.export.openfoam.slip import FiberSlip, fiber_radius

__all__ = ["FiberSlip", "fiber_radius", "read_openfoam", "write_openfoam"]
