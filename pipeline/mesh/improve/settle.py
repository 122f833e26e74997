"""Mend a mesh around its faulty cells, and fill the crevices where mending cannot help.

Some cells in ten thousand are faulty: all work but looking for them is done on these and the cells around them.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.geometry.tets import FACES, volumes
from pipeline.geometry.triangles import area_vectors, vertex_sums
from pipeline.mesh.boundary import assign, free_axes
from pipeline.mesh.improve.corners import split_corners, split_longest, true_boundary
from pipeline.mesh.improve.crevices import in_crevice
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.patches import FIBERS

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance

_SWEEPS = 20  # of mending; the last of them move next to nothing
_FILLINGS = 8  # rounds of mending and filling crevices
_PATIENCE = 3  # rounds before cells that cannot be mended are filled though a vertex of theirs could move
_RINGS = 3  # of cells around the faulty ones that take part
_FLAT = 0.9  # length of the summed area vectors at a vertex over the summed areas
_PASSES = 8  # over the whole mesh: what is filled may leave corners elsewhere


@dataclass(frozen=True, eq=False, slots=True)
class Reaches:
    """How far a vertex of a wall may move, by the fiber next to it.

    Parameters
    ----------
    distance : FiberDistance
    diameter : (fibers,) array [m]
    off, along : float
        How far it may move off its wall and along it, in diameters.
    """

    distance: "FiberDistance"
    diameter: Floats
    off: float
    along: float

    def at(self, points: Floats) -> tuple[Floats, Floats]:
        """Give how far points may move off the wall and along it, two (n,) arrays [m]."""
        _, piece = self.distance.with_piece(points)
        diameter = self.diameter[self.distance.field[2][np.maximum(piece, 0)]]
        # a wall far from every fiber is nobody's: the thinnest decides
        diameter = np.where(piece >= 0, diameter, self.diameter.min())
        return self.off * diameter, self.along * diameter


def settled(points: Floats, tets: Ints, domain: FluidDomain, reaches: Reaches) -> tuple[Floats, Ints, int, float]:
    """Mend and fill until no cell is faulty or nothing helps.

    Parameters
    ----------
    points : (n, 3) array [m]
    tets : (m, 4) int array
    domain : FluidDomain
    reaches : Reaches
        How far a vertex of a fiber may move.

    Returns
    -------
    points : (k, 3) array [m]
    tets : (j, 4) int array
        One part that hangs together.
    faulty : int
        Cells still beyond what mending aims at.
    filled : float [m3]
        Air that was given to the fibers.
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.adjacency import largest_part_of, neighbors, ring
    from pipeline.mesh.improve.mend import faults

    filled = 0.0
    for turn in range(_PASSES):
        across = neighbors(tets)
        whole = largest_part_of(across)
        if not whole.all():
            tets = tets[whole]
            across = neighbors(tets)
        faulty = faults(points, tets, across) > 1.0
        near = faulty | ((across < 0).sum(axis=1) > 1)
        if not near.any():
            break
        for _ in range(_RINGS):
            near = ring(tets, near, len(points))
        cell, side = np.nonzero((across >= 0) & near[:, None])
        out = ~near[across[cell, side]]
        seam = np.sort(np.take_along_axis(tets[cell[out]], FACES[side[out]], axis=1), axis=1)
        # moves alone mend nearly all: what is filled or split later is looked for around the few cells that are left
        rounds = _FILLINGS if turn else 1
        points, mended, tips = _settled_here(points, tets[near], seam, domain, reaches, rounds)
        tets = np.concatenate([tets[~near], mended])
        filled += tips
    across = neighbors(tets)
    whole = largest_part_of(across)
    # parts share no face: what is faulty in one is so without the others
    faulty = faults(points, tets, across)[whole] > 1.0
    return points, tets[whole], int(faulty.sum()), filled


