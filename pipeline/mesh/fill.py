"""Fill the air with cells by the engine that the case names, and check what it made of the fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace
from pathlib import Path

import numpy as np

from pipeline.errors import StageError
from pipeline.mesh.engines.flawed import FlawedMeshError
from pipeline.mesh.estimate import UNSURE, slenderness, too_large
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.wall_error import fidelity
from pipeline.mesh.wall_fibers import wall_fibers
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fidelity import Fidelity
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.progress import NOTE, Progress, silent

_LONG = 120.0  # seconds of processor time that are said before they are spent


def fill(
    domain: FluidDomain, settings: TetmeshSettings, progress: Progress = silent, folder: Path | None = None
) -> tuple[FaceMesh, TetmeshMeasures]:
    """Mesh the air, whatever the engine, as faces between cells.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    progress : Progress
    folder : Path, optional
        Of the stage's result, where an engine that is a program of its own leaves what it was told.

    Returns
    -------
    FaceMesh, TetmeshMeasures
        Each wall face of the mesh with its fiber.

    Raises
    ------
    StageError
        If the mesh would not fit into memory, or the engine fails, or leaves cells without volume, or the fibers'
        volume or their walls are further off than the settings allow, however often it is run.
    """
    engine = settings.mesher
    slender = slenderness(domain)
    expected = engine.estimate(slender, settings) if engine.estimate is not None else None
    if expected is not None and (reason := too_large(expected, slender, settings, UNSURE)) is not None:
        raise StageError(reason)
    if expected is not None and expected.seconds > _LONG:
        progress(
            f"{NOTE}{engine.name} will take about {expected.seconds / 60:.0f} minutes for some {expected.cells:,.2g} "
            f"cells; {engine.quicker}"
        )
    for left in reversed(range(engine.tries)):
        try:
            return _sound(domain, settings, progress, folder)
        except FlawedMeshError as flaw:
            if not left:
                raise FlawedMeshError(f"{flaw} ({engine.tries} runs)" if engine.tries > 1 else str(flaw)) from flaw
            progress(f"meshing again, since {flaw}")
    raise AssertionError("an engine is tried at least once")


def _sound(
    domain: FluidDomain, settings: TetmeshSettings, progress: Progress, folder: Path | None
) -> tuple[FaceMesh, TetmeshMeasures]:
    """Mesh once, and hold the mesh against the fibers."""
    engine = settings.mesher
    mesh, measures = engine.mesh(domain, settings, progress, folder)
    progress("measuring the walls", 0.95)
    mesh = replace(mesh, fiber=wall_fibers(mesh, domain))
    found = fidelity(mesh, domain)
    if abs(measures.volume_error) > settings.volume_error:
        raise FlawedMeshError(
            f"the mesh keeps the fibers' volume to {measures.volume_error:+.2%}, allowed is "
            f"{settings.volume_error:.2%}{_most_off(found, domain)}; {engine.truer}, or raise tetmesh.volume_error"
        )
    faults = found.faults(settings.deviation)
    if faults:
        raise FlawedMeshError(
            f"the mesh does not keep the fibers: {'; '.join(faults)}; {engine.truer} (the edge is {settings.edge:g} "
            f"diameters), or raise tetmesh.deviation (now {settings.deviation:g})"
        )
    return mesh, replace(measures, fidelity=found)


def _most_off(found: Fidelity, domain: FluidDomain) -> str:
    """Name the fiber whose walls miss the most of its volume, and where it is; nothing where no axis is known."""
    if not len(domain.pieces):
        return ""
    worst = max(found.fibers, key=lambda walls: abs(walls.radius_error) * walls.area * walls.diameter**3)
    own = np.flatnonzero(domain.pieces.fiber == worst.fiber)
    piece = own[len(own) // 2]
    x, y, z = 5e5 * (domain.pieces.start[piece] + domain.pieces.end[piece])
    return (
        f", most of it at fiber {worst.fiber} of {len(found.fibers)} (d {worst.diameter * 1e6:.3g} um, through "
        f"({x:.3g}, {y:.3g}, {z:.3g}) um), whose walls stand {worst.radius_error:+.1%} of its radius off it"
    )


def engine_missing(settings: TetmeshSettings) -> str | None:
    """Say why the engine cannot run on this machine, and what to do; None where it can."""
    return settings.mesher.missing(settings)
