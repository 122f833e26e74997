"""The air in tetrahedra."""

from pipeline.tetmesh.mesh import TetmeshMeasures, tetrahedralize
from pipeline.tetmesh.settings import TetmeshSettings

__all__ = ["TetmeshMeasures", "TetmeshSettings", "tetrahedralize"]
