"""Cases and meshes that solvers and viewers read."""

from pipeline.export.write import export

__all__ = ["export"]
