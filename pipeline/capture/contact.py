"""Where the true fibers are, quick to ask for at any place: the pieces near each cube of a grid."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import NamedTuple

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.fibers import short_pieces, to_piece
from pipeline.nouns.arrays import Bools, Floats, Ints

_MOST_CUBES = 1_000_000


class FiberGrid(NamedTuple):
    """The pieces of fibers that come near each cube of a grid.

    Parameters
    ----------
    start, end : (n, 3) arrays [m]
        Axes of short pieces.
    radius : (n,) array [m]
    flat : (n, 2) bool array
    source : (n,) int array
        Which of the pieces given each is a part of.
    first, member : int arrays
        Cube k is near the pieces ``member[first[k]:first[k + 1]]``.
    lower : (3,) array [m]
        Corner of the grid.
    shape : (3,) int array
    size : float [m]
        Edge of a cube.
    reach : float [m]
        A surface farther than this from a place is not told.
    """

    start: Floats
    end: Floats
    radius: Floats
    flat: Bools
    source: Ints
    first: Ints
    member: Ints
    lower: Floats
    shape: Ints
    size: float
    reach: float


def fiber_grid(
    start: Floats, end: Floats, radius: Floats, flat: Bools, lower: Floats, upper: Floats, reach: float
) -> FiberGrid:
    """Sort pieces of fibers into a grid over a box.

    Parameters
    ----------
    start, end : (n, 3) arrays [m]
    radius : (n,) array [m]
    flat : (n, 2) bool array
        Whether a piece ends flat at its start and at its end; else it ends in half a ball.
    lower, upper : (3,) arrays [m]
        The box.
    reach : float [m]
        Up to which distance from a surface places are to know it.

    Returns
    -------
    FiberGrid
    """
    start, end, radius, flat, source = short_pieces(start, end, radius, flat)
    extent = upper - lower
    size = max(float(radius.mean()), (float(np.prod(extent)) / _MOST_CUBES) ** (1.0 / 3.0))
    shape = np.maximum(np.ceil(extent / size).astype(np.int64), 1)
    first, member = _sorted_in(start, end, radius, flat, lower, shape, size, reach)
    return FiberGrid(start, end, radius, flat, source, first, member, lower, shape, size, reach)


@compiled
def _sorted_in(
    start: Floats, end: Floats, radius: Floats, flat: Bools, lower: Floats, shape: Ints, size: float, reach: float
) -> tuple[Ints, Ints]:
    cubes = shape[0] * shape[1] * shape[2]
    first = np.zeros(cubes + 1, np.int64)
    member = np.empty(0, np.int64)
    # from a cube's center to its corner
    allowed = reach + 0.5 * math.sqrt(3.0) * size
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    for turn in range(2):
        if turn == 1:
            # backwards, so that each list ends up at its own start with the pieces in order
            first = np.cumsum(first)
            member = np.empty(first[-1], np.int64)
        for number in range(len(start)):
            piece = number if turn == 0 else len(start) - 1 - number
            for axis in range(3):
                margin = radius[piece] + allowed
                a = min(start[piece, axis], end[piece, axis]) - margin - lower[axis]
                b = max(start[piece, axis], end[piece, axis]) + margin - lower[axis]
                low[axis] = max(0, math.floor(a / size))
                high[axis] = min(shape[axis] - 1, math.floor(b / size))
            for i in range(low[0], high[0] + 1):
                x = lower[0] + (i + 0.5) * size
                for j in range(low[1], high[1] + 1):
                    y = lower[1] + (j + 0.5) * size
                    for k in range(low[2], high[2] + 1):
                        z = lower[2] + (k + 0.5) * size
                        away = to_piece(
                            x, y, z, start[piece], end[piece], radius[piece], flat[piece, 0], flat[piece, 1]
                        )
                        if away < allowed:
                            cube = (i * shape[1] + j) * shape[2] + k
                            if turn == 0:
                                first[cube] += 1
                            else:
                                first[cube] -= 1
                                member[first[cube]] = piece
    return first, member


@compiled
def _cube_at(x: float, y: float, z: float, grid: FiberGrid) -> int:
    i = min(max(math.floor((x - grid.lower[0]) / grid.size), 0), grid.shape[0] - 1)
    j = min(max(math.floor((y - grid.lower[1]) / grid.size), 0), grid.shape[1] - 1)
    k = min(max(math.floor((z - grid.lower[2]) / grid.size), 0), grid.shape[2] - 1)
    return int((i * grid.shape[1] + j) * grid.shape[2] + k)


@compiled
def surface_distance(x: float, y: float, z: float, grid: FiberGrid) -> tuple[float, int]:
    """Give the distance to the nearest fiber's surface and its piece.

    Parameters
    ----------
    x, y, z : float [m]
        Places outside the box are seen from its nearest cube.
    grid : FiberGrid

    Returns
    -------
    distance : float [m]
        Negative inside; `reach` where no surface is nearer.
    piece : int
        Of the grid's; -1 where none is near.
    """
    cube = _cube_at(x, y, z, grid)
    best, which = grid.reach, -1
    for entry in range(grid.first[cube], grid.first[cube + 1]):
        p = grid.member[entry]
        found = to_piece(x, y, z, grid.start[p], grid.end[p], grid.radius[p], grid.flat[p, 0], grid.flat[p, 1])
        if found < best:
            best, which = found, p
    return best, which


@compiled
def distances(places: Floats, grid: FiberGrid) -> Floats:
    """Give the distance to the nearest fiber's surface at each place, (n,) array [m], as `surface_distance` does."""
    result = np.empty(len(places))
    for row in range(len(places)):
        result[row], _ = surface_distance(places[row, 0], places[row, 1], places[row, 2], grid)
    return result


