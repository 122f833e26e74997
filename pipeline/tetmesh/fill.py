"""Fill the air with cells by the engine that the case names."""

from pipeline.data import FaceMesh, FluidDomain
from pipeline.progress import Progress, silent
from pipeline.tetmesh.mesh import TetmeshMeasures, tetrahedralize
from pipeline.tetmesh.settings import TetmeshSettings


def fill(domain: FluidDomain, settings: TetmeshSettings, tell: Progress = silent) -> tuple[FaceMesh, TetmeshMeasures]:
    """Mesh the air, whatever the engine, as faces between cells.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    tell : Progress

    Returns
    -------
    FaceMesh, TetmeshMeasures

    Raises
    ------
    StageError
        If the engine fails, or the fibers' volume is further off than the settings allow.
    """
    mesh, measures = tetrahedralize(domain, settings, tell)
    return mesh.face_mesh(), measures
