"""What an engine says about itself, and the one contract that all of them keep."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict

if TYPE_CHECKING:
    from pipeline.line.stage import Estimate
    from pipeline.mesh.settings import TetmeshSettings
    from pipeline.nouns.domain import FluidDomain
    from pipeline.nouns.mesh import FaceMesh
    from pipeline.nouns.mesh_measures import TetmeshMeasures
    from pipeline.progress import Progress


@dataclass(frozen=True, slots=True)
class Slenderness:
    """What the cells of a mesh go with.

    Parameters
    ----------
    total : float [-]
        Sum over all fibers of length over diameter.
    alike : bool
        Whether all fibers have one diameter.
    """

    total: float
    alike: bool = True


class EngineSettings(BaseModel):
    """Keys that one engine alone reads; an engine without any takes this as it is."""

    model_config = ConfigDict(frozen=True, extra="forbid")


@dataclass(frozen=True, slots=True)
class Engine:
    """A mesher that a case may name.

    Parameters
    ----------
    name : str
        Value of `tetmesh.engine`, and the name of its own table in `[tetmesh]`.
    meaning : str
        What it is, for the case file's reference.
    settings : type of EngineSettings
        Its own table.
    mesh : callable
        Fills the air with cells: takes the domain, the settings, who is told of progress, and the folder of the stage's
        result (or None), where a program of its own leaves what it was told; gives the mesh and its measures, whose
        fidelity is measured afterwards. It imports its numerics when it is called, since no case file should wait
        for them. Raises StageError.
    truer : str
        What brings the walls nearer to the fibers, as the end of a message.
    better : callable
        Gives what to set for better cells than these settings made, as ``table.key=value``.
    missing : callable
        Says why it cannot run on this machine and what to do, or None where it can.
    estimate : callable, optional
        Gives cells, memory and processor time for the fibers' slenderness and the
        settings, within some ten percents.
    quicker : str
        What makes it quicker, as the end of a message.
    cuts_by_axes : bool
        Whether it needs the fibers' axes: a medium that is there as a surface has none.
    in_tiles : bool
        Whether `fibertwin tiles` meshes a case with it a part at a time.
    tries : int
        How often it is run until the mesh is sound: an engine that differs each time may do better.
    """

    name: str
    meaning: str
    settings: type[EngineSettings]
    mesh: Callable[["FluidDomain", "TetmeshSettings", "Progress", Path | None], "tuple[FaceMesh, TetmeshMeasures]"]
    truer: str
    better: Callable[["TetmeshSettings"], tuple[str, ...]]
    missing: Callable[["TetmeshSettings"], str | None] = lambda settings: None
    estimate: Callable[[Slenderness, "TetmeshSettings"], "Estimate"] | None = None
    quicker: str = "raise tetmesh.edge"
    tries: int = 1
    cuts_by_axes: bool = False
    in_tiles: bool = False
