"""Fill the air with cells by the engine that the case names."""

from pipeline.data import FaceMesh, FluidDomain
from pipeline.progress import Progress, silent
from pipeline.tetmesh.finish import TetmeshMeasures, finished
from pipeline.tetmesh.lattice.lattice import stuffed
from pipeline.tetmesh.settings import TetmeshSettings
from pipeline.tetmesh.tetwild import tetrahedralized

_ENGINES = {"lattice": stuffed, "tetwild": tetrahedralized}


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
    unit = 2.0 * float(domain.radius.mean())
    raw = _ENGINES[settings.engine](domain, settings, unit, tell)
    mesh, measures = finished(raw, domain, settings, unit, tell)
    return mesh.face_mesh(), measures
