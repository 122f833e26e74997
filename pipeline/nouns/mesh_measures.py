"""What meshing made of the fibers, and what it cost."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Fidelity:
    """Distance between the mesh's walls and the true cylinders, weighted by area.

    Parameters
    ----------
    mean_deviation : float [-]
        Mean distance of the walls from the nearest cylinder, either way, in mean fiber diameters.
    typical_deviation : float [-]
        99 % of the walls' area is nearer than this, in mean fiber diameters.
    largest_deviation : float [-]
        Of all, in mean fiber diameters: found where fibers meet, and the sharp air between them is filled.
    radius_error : tuple of float [-]
        Of each fiber with walls in the duct, by number (0 for one without): how much its walls stand off its true
        radius on average, relative; above 0 they stand outside.
    """

    mean_deviation: float
    typical_deviation: float
    largest_deviation: float
    radius_error: tuple[float, ...]


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
