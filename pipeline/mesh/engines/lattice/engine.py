"""The lattice as an engine: the same mesh each time, quick at any size."""

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


LONGER = "raise tetmesh.lattice.time_limit, or make the mesh coarser: raise tetmesh.edge"
"""What to do when the time is over."""


class LatticeSettings(EngineSettings):
    """What only the lattice reads."""

    time_limit: Duration = Field(
        default=3600.0, description="The mesher is ended after this time, at the end of the step that it is in."
    )


def _mesh(
    domain: "FluidDomain", settings: "TetmeshSettings", progress: "Progress", folder: Path | None
) -> "tuple[FaceMesh, TetmeshMeasures]":
    from pipeline.mesh.engines.lattice.lattice import FINER, lattice_mesh
    from pipeline.mesh.engines.limits import within
    from pipeline.mesh.improve.finish import finished

    progress = within(settings.own(LatticeSettings).time_limit, "the lattice", LONGER, progress)
    first, finest = FINER
    made = finished(*lattice_mesh(domain, settings, progress, first), domain, settings, progress)
    off = made[1].volume_error
    if abs(off) <= settings.volume_error:
        return made
    # chords across the air beside a fiber that lies along a side, or ends just before one, are its lost volume
    progress(f"meshing again with smaller cubes where air is narrow, since the fibers' volume is off by {off:+.2%}")
    return finished(*lattice_mesh(domain, settings, progress, finest), domain, settings, progress)


def _estimate(slender: Slenderness, settings: "TetmeshSettings") -> Estimate:
    # edges double from level to level, so that fibers of any diameter get smaller ones than they ask for
    each = 3.6 if slender.alike else 10.0
    return estimate_for(each * slender.total * field_cells(settings))


def estimate_for(cells: float) -> Estimate:
    """Give memory and time for so many cells, measured on Fig. 10's mat and pieces of it: docs/meshing.md."""
    return Estimate(cells, 2.5e8 + 240.0 * cells, 1.0 + 1.1e-5 * cells)


LATTICE = Engine(
    name="lattice",
    meaning="a body-centered cubic lattice cut by the fibers: quick at any size, the same every time",
    settings=LatticeSettings,
    mesh=_mesh,
    cuts_by_axes=True,
    in_tiles=True,
    truer="lower tetmesh.edge",
    estimate=_estimate,
    better=lambda settings: (f"tetmesh.edge={0.75 * settings.edge:.3g}",),
)
