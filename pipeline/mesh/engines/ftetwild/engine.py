"""FTetWild as an engine: a few well-placed cells whose walls keep within an envelope of the fibers' surface."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import Field

from pipeline.line.stage import Estimate
from pipeline.mesh.engines.engine import Engine, EngineSettings, Slenderness
from pipeline.mesh.estimate import field_cells
from pipeline.units import Duration, PositiveRatio

if TYPE_CHECKING:
    from pipeline.mesh.settings import TetmeshSettings
    from pipeline.nouns.domain import FluidDomain
    from pipeline.nouns.mesh import FaceMesh
    from pipeline.nouns.mesh_measures import TetmeshMeasures
    from pipeline.progress import Progress


class TetwildSettings(EngineSettings):
    """What only fTetWild reads."""

    envelope: PositiveRatio = Field(
        default=0.04,
        le=0.25,
        description="How far the mesh's boundary may stray from the fibers' surface, in diameters of the thinnest "
        "fiber.",
    )
    passes: int = Field(
        default=1,
        ge=1,
        le=200,
        description="Rounds of splitting, collapsing, swapping and smoothing before the edge lengths are refined.",
    )
    stop_energy: PositiveRatio = Field(
        default=1000.0,
        ge=3.0,
        description="Conformal energy of the worst tetrahedron at which rounds end (3 is ideal); "
        "the few cells that a solver would object to are mended afterwards.",
    )
    time_limit: Duration = Field(default=3600.0, description="The mesher is ended after this time.")


def _mesh(
    domain: "FluidDomain", settings: "TetmeshSettings", progress: "Progress", folder: Path | None
) -> "tuple[FaceMesh, TetmeshMeasures]":
    from pipeline.mesh.engines.ftetwild.ftetwild import tetrahedralized
    from pipeline.mesh.improve.finish import finished

    unit = domain.mean_diameter
    return finished(*tetrahedralized(domain, settings, unit, progress), domain, settings, progress)


def _estimate(slender: Slenderness, settings: "TetmeshSettings") -> Estimate:
    # measured on the smoke case, the default at edges of 0.6 and 1.0, and on figure10_corner at 1.0 (docs/meshing.md);
    # the surface's triangles, some 46 per diameter of length, cost more than cells, and time grows faster than both
    total = slender.total
    field = total * field_cells(settings)
    slower = 1.0 + total / 1500.0
    seconds = 1.0 + slower * (0.035 * total + 1.9e-4 * field)
    return Estimate(76.0 * total + 0.6 * field, 2.5e8 + 1e5 * total + 300.0 * field, seconds)


TETWILD = Engine(
    name="tetwild",
    meaning="fTetWild: few cells, true walls; time grows faster than cells, and it differs a little from run to run",
    settings=TetwildSettings,
    mesh=_mesh,
    truer="lower tetmesh.tetwild.envelope or tetmesh.edge",
    estimate=_estimate,
    quicker='raise tetmesh.edge, or set tetmesh.engine = "lattice"',
    better=lambda settings: (f"tetmesh.tetwild.passes={2 * settings.own(TetwildSettings).passes}",),
    tries=3,
)
