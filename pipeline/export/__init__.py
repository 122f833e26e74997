"""Cases and meshes that solvers and viewers read."""

from pipeline.export.read import read_mesh
from pipeline.export.write import export

__all__ = ["export", "read_mesh"]
