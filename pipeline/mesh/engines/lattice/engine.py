"""The lattice as an engine: the same mesh each time, quick at any size."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.line.stage import Estimate
from pipeline.mesh.engines.engine import Engine, EngineSettings
from pipeline.mesh.estimate import field_cells

if TYPE_CHECKING:
    from pipeline.mesh.settings import TetmeshSettings
    from pipeline.nouns.domain import FluidDomain
    from pipeline.nouns.mesh import FaceMesh
    from pipeline.nouns.mesh_measures import TetmeshMeasures
    from pipeline.progress import Progress


class LatticeSettings(EngineSettings):
    """What only the lattice reads: no key so far."""


def _mesh(
    domain: "FluidDomain", settings: "TetmeshSettings", progress: "Progress", folder: Path | None
) -> "tuple[FaceMesh, TetmeshMeasures]":
    from pipeline.mesh.engines.lattice.lattice import lattice_mesh
    from pipeline.mesh.improve.finish import finished

    return finished(*lattice_mesh(domain, settings, progress), domain, settings, progress)


def _estimate(slender: float, settings: "TetmeshSettings") -> Estimate:
    # measured on the default case and on the whole mat of Fig. 10: docs/meshing.md
    cells = 2.7 * slender * field_cells(settings)
    return Estimate(cells, 2.5e8 + 900.0 * cells, 1.0 + 7e-5 * cells)


LATTICE = Engine(
    name="lattice",
    meaning="a body-centered cubic lattice cut by the fibers: quick at any size, the same every time",
    settings=LatticeSettings,
    mesh=_mesh,
    cuts_by_axes=True,
    truer="lower tetmesh.edge",
    estimate=_estimate,
    better=lambda settings: (f"tetmesh.edge={0.75 * settings.edge:.3g}",),
)
