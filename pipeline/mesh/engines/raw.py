"""What an engine leaves before the mesh is mended."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

from pipeline.nouns.arrays import Floats, Ints


@dataclass(frozen=True, eq=False, slots=True)
class RawMesh:
    """Tetrahedra whose boundary on the duct's planes is exactly flat, and what they cost.

    Parameters
    ----------
    points : (n, 3) array [m]
    tets : (m, 4) int array
        Positive; some points may belong to none.
    leash : float [-]
        How far mending may move a point off a fiber's wall, in that fiber's diameters.
    seconds : float [s]
    peak_memory : int [byte]
    """

    points: Floats
    tets: Ints
    leash: float
    seconds: float
    peak_memory: int
