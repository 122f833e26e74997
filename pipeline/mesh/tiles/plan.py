"""Where a duct is cut into tiles, and which piece of work each cell of the lattice belongs to.

A cell that is repaired must not have a neighbor that is repaired elsewhere, unless both stay as they are. So cells next
to a cut are repaired first, in strips across it that reach over both sides; what they leave at the cut is kept by both
tiles. Strips across x go first, from end to end; then what is left of those across y, between two cuts of x each; then
what is left of the tiles::

      x strip
         |
    +---|---|---+
    |   |   |   |
    |---|   |---|   y strips
    |---|   |---|
    |   |   |   |
    +---|---|---+
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pipeline.errors import CaseError
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain

_STRIP = 4.0  # edges of the cells at a fiber on either side of a cut that a strip reaches; two of them wait for a tile
_OFF = 0.37  # half smallest cubes between a cut and the lattice: no cell's center may lie on one


@dataclass(frozen=True, slots=True)
class Piece:
    """What one process makes.

    Parameters
    ----------
    number : int
        In the order of the plan.
    kind : "x strip", "y strip" or "tile"
    low, high : (x, y) [m]
        What it reaches over; may go beyond the duct.
    before : tuple of int
        Pieces that have to be there first.
    """

    number: int
    kind: Literal["x strip", "y strip", "tile"]
    low: tuple[float, float]
    high: tuple[float, float]
    before: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class TilePlan:
    """How a duct is cut.

    Parameters
    ----------
    x, y : tuple of float [m]
        Where it is cut across each axis.
    reach : float [m]
        How far a strip reaches on either side of a cut.
    beside : float [m]
        How far from a piece the centers of cells may lie that share a face with it.
    lower, upper : (x, y) [m]
        Corners of the duct.
    """

    x: tuple[float, ...]
    y: tuple[float, ...]
    reach: float
    beside: float
    lower: tuple[float, float]
    upper: tuple[float, float]

    @property
    def tiles(self) -> int:
        """Number of tiles."""
        return (len(self.x) + 1) * (len(self.y) + 1)

    @property
    def strips(self) -> int:
        """Number of strips; tile t is the piece ``strips + t``."""
        return len(self.x) + (len(self.x) + 1) * len(self.y)

    def pieces(self) -> tuple[Piece, ...]:
        """Give the pieces in an order in which they can be made."""
        (x0, y0), (x1, y1) = self.lower, self.upper
        xs, ys = (x0, *self.x, x1), (y0, *self.y, y1)
        found = [Piece(k, "x strip", (cut - self.reach, y0), (cut + self.reach, y1)) for k, cut in enumerate(self.x)]
        for i in range(len(self.x) + 1):
            beside = tuple(k for k in (i - 1, i) if 0 <= k < len(self.x))
            for cut in self.y:
                low, high = (xs[i], cut - self.reach), (xs[i + 1], cut + self.reach)
                found.append(Piece(len(found), "y strip", low, high, beside))
        for i in range(len(self.x) + 1):
            beside = tuple(k for k in (i - 1, i) if 0 <= k < len(self.x))
            for j in range(len(self.y) + 1):
                across = tuple(len(self.x) + i * len(self.y) + k for k in (j - 1, j) if 0 <= k < len(self.y))
                found.append(Piece(len(found), "tile", (xs[i], ys[j]), (xs[i + 1], ys[j + 1]), (*beside, *across)))
        return tuple(found)

    def tile_at(self, places: Floats) -> Ints:
        """Tile at each place, (n,) int array; `places` are (n, 2) or more columns [m]."""
        found: Ints = np.searchsorted(self.x, places[:, 0]) * (len(self.y) + 1) + np.searchsorted(self.y, places[:, 1])
        return found

    def piece_at(self, places: Floats, strips_of_x: bool = True) -> Ints:
        """Piece that a cell with its center at each place belongs to, (n,) int array.

        Parameters
        ----------
        places : (n, 2) array, or more columns [m]
        strips_of_x : bool
            Whether strips across x still count; else it is what comes after them.
        """
        found = self.strips + self.tile_at(places)
        column = np.searchsorted(self.x, places[:, 0])
        for k, cut in enumerate(self.y):
            near = np.abs(places[:, 1] - cut) < self.reach
            found[near] = len(self.x) + column[near] * len(self.y) + k
        if strips_of_x:
            for k, cut in enumerate(self.x):
                found[np.abs(places[:, 0] - cut) < self.reach] = k
        return found


def refuse_uncut(settings: TetmeshSettings, cyclic: bool) -> None:
    """Refuse what no tiles are made of.

    Raises
    ------
    CaseError
    """
    if not settings.mesher.in_tiles:
        raise CaseError(
            f'tiles need tetmesh.engine = "lattice", whose cells are the same whoever makes them; it is '
            f'"{settings.engine}"'
        )
    if cyclic:
        raise CaseError('tiles need enclosure.sides = "symmetry" or "slip": cyclic sides are not cut into tiles')


def plan(domain: FluidDomain, settings: TetmeshSettings, tiles: tuple[int, int]) -> TilePlan:
    """Cut a duct into tiles of one size.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
        Of the lattice.
    tiles : (int, int)
        Along x and y.

    Returns
    -------
    TilePlan

    Raises
    ------
    CaseError
        If the tiles would be too narrow for their strips, the sides are cyclic, or another engine is chosen.
    """
    from pipeline.mesh.engines.lattice.lattice import cubes_of

    refuse_uncut(settings, domain.cyclic)
    _, edge, largest = cubes_of(domain, settings)
    reach = max(_STRIP * settings.edge * 2.0 * float(domain.radius.max()), largest * float(edge.max()))
    cuts = []
    for axis, count in enumerate(tiles):
        lower, size = domain.box.lower[axis], domain.box.size[axis]
        # a tile between two cuts holds half a strip at either side, one at the end of the duct at one side
        between, at_end = 2.0 * reach + largest * float(edge[axis]), reach + largest * float(edge[axis])
        narrowest = between if count > 2 else at_end
        if count > 1 and size / count < narrowest:
            most = max(int(size / between), 2 if size >= 2.0 * at_end else 1)
            raise CaseError(
                f"{count} tiles along {'xy'[axis]} are {1e6 * size / count:.3g} um wide, and what is repaired on both "
                f"sides of a cut takes {1e6 * narrowest:.3g} um; take at most {most}"
            )
        step = 0.5 * float(edge[axis])
        places = np.round(np.arange(1, count) * size / count / step) + _OFF
        cuts.append(tuple((lower + step * places).tolist()))
    return TilePlan(cuts[0], cuts[1], reach, largest * float(edge.max()), domain.box.lower[:2], domain.box.upper[:2])
