"""Fill the air with cells by the engine that the case names."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace
from pathlib import Path

from pipeline.errors import StageError
from pipeline.mesh.engines.ftetwild.ftetwild import tetrahedralized
from pipeline.mesh.engines.lattice.lattice import stuffed
from pipeline.mesh.engines.snappy.mesh import CASE, snapped
from pipeline.mesh.engines.snappy.running import missing
from pipeline.mesh.improve.finish import TetmeshMeasures, finished
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.wall_error import fidelity
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import Progress, silent

_TRIES = 3  # of fTetWild at walls that stand on the fibers
_ENGINES = {"lattice": stuffed, "tetwild": tetrahedralized}


def fill(
    domain: FluidDomain, settings: TetmeshSettings, tell: Progress = silent, folder: Path | None = None
) -> tuple[FaceMesh, TetmeshMeasures]:
    """Mesh the air, whatever the engine, as faces between cells.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    tell : Progress
    folder : Path, optional
        Of the stage's result, where an engine that is a program of its own leaves what it was told.

    Returns
    -------
    FaceMesh, TetmeshMeasures

    Raises
    ------
    StageError
        If the engine fails, or the fibers' volume or their walls are further off than the settings allow.
    """
    # fTetWild differs each time, and may leave a film of solid on a plane of the duct
    for _ in range(_TRIES if settings.engine == "tetwild" else 1):
        mesh, measures = _filled(domain, settings, tell, folder)
        tell("measuring the walls", 0.95)
        found = fidelity(mesh, domain)
        if found.typical_deviation <= settings.deviation:
            return mesh, replace(measures, fidelity=found)
    raise StageError(
        f"a hundredth of the fibers' walls is farther than {found.typical_deviation:.3g} diameters from the true "
        f"fibers, allowed is {settings.deviation:g}; lower tetmesh.edge (now {settings.edge:g} diameters) or raise "
        "tetmesh.deviation"
    )


def _filled(
    domain: FluidDomain, settings: TetmeshSettings, tell: Progress, folder: Path | None
) -> tuple[FaceMesh, TetmeshMeasures]:
    if settings.engine == "snappy":
        return snapped(domain, settings, tell, folder / CASE if folder is not None else None)
    unit = 2.0 * float(domain.radius.mean())
    raw = _ENGINES[settings.engine](domain, settings, unit, tell)
    mesh, measures = finished(raw, domain, settings, unit, tell)
    return mesh.face_mesh(), measures


def engine_missing(settings: TetmeshSettings) -> str | None:
    """Say why the engine cannot run on this machine, and what to do; None where it can."""
    return missing(settings.cores) if settings.engine == "snappy" else None
