"""What meshing made of the fibers, and what it cost."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

from pipeline.nouns.fidelity import Fidelity


@dataclass(frozen=True, slots=True)
class TetmeshMeasures:
    """What the mesher made of the fibers.

    Parameters
    ----------
    points, cells : int
    fluid_volume : float [m3]
    volume_error : float [-]
        Solid volume in the duct, mesh against surface, relative.
    raw_volume_error : float [-]
        The same as the engine left it, before the fibers' points were moved.
    filled_volume : float [-]
        Share of the air, in the tips of crevices, that was given to the fibers.
    faulty_cells : int
        Cells still beyond what mending aims at, a little inside the usual limits.
    mesher_seconds : float [s]
    mesher_peak_memory : int [byte]
        What meshing cost; kept on disk as `MeshingCost`, since equal meshes differ in it.
    fidelity : Fidelity, optional
        How far the walls stand off the true fibers; every finished stage has it.
    """

    points: int
    cells: int
    fluid_volume: float
    volume_error: float
    raw_volume_error: float
    filled_volume: float
    faulty_cells: int
    mesher_seconds: float = 0.0
    mesher_peak_memory: int = 0
    fidelity: Fidelity | None = None


@dataclass(frozen=True, slots=True)
class MeshingCost:
    """What meshing cost.

    Parameters
    ----------
    seconds : float [s]
        Wall time of the engine.
    peak_memory : int [byte]
    """

    seconds: float
    peak_memory: int