def _settled_here(
    points: Floats, tets: Ints, seam: Ints, domain: FluidDomain, reaches: Reaches, rounds: int
) -> tuple[Floats, Ints, float]:
    """Settle a part of the mesh that ends at a seam, and give the state with the fewest faulty cells."""
    from pipeline.mesh.improve.mend import mended

    filled, fewest = 0.0, len(tets) ** 2
    best = (points, tets, filled)
    fixed = np.unique(seam)
    loose = np.empty(0, np.int64)
    limits = np.array(domain.box.lower), np.array(domain.box.upper)
    for filling in range(rounds):
        points, tets = split_corners(points, tets, seam, keep_edges=domain.cyclic)
        walls, at_wall = true_boundary(tets, seam)
        fibers = walls[assign(points, walls, domain.box, tolerance=0.0) == domain.patches.index(FIBERS)]
        leash = np.full(len(points), np.inf)
        slide = np.zeros(len(points))
        on_wall = np.unique(fibers)
        leash[on_wall], slide[on_wall] = reaches.at(points[on_wall])
        # where a tip was filled the wall is no fiber's: its vertices may move
        loose = np.intersect1d(loose, on_wall)
        leash[loose] = np.maximum(slide[loose], leash[loose])
        # the cells behind the seam do not know what happens here
        leash[tets[_with_three(tets, fixed, len(points))]] = 0.0
        points, faulty = mended(
            points,
            tets,
            free_axes(points, domain.box, domain.cyclic),
            leash,
            _SWEEPS,
            limits,
            wall_normals(points, fibers),
            slide,
        )
        # a flat cell is worse than any number of merely bad ones
        count = int(faulty.sum()) + len(tets) * int((volumes(points, tets) <= 0.0).sum())
        if count < fewest:
            fewest, best = count, (points, tets, filled)
        if not faulty.any() or filling == rounds - 1:
            break
        stuck = filling >= _PATIENCE
        # away from the fibers nothing is a crevice: a filled cell at the inlet of a coarse mesh doubled a pressure drop
        crevice = in_crevice(tets, walls, at_wall, len(points), faulty, stuck) & at_fibers(tets, fibers, len(points))
        if domain.cyclic:
            # what were filled or split on one side would have no partner opposite
            box = domain.box
            at_side = ((points == box.lower) | (points == box.upper))[:, :2].any(axis=1)[tets].sum(axis=1)
            crevice &= at_side < 1
            faulty &= at_side < 2
        filled += float(volumes(points, tets[crevice]).sum())
        loose = np.union1d(loose, tets[crevice])
        tets, faulty = tets[~crevice], faulty[~crevice]
        if stuck and faulty.any():
            points, tets = split_longest(points, tets, faulty, seam)
    return best


def wall_normals(points: Floats, walls: Ints) -> Floats:
    """Give the unit normal at each vertex where the wall is nearly flat, else 0.

    Parameters
    ----------
    points : (n, 3) array [m]
    walls : (b, 3) int array

    Returns
    -------
    (n, 3) array
    """
    vectors = area_vectors(points, walls)
    areas = np.linalg.norm(vectors, axis=1)
    normals = vertex_sums(walls, vectors, len(points))
    total = np.bincount(walls.ravel(), np.repeat(areas, 3), len(points))
    length = np.linalg.norm(normals, axis=1)
    # where fibers meet, or a wall ends at a plane of the duct, no direction is along it
    flat = (length > _FLAT * total) & (total > 0.0)
    return np.where(flat[:, None], normals / np.where(flat, length, 1.0)[:, None], 0.0)


def _with_three(tets: Ints, fixed: Ints, vertices: int) -> npt.NDArray[np.bool_]:
    """Find the cells that have a face of fixed vertices."""
    is_fixed = np.zeros(vertices, dtype=bool)
    is_fixed[fixed] = True
    return np.asarray(is_fixed[tets].sum(axis=1) >= 3)


def at_fibers(tets: Ints, fibers: Ints, vertices: int) -> npt.NDArray[np.bool_]:
    """Find the cells that touch a fiber, if only with a vertex.

    Parameters
    ----------
    tets : (m, 4) int array
    fibers : (b, 3) int array
        Faces on the fibers.
    vertices : int
        Number of vertices.

    Returns
    -------
    (m,) bool array
    """
    on_fibers = np.zeros(vertices, dtype=bool)
    on_fibers[fibers] = True
    return np.asarray(on_fibers[tets].any(axis=1))