@compiled
def touching_fibers(places: Floats, grid: FiberGrid, fiber: Ints, distance: float) -> Ints:
    """Count the fibers whose surface is within a distance of each place, up to 2.

    Parameters
    ----------
    places : (n, 3) array [m]
    grid : FiberGrid
        With a reach beyond the distance.
    fiber : (pieces,) int array
        Fiber of each of the grid's pieces.
    distance : float [m]

    Returns
    -------
    (n,) int array
    """
    count = np.zeros(len(places), np.int64)
    for row in range(len(places)):
        x, y, z = places[row, 0], places[row, 1], places[row, 2]
        cube = _cube_at(x, y, z, grid)
        seen = -1
        for entry in range(grid.first[cube], grid.first[cube + 1]):
            p = grid.member[entry]
            found = to_piece(x, y, z, grid.start[p], grid.end[p], grid.radius[p], grid.flat[p, 0], grid.flat[p, 1])
            if found <= distance and fiber[p] != seen:
                count[row] += 1
                if count[row] == 2:
                    break
                seen = fiber[p]
    return count


@compiled
def met_within(before: float, after: float, variance: float, chance: float) -> bool:
    r"""Whether a particle that started and ended a step outside a wall met it in between.

    Parameters
    ----------
    before, after : float [m]
        Distances from contact at the ends of the step, above 0.
    variance : float [m2]
        Of the step's random part along one axis; 0 without Brownian motion.
    chance : float [-]
        Uniform in 0 to 1.

    Returns
    -------
    bool

    Notes
    -----
    The Brownian bridge between two distances from a plane touches it with probability
    :math:`e^{-2 d_1 d_2/\sigma^2}`, :math:`\sigma^2 = 2 D \Delta t`; without it contact is found late, with an error
    that falls as the square root of the step [1]_. A drift that is constant over the step changes nothing in it.

    References
    ----------
    .. [1] E. A. J. F. Peters and T. M. A. T. M. Barenbrug, Phys. Rev. E 66 (2002) 056701,
       doi:10.1103/PhysRevE.66.056701.
    """
    return variance > 0.0 and chance < math.exp(-2.0 * before * after / variance)
