"""Distance from points to fibers: cylinders about straight pieces, round at bends, flat or round at their ends.

Compiled by numba: imported only where a mesh is made.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats


@compiled
def to_piece(
    x: float, y: float, z: float, start: Floats, end: Floats, radius: float, flat0: bool, flat1: bool
) -> float:
    """Give the signed distance from a place to a piece's surface, negative inside; a flat end cuts the cylinder."""
    ux, uy, uz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    length = math.sqrt(ux * ux + uy * uy + uz * uz)
    ux, uy, uz = ux / length, uy / length, uz / length
    px, py, pz = x - start[0], y - start[1], z - start[2]
    along = px * ux + py * uy + pz * uz
    over = 0.0
    if along < 0.0:
        if flat0:
            over = -along
        else:
            return math.sqrt(px * px + py * py + pz * pz) - radius
    elif along > length:
        if flat1:
            over = along - length
        else:
            px, py, pz = x - end[0], y - end[1], z - end[2]
            return math.sqrt(px * px + py * py + pz * pz) - radius
    px, py, pz = px - along * ux, py - along * uy, pz - along * uz
    aside = math.sqrt(px * px + py * py + pz * pz) - radius
    if over > 0.0:
        return math.sqrt(max(aside, 0.0) ** 2 + over * over)
    if flat0:
        aside = max(aside, -along)
    if flat1:
        aside = max(aside, along - length)
    return aside


@compiled
def _lattice_distance(
    start: Floats,
    end: Floats,
    radius: Floats,
    flat: npt.NDArray[np.bool_],
    origin: Floats,
    step: Floats,
    shape: tuple[int, int, int],
    reach: float,
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]:
    """Distance from every lattice point to the nearest piece, and which one that is; -1 where all are beyond reach."""
    distance = np.full(shape, np.float32(reach))
    nearest = np.full(shape, np.int32(-1))
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    for piece in range(len(start)):
        for axis in range(3):
            margin = radius[piece] + reach
            a = min(start[piece, axis], end[piece, axis]) - margin
            b = max(start[piece, axis], end[piece, axis]) + margin
            low[axis] = max(0, math.ceil((a - origin[axis]) / step[axis]))
            high[axis] = min(shape[axis] - 1, math.floor((b - origin[axis]) / step[axis]))
        for i in range(low[0], high[0] + 1):
            x = origin[0] + i * step[0]
            for j in range(low[1], high[1] + 1):
                y = origin[1] + j * step[1]
                for k in range(low[2], high[2] + 1):
                    z = origin[2] + k * step[2]
                    found = to_piece(x, y, z, start[piece], end[piece], radius[piece], flat[piece, 0], flat[piece, 1])
                    if found < distance[i, j, k]:
                        distance[i, j, k] = found
                        nearest[i, j, k] = piece
    return distance, nearest


# start, end, radius and flat of the pieces; origin and step of the lattice; nearest piece of each of its points; reach
_Field = tuple[Floats, Floats, Floats, npt.NDArray[np.bool_], Floats, Floats, npt.NDArray[np.int32], float]


@compiled
def _place(x: float, y: float, z: float, field: _Field) -> tuple[float, int]:
    """Distance at any place and the piece it is the distance to, among those nearest at the lattice points around."""
    start, end, radius, flat, origin, step, nearest, reach = field
    ci = round((x - origin[0]) / step[0])
    cj = round((y - origin[1]) / step[1])
    ck = round((z - origin[2]) / step[2])
    best, which, last = reach, -1, -1
    for i in range(max(0, ci - 1), min(nearest.shape[0], ci + 2)):
        for j in range(max(0, cj - 1), min(nearest.shape[1], cj + 2)):
            for k in range(max(0, ck - 1), min(nearest.shape[2], ck + 2)):
                piece = nearest[i, j, k]
                if piece < 0 or piece == last:
                    continue
                last = piece
                found = to_piece(x, y, z, start[piece], end[piece], radius[piece], flat[piece, 0], flat[piece, 1])
                if found < best:
                    best, which = found, piece
    return best, which


@compiled
def _local(x: float, y: float, z: float, field: _Field) -> float:
    return _place(x, y, z, field)[0]


@compiled
def _places(points: Floats, field: _Field) -> tuple[Floats, npt.NDArray[np.int64]]:
    distance, which = np.empty(len(points)), np.empty(len(points), np.int64)
    for n in range(len(points)):
        distance[n], which[n] = _place(points[n, 0], points[n, 1], points[n, 2], field)
    return distance, which


@compiled
def _snapped(points: Floats, free: Floats, leash: float, field: _Field) -> tuple[Floats, npt.NDArray[np.bool_]]:
    result = points.copy()
    done = np.zeros(len(points), np.bool_)
    tiny = 1e-4 * field[5].min()
    gradient = np.empty(3)
    for n in range(len(points)):
        p = points[n].copy()
        for _ in range(8):
            value = _local(p[0], p[1], p[2], field)
            if abs(value) < 1e-3 * tiny:
                break
            for axis in range(3):
                q = p.copy()
                q[axis] += tiny
                up = _local(q[0], q[1], q[2], field)
                q[axis] -= 2 * tiny
                gradient[axis] = free[n, axis] * (up - _local(q[0], q[1], q[2], field)) / (2 * tiny)
            size = (gradient**2).sum()
            # along a plane that the surface hardly crosses a point would run far
            if size < 0.05:
                break
            p -= value / size * gradient
        if abs(_local(p[0], p[1], p[2], field)) < tiny and ((p - points[n]) ** 2).sum() <= leash**2:
            result[n] = p
            done[n] = True
    return result, done


