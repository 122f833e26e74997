"""The lattice as an engine: the same mesh each time, quick at any size."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.mesh.engines.engine import Engine, EngineSettings

if TYPE_CHECKING:
    from pipeline.mesh.settings import TetmeshSettings
    from pipeline.nouns.domain import FluidDomain
    from pipeline.nouns.mesh import FaceMesh
    from pipeline.nouns.mesh_measures import TetmeshMeasures
    from pipeline.progress import Progress


class LatticeSettings(EngineSettings):
    """What only the lattice reads: no key so far."""


def _mesh(
    domain: "FluidDomain", settings: "TetmeshSettings", tell: "Progress", folder: Path | None
) -> "tuple[FaceMesh, TetmeshMeasures]":
    from pipeline.mesh.engines.lattice.lattice import lattice_mesh
    from pipeline.mesh.improve.finish import finished

    return finished(lattice_mesh(domain, settings, tell), domain, settings, tell)


LATTICE = Engine(
    name="lattice",
    meaning="a body-centered cubic lattice cut by the fibers: quick at any size, the same every time",
    settings=LatticeSettings,
    mesh=_mesh,
    truer="lower tetmesh.edge",
    better=lambda settings: (f"tetmesh.edge={0.75 * settings.edge:.3g}",),
)
