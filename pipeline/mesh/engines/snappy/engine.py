"""OpenFOAM's snappyHexMesh as an engine: hexahedra, on as many cores and machines as MPI has."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field

from pipeline.line.stage import Estimate
from pipeline.mesh.engines.engine import Engine, EngineSettings, Slenderness
from pipeline.mesh.estimate import field_cells
from pipeline.units import Duration

if TYPE_CHECKING:
    from pipeline.mesh.settings import TetmeshSettings
    from pipeline.nouns.domain import FluidDomain
    from pipeline.nouns.mesh import FaceMesh
    from pipeline.nouns.mesh_measures import TetmeshMeasures
    from pipeline.progress import Progress

CASE = "snappy"
"""Folder of the stage's result that holds the case."""


class SnappySettings(EngineSettings):
    """What only snappyHexMesh reads."""

    cores: int = Field(default=1, ge=1, le=4096, description="Processes that it runs in; above 1 needs MPI.")
    time_limit: Duration = Field(default=3600.0, description="The mesher is ended after this time.")


def _mesh(
    domain: "FluidDomain", settings: "TetmeshSettings", progress: "Progress", folder: Path | None
) -> "tuple[FaceMesh, TetmeshMeasures]":
    from pipeline.mesh.engines.snappy.mesh import snapped

    return snapped(domain, settings, progress, folder / CASE if folder is not None else None)


def _missing(settings: "TetmeshSettings") -> str | None:
    from pipeline.mesh.engines.snappy.running import missing

    return missing(settings.own(SnappySettings).cores)


def _estimate(slender: Slenderness, settings: "TetmeshSettings") -> Estimate:
    # measured on the default case: docs/meshing.md
    cells = 1.4 * slender.total * field_cells(settings)
    return Estimate(cells, 1e8 + 4500.0 * cells, 3.0 + 3e-4 * cells)


SNAPPY = Engine(
    name="snappy",
    meaning="OpenFOAM's snappyHexMesh: hexahedra split near the fibers, on many cores and machines; OpenFOAM has to "
    "be installed; its cubes have half of `edge` and the volume of a tetrahedron",
    settings=SnappySettings,
    mesh=_mesh,
    truer="lower tetmesh.edge",
    estimate=_estimate,
    quicker="raise tetmesh.edge or tetmesh.snappy.cores",
    better=lambda settings: (f"tetmesh.edge={0.75 * settings.edge:.3g}",),
    missing=_missing,
)
