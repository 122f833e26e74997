"""What became of a mesh that was made in tiles."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

RESULT = "tiles.json"
"""File that holds it."""


@dataclass(frozen=True, slots=True)
class TileReport:
    """One tile.

    Parameters
    ----------
    tile : int
        Its number, and that of its ``processorN``.
    neighbors : tuple of int
        Tiles that it borders on.
    cells, points : int
    interface_faces : int
        Faces that it shares with other tiles.
    volume : float [m3]
    verdict : str
        As in `QualityReport`, of its cells and of all their faces, those toward other tiles included; ``fail`` too
        where its walls are farther off than the case allows.
    reasons : tuple of str
        What does not hold.
    max_non_orthogonality : float [degree]
    max_skewness : float [-]
    mean_deviation, typical_deviation : float [-]
        Of its walls, as in `Fidelity`.
    seconds : float [s]
        Of processor time, for its cells and its files.
    peak_memory : int [byte]
        Most that the process held that made it, and what it made before.
    """

    tile: int
    neighbors: tuple[int, ...]
    cells: int
    points: int
    interface_faces: int
    volume: float
    verdict: str
    reasons: tuple[str, ...]
    max_non_orthogonality: float
    max_skewness: float
    mean_deviation: float
    typical_deviation: float
    seconds: float
    peak_memory: int


@dataclass(frozen=True, slots=True)
class TiledMesh:
    """A mesh in tiles, of which no memory holds more than one.

    Parameters
    ----------
    counts : (int, int)
        Tiles along x and y.
    tiles : tuple of TileReport
    cells : int
    fluid_volume : float [m3]
    volume_error : float [-]
        Of the fibers against their surface; above 0 they are too thick.
    verdict : str
        The worst of the tiles', or ``fail`` where the fibers' volume is further off than the case allows.
    cut_off_cells : int
        Cells of pockets of air between tiles that no way leads to; they are left out.
    strip_seconds : float [s]
        Of processor time, for what lies across the cuts.
    seconds : float [s]
        From beginning to end.
    """

    counts: tuple[int, int]
    tiles: tuple[TileReport, ...]
    cells: int
    fluid_volume: float
    volume_error: float
    verdict: str
    cut_off_cells: int
    strip_seconds: float
    seconds: float
