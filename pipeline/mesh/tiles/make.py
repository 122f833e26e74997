"""Make a piece of a mesh: its cells of the lattice, joined to what earlier pieces left, and repaired."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pipeline.mesh.engines.lattice.lattice import freedom_of, lattice_part
from pipeline.mesh.improve.finish import improved
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.tiles.plan import Piece, TilePlan
from pipeline.mesh.working_mesh import INTERFACE, LATER, WorkingMesh
from pipeline.nouns.arrays import Bools, Floats, Ints, freeze, require
from pipeline.nouns.domain import FluidDomain
from pipeline.progress import Progress, silent

OWN, LEFT_OUT = -1, -2
"""What cells are to a piece; numbers above are the tile they belong to, or that of all tiles for a later piece."""


@dataclass(frozen=True, eq=False, slots=True)
class PieceMesh:
    """Cells of a piece, with what tells their vertices apart from those of all other pieces.

    Parameters
    ----------
    points : (n, 3) array [m]
    names : (n, 2) int array
        The same for the same vertex in two pieces: as in `LatticePart`, or, of one that came in by a split, the
        number of its piece below -1 and a number.
    tets : (m, 4) int array
        Positive.
    across : (m, 4) int array
        As in `WorkingMesh`; ``LATER - 1 - t`` toward the tile t, `LATER` toward what later pieces repair.
    behind : (h, 4) int array
        Cells of other pieces that share a face with its own, where it is a tile.
    faulty : (1,) int array
        Number of cells that repairing could not mend.
    """

    points: Floats
    names: Ints
    tets: Ints
    across: Ints
    behind: Ints
    faulty: Ints

    def __post_init__(self) -> None:
        freeze(
            self,
            points=np.asarray(self.points, np.float64),
            names=np.asarray(self.names, np.int64),
            tets=np.asarray(self.tets, np.int64),
            across=np.asarray(self.across, np.int64),
            behind=np.asarray(self.behind, np.int64),
            faulty=np.asarray(self.faulty, np.int64),
        )
        require(self.names.shape == (len(self.points), 2), "not every vertex has its name")
        require(self.tets.shape == self.across.shape, "not every face has its neighbor")

    def centers(self) -> Floats:
        """Centers of the cells, (m, 3) array [m]."""
        found: Floats = self.points[self.tets].mean(axis=1)
        return found


def make_piece(
    piece: Piece,
    plan: TilePlan,
    domain: FluidDomain,
    settings: TetmeshSettings,
    before: Mapping[int, PieceMesh],
    progress: Progress = silent,
) -> PieceMesh:
    """Make a piece.

    Parameters
    ----------
    piece : Piece
    plan : TilePlan
    domain : FluidDomain
    settings : TetmeshSettings
        Of the lattice.
    before : mapping of int to PieceMesh
        The pieces that it names.
    progress : Progress

    Returns
    -------
    PieceMesh
        Cells at its interfaces are as they were before it, so that the pieces behind fit them.
    """
    part = lattice_part(
        domain,
        settings,
        np.array([*piece.low, domain.box.lower[2]]),
        np.array([*piece.high, domain.box.upper[2]]),
        lambda places: _of_lattice(places, piece, plan),
    )
    sources = [(part.points, part.names, part.tets.astype(np.int64), part.group - 1)]
    for number, earlier in before.items():
        sources.append((earlier.points, earlier.names, earlier.tets, _of_earlier(number, earlier, piece, plan)))
    points, names, tets, toward = _joined(sources)
    whole = WorkingMesh.of(points, tets, freedom_of(domain, settings))
    taken = whole.part(np.flatnonzero(toward == OWN))
    across = np.array(taken.mesh.across)
    cell, side = np.nonzero(across == INTERFACE)
    other = toward[whole.across[taken.cells[cell], side]]
    across[cell, side] = np.where(other == plan.tiles, LATER, LATER - 1 - other)
    start = WorkingMesh(taken.mesh.points, taken.mesh.tets, across, taken.mesh.planes, taken.mesh.freedom)
    mesh, faulty, _ = improved(start, progress)
    fresh = len(mesh.points) - len(taken.vertices)
    new = np.column_stack([np.full(fresh, -2 - piece.number), np.arange(fresh)])
    behind = whole.tets[np.unique(whole.across[taken.cells[cell], side])] if piece.kind == "tile" else whole.tets[:0]
    more = np.setdiff1d(behind, taken.vertices)
    row = np.empty(len(points), np.int64)
    row[taken.vertices], row[more] = np.arange(len(taken.vertices)), len(mesh.points) + np.arange(len(more))
    points = np.concatenate([mesh.points, points[more]])
    names = np.concatenate([names[taken.vertices], new, names[more]])
    used = np.zeros(len(points), np.bool_)
    used[mesh.tets], used[row[behind]] = True, True
    place = np.cumsum(used) - 1
    return PieceMesh(
        points=points[used],
        names=names[used],
        tets=place[mesh.tets],
        across=np.asarray(mesh.across, np.int64),
        behind=place[row[behind]],
        faulty=np.array([faulty]),
    )


def _of_lattice(places: Floats, piece: Piece, plan: TilePlan) -> Ints:
    """Tell what uncut cells of the lattice are to a piece: `OWN`, of a later one, or left out.

    Left out are those that an earlier piece brings along, and those that are too far to have a face in common.
    """
    found = plan.piece_at(places)
    mine = found == piece.number
    earlier = {"x strip": 0, "y strip": len(plan.x), "tile": plan.strips}[piece.kind]
    beside = (found >= earlier) & _near(places, piece, plan)
    return np.where(mine, 1 + OWN, np.where(beside, 1 + plan.tiles, -1))


def _of_earlier(number: int, earlier: PieceMesh, piece: Piece, plan: TilePlan) -> Ints:
    """Tell what the cells of an earlier piece are to this one: `OWN`, of a tile, of a later one, or left out."""
    places = earlier.centers()
    tile = plan.tile_at(places)
    if number >= len(plan.x):
        # what a strip across y made goes to the tiles
        toward = np.where(plan.strips + tile == piece.number, OWN, tile)
    else:
        after = plan.piece_at(places, strips_of_x=False)
        beyond = np.searchsorted(plan.x, places[:, 0]) != _column(piece, plan)
        toward = np.where(beyond, tile, np.where(after == piece.number, OWN, plan.tiles))
        if piece.kind == "tile":
            # a strip across y has taken these over
            toward[~beyond & (after < plan.strips)] = LEFT_OUT
    toward[~_near(places, piece, plan)] = LEFT_OUT
    return toward


def _near(places: Floats, piece: Piece, plan: TilePlan) -> Bools:
    low, high = np.array(piece.low) - plan.beside, np.array(piece.high) + plan.beside
    return np.asarray(((places[:, :2] > low) & (places[:, :2] < high)).all(axis=1))


def _column(piece: Piece, plan: TilePlan) -> int:
    middle = 0.5 * (piece.low[0] + piece.high[0])
    return int(np.searchsorted(plan.x, middle))


def _joined(sources: list[tuple[Floats, Ints, Ints, Ints]]) -> tuple[Floats, Ints, Ints, Ints]:
    """Put cells together whose vertices are the same where their names are."""
    points, names, tets, toward, count = [], [], [], [], 0
    for some, called, cells, where in sources:
        kept = where > LEFT_OUT
        used = np.zeros(len(some), np.bool_)
        used[cells[kept]] = True
        points.append(some[used])
        names.append(called[used])
        tets.append(count + (np.cumsum(used) - 1)[cells[kept]])
        toward.append(where[kept])
        count += int(used.sum())
    every, called = np.concatenate(points), np.concatenate(names)
    first, row = first_of_each(called)
    # what an earlier piece moved does not lie where the lattice has it: those come last, and count
    place = np.empty((len(first), 3))
    place[row] = every
    return place, called[first], row[np.concatenate(tets)], np.concatenate(toward)


def first_of_each(names: Ints) -> tuple[Ints, Ints]:
    """Row of the first of equal names, and for each name which of those it is."""
    order = np.lexsort((names[:, 1], names[:, 0]))
    ordered = names[order]
    new = np.append(True, (ordered[1:] != ordered[:-1]).any(axis=1))
    row = np.empty(len(names), np.int64)
    row[order] = np.cumsum(new) - 1
    return order[new], row