@compiled
def _crossings(outside: Floats, inside: Floats, field: _Field) -> Floats:
    result = np.empty_like(outside)
    tiny = 1e-7 * field[5].min()
    for n in range(len(outside)):
        line = inside[n] - outside[n]
        a, b, share = 0.0, 1.0, 0.5
        fa = _local(outside[n, 0], outside[n, 1], outside[n, 2], field)
        fb = _local(inside[n, 0], inside[n, 1], inside[n, 2], field)
        for turn in range(60):
            # by the chord, and every fourth time by halves, where the distance bends
            share = 0.5 * (a + b) if turn % 4 == 3 else a + (b - a) * fa / (fa - fb)
            p = outside[n] + share * line
            value = _local(p[0], p[1], p[2], field)
            if abs(value) < tiny:
                break
            if value > 0.0:
                a, fa = share, value
            else:
                b, fb = share, value
        result[n] = outside[n] + share * line
    return result


@dataclass(frozen=True, eq=False, slots=True)
class FiberDistance:
    """Signed distance to the nearest fiber, negative inside, quick at any place in a box.

    `Nearest` means nearest at one of the 27 lattice points around a place: exact as long as the lattice is finer than
    the fibers.

    Parameters
    ----------
    field : tuple
        What the compiled functions take.
    on_lattice : float32 array
        The distance at every lattice point.
    source : (pieces,) int array
        Which of the pieces given each of the field's pieces is a part of.
    """

    field: _Field
    on_lattice: npt.NDArray[np.float32]
    source: npt.NDArray[np.int64]

    @classmethod
    def about(
        cls,
        start: Floats,
        end: Floats,
        radius: Floats,
        flat: npt.NDArray[np.bool_],
        lower: Floats,
        upper: Floats,
        counts: tuple[int, int, int],
        reach: float,
    ) -> "FiberDistance":
        """Measure the distance on a lattice in a box.

        Parameters
        ----------
        start, end : (n, 3) arrays
            Of the pieces' axes.
        radius : (n,) array
        flat : (n, 2) bool array
            Whether a piece ends flat at its start and at its end; else it ends in half a ball.
        lower, upper : (3,) arrays
            The box.
        counts : tuple of int
            Intervals of the lattice along each axis.
        reach : float
            Distances beyond it are not told apart.
        """
        start, end, radius, flat, source = short_pieces(start, end, radius, flat)
        step = (upper - lower) / np.array(counts)
        shape = (counts[0] + 1, counts[1] + 1, counts[2] + 1)
        distance, nearest = _lattice_distance(start, end, radius, flat, lower, step, shape, reach)
        return cls((start, end, radius, flat, lower, step, nearest, reach), distance, source)

    def thicker(self, by: float) -> "FiberDistance":
        """Give the distance to fibers of larger radius; `on_lattice` stays that of the old ones."""
        start, end, radius, flat, lower, step, nearest, reach = self.field
        return FiberDistance((start, end, radius + by, flat, lower, step, nearest, reach), self.on_lattice, self.source)

    def at(self, points: Floats) -> Floats:
        """Distance at each point, (n,) array."""
        return self.with_piece(points)[0]

    def with_piece(self, points: Floats) -> tuple[Floats, npt.NDArray[np.int64]]:
        """Distance at each point, (n,) array, and the field's piece it is the distance to, -1 beyond reach."""
        found, piece = _places(points, self.field)
        return found, piece

    def snapped(self, points: Floats, free: Floats, leash: float) -> tuple[Floats, npt.NDArray[np.bool_]]:
        """Move points onto the surface along the gradient of the distance.

        Parameters
        ----------
        points : (n, 3) array
        free : (n, 3) array of 0 and 1
            Along which axes each may move.
        leash : float
            A point that would move farther stays where it is.

        Returns
        -------
        points : (n, 3) array
        done : (n,) bool array
            Which lie on the surface now.
        """
        moved, done = _snapped(points, free, leash, self.field)
        return moved, done

    def crossings(self, outside: Floats, inside: Floats) -> Floats:
        """Where the lines from points outside to points inside a fiber meet its surface, (n, 3) array."""
        found: Floats = _crossings(outside, inside, self.field)
        return found


_LENGTH = 4.0  # of a short piece in radii: a long one would be looked for all over the box around it


def short_pieces(
    start: Floats, end: Floats, radius: Floats, flat: npt.NDArray[np.bool_]
) -> tuple[Floats, Floats, Floats, npt.NDArray[np.bool_], npt.NDArray[np.int64]]:
    """Cut pieces into ones no longer than four radii, which a grid finds quickly.

    Returns
    -------
    start, end, radius, flat : arrays
        Of the short pieces.
    source : (n,) int array
        The piece that each is a part of.
    """
    parts = np.maximum(1, np.ceil(np.linalg.norm(end - start, axis=1) / (_LENGTH * radius))).astype(np.int64)
    piece = np.repeat(np.arange(len(start)), parts)
    number = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    line = (end - start)[piece]
    one, two = (start[piece] + (share / parts[piece])[:, None] * line for share in (number, number + 1))
    ends = np.stack([flat[piece, 0] & (number == 0), flat[piece, 1] & (number == parts[piece] - 1)], axis=1)
    return one, two, radius[piece], ends, piece
