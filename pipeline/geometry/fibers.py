"""Distance from any place to the nearest fibers, exact and quick: pieces sorted into bins.

Compiled by numba: imported only where a mesh is made.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled, compiled_for_threads
from pipeline.geometry.cylinders import away, distance, table
from pipeline.geometry.threads import in_parts
from pipeline.geometry.triangles import Floats, Ints

Bools = npt.NDArray[np.bool_]
Members = npt.NDArray[np.int32]

# pieces, which of their ends are flat, fiber of each, reach of each; lower corner, width and counts of the bins; first
# member of each bin, members
Field = tuple[Floats, Bools, Ints, Floats, Floats, Floats, Ints, Ints, Members]

FAR = 1e30
"""Distance where every fiber is beyond its reach."""
_MOST_BINS = 4_000_000
_NEWTON = 12  # steps to a surface; three suffice unless two fibers take turns
_STEEPEST = 0.05  # least squared share of the gradient along which a point may move


@compiled
def _members(
    pieces: Floats, flat: Bools, reach: Floats, lower: Floats, width: Floats, counts: Ints
) -> tuple[Ints, Members]:
    """List the pieces within their reach of each bin."""
    half = 0.5 * math.sqrt((width**2).sum())
    total = counts[0] * counts[1] * counts[2]
    first = np.zeros(total + 1, np.int64)
    members = np.empty(0, np.int32)
    following = first[:-1].copy()
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    for filling in range(2):
        last = np.full(total, -1, np.int32)
        for k in range(len(pieces)):
            margin = pieces[k, 7] + reach[k]
            # a long slanted piece would be looked for all over the box around it
            parts = 1 + int(pieces[k, 6] / max(2.0 * margin, 4.0 * width.min()))
            step = pieces[k, 6] / parts
            for part in range(parts):
                inside = True
                for axis in range(3):
                    a = pieces[k, axis] + part * step * pieces[k, 3 + axis]
                    b = a + step * pieces[k, 3 + axis]
                    low[axis] = max(0, math.floor((min(a, b) - margin - lower[axis]) / width[axis]))
                    high[axis] = min(counts[axis] - 1, math.floor((max(a, b) + margin - lower[axis]) / width[axis]))
                    inside &= low[axis] <= high[axis]
                if not inside:
                    continue
                for i in range(low[0], high[0] + 1):
                    x = lower[0] + (i + 0.5) * width[0]
                    for j in range(low[1], high[1] + 1):
                        y = lower[1] + (j + 0.5) * width[1]
                        for m in range(low[2], high[2] + 1):
                            place = (i * counts[1] + j) * counts[2] + m
                            if last[place] == k:
                                continue
                            z = lower[2] + (m + 0.5) * width[2]
                            if distance(x, y, z, pieces, flat, k) <= half + reach[k]:
                                last[place] = k
                                if filling:
                                    members[following[place]] = k
                                    following[place] += 1
                                else:
                                    first[place + 1] += 1
        if not filling:
            first = np.cumsum(first)
            following = first[:-1].copy()
            members = np.empty(first[-1], np.int32)
    return first, members


@compiled
def _bin(x: float, y: float, z: float, field: Field) -> int:
    lower, width, counts = field[4], field[5], field[6]
    i = min(max(int((x - lower[0]) / width[0]), 0), counts[0] - 1)
    j = min(max(int((y - lower[1]) / width[1]), 0), counts[1] - 1)
    m = min(max(int((z - lower[2]) / width[2]), 0), counts[2] - 1)
    return int((i * counts[1] + j) * counts[2] + m)


@compiled
def nearest(x: float, y: float, z: float, field: Field) -> tuple[float, int]:
    """Distance to the nearest piece, and its row; FAR and -1 where every piece is beyond its reach."""
    pieces, flat, first, members = field[0], field[1], field[7], field[8]
    place = _bin(x, y, z, field)
    best, which = FAR, -1
    for n in range(first[place], first[place + 1]):
        found = distance(x, y, z, pieces, flat, members[n])
        if found < best:
            best, which = found, members[n]
    return best, which


@compiled_for_threads
def _at(points: Floats, field: Field, found: Floats, which: Ints, begin: int, end: int) -> None:
    for n in range(begin, end):
        found[n], which[n] = nearest(points[n, 0], points[n, 1], points[n, 2], field)


@compiled_for_threads
def _on_surface(
    points: Floats, free: Floats, most: Floats, field: Field, result: Floats, done: Bools, begin: int, end: int
) -> None:
    """Move points onto the surface along the gradient, or leave them."""
    pieces, flat = field[0], field[1]
    for n in range(begin, end):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        for _ in range(_NEWTON):
            value, k = nearest(x, y, z, field)
            if k < 0:
                break
            tiny = 1e-9 * pieces[k, 7]
            if abs(value) < tiny:
                done[n] = True
                break
            gx, gy, gz = away(x, y, z, pieces, flat, k)
            gx, gy, gz = free[n, 0] * gx, free[n, 1] * gy, free[n, 2] * gz
            size = gx * gx + gy * gy + gz * gz
            # along a plane that the surface hardly crosses a point would run far
            if size < _STEEPEST:
                break
            x, y, z = x - value / size * gx, y - value / size * gy, z - value / size * gz
            far = (x - points[n, 0]) ** 2 + (y - points[n, 1]) ** 2 + (z - points[n, 2]) ** 2
            if far > most[n] ** 2:
                break
        if done[n]:
            result[n, 0], result[n, 1], result[n, 2] = x, y, z


@compiled_for_threads
def _crossings(outside: Floats, inside: Floats, field: Field, result: Floats, begin: int, end: int) -> None:
    pieces = field[0]
    for n in range(begin, end):
        ax, ay, az = outside[n, 0], outside[n, 1], outside[n, 2]
        lx, ly, lz = inside[n, 0] - ax, inside[n, 1] - ay, inside[n, 2] - az
        a, b, share = 0.0, 1.0, 0.5
        fa, _ = nearest(ax, ay, az, field)
        fb, k = nearest(ax + lx, ay + ly, az + lz, field)
        fa = min(fa, 1e3 * math.sqrt(lx * lx + ly * ly + lz * lz))  # a place beyond all reach is no number to divide by
        tiny = 1e-9 * pieces[k, 7]
        for turn in range(60):
            # by the chord, and every fourth time by halves, where the distance bends
            share = 0.5 * (a + b) if turn % 4 == 3 else a + (b - a) * fa / (fa - fb)
            value, _ = nearest(ax + share * lx, ay + share * ly, az + share * lz, field)
            if abs(value) < tiny:
                break
            if value > 0.0:
                a, fa = share, value
            else:
                b, fb = share, value
        result[n, 0], result[n, 1], result[n, 2] = ax + share * lx, ay + share * ly, az + share * lz


@dataclass(frozen=True, eq=False, slots=True)
class FiberDistance:
    """Signed distance to the nearest fiber, negative inside, exact at any place within the fibers' reach.

    Parameters
    ----------
    field : tuple
        What the compiled functions take.
    """

    field: Field

    @classmethod
    def about(
        cls,
        start: Floats,
        end: Floats,
        radius: Floats,
        flat: Bools,
        fiber: Ints,
        reach: Floats,
        lower: Floats,
        upper: Floats,
    ) -> "FiberDistance":
        """Sort the pieces of fibers into the bins of a box.

        Parameters
        ----------
        start, end : (n, 3) arrays
            Of the pieces' axes.
        radius : (n,) array
        flat : (n, 2) bool array
            Whether a piece ends flat at its start and at its end; else it ends in half a ball.
        fiber : (n,) int array
            Fiber that each piece belongs to.
        reach : (n,) array
            Distance from each piece beyond which it does not matter.
        lower, upper : (3,) arrays
            The box; places outside count to the bins at its planes.
        """
        pieces = table(start, end, radius)
        size = upper - lower
        width = max(float(np.median(radius)), float(np.prod(size) / _MOST_BINS) ** (1.0 / 3.0))
        counts = np.maximum(1, np.ceil(size / width)).astype(np.int64)
        widths = size / counts
        first, members = _members(pieces, flat, reach, lower, widths, counts)
        return cls((pieces, flat, fiber.astype(np.int64), reach, lower, widths, counts, first, members))

    def at(self, points: Floats) -> Floats:
        """Distance at each point, (n,) array."""
        return self.with_piece(points)[0]

    def with_piece(self, points: Floats) -> tuple[Floats, Ints]:
        """Distance at each point, (n,) array, and the piece it is the distance to, -1 beyond reach."""
        found, piece = np.empty(len(points)), np.empty(len(points), np.int64)
        in_parts(lambda begin, end: _at(points, self.field, found, piece, begin, end), len(points))
        return found, piece

    def on_surface(self, points: Floats, free: Floats, most: Floats) -> tuple[Floats, Bools]:
        """Move points onto the surface along the gradient of the distance.

        Parameters
        ----------
        points : (n, 3) array
        free : (n, 3) array of 0 and 1
            Along which axes each may move.
        most : (n,) array
            A point that would move farther stays where it is.

        Returns
        -------
        points : (n, 3) array
        done : (n,) bool array
            Which lie on the surface now.
        """
        moved, done = points.copy(), np.zeros(len(points), np.bool_)
        in_parts(lambda begin, end: _on_surface(points, free, most, self.field, moved, done, begin, end), len(points))
        return moved, done

    def crossings(self, outside: Floats, inside: Floats) -> Floats:
        """Where the lines from points outside to points inside a fiber meet its surface, (n, 3) array."""
        found = np.empty_like(outside)
        in_parts(lambda begin, end: _crossings(outside, inside, self.field, found, begin, end), len(outside))
        return found


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
