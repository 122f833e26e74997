"""Fibers followed along their ribbons, from the clearest one down, across what hides them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.micrograph.ribbons import DIRECTIONS, Image, Slopes

_THINNEST = 1.25
"""Smallest half width that is looked for, in pixels."""
_WIDTHS_RATIO = 1.12
_STEP = 2.0
"""Distance between the points of a trace, in pixels."""
_CLEAR = 6.0
"""A trace starts where both edges stand out of the noise by this many standard deviations: a picture of a million
pixels, 36 directions and 30 widths holds no such pair by chance."""
_FAINT = 3.5
"""And goes on down to this many."""
_STRIDE = 2
"""Starts are looked for on every second pixel of every second row: a ribbon is wider."""
_LONG_ENOUGH = 3.0
"""A fiber is seen over a length of this many of its widths; a bead is not."""
_SHORTEST = 16.0
"""And over this many pixels."""
_SEEN_SHARE = 0.35
"""And is seen over this share of its way."""
_STEADY = 0.12
"""And half of its widths lie within this share of their median."""
_BESIDE, _BESIDE_FIBER = 3, 7
"""Directions on each side, of 5 degrees each, that a trace claims where it lies, and that a fiber does: on a wide fiber
there is room for short ribbons askew."""


@dataclass(frozen=True, eq=False, slots=True)
class Trace:
    """A ribbon's middle line, point after point.

    Parameters
    ----------
    points : (n, 2) array [pixel]
        Column and row; pixel centers have whole numbers.
    half_width : (n,) array [pixel]
    clear : (n,) bool array
        Whether both edges are seen there; else the ribbon is hidden, or crossed.
    response : (n,) array [1/pixel]
        The weaker edge's slope.
    """

    points: npt.NDArray[np.float64]
    half_width: npt.NDArray[np.float64]
    clear: npt.NDArray[np.bool_]
    response: npt.NDArray[np.float64]

    @property
    def seen(self) -> float:
        """Length over which both edges are seen [pixel]."""
        return _STEP * float(self.clear.sum())

    @property
    def is_fiber(self) -> bool:
        """Whether the ribbon is long for its width, seen for most of its way, and of one width."""
        half = self.half_width[self.clear]
        middle = float(np.median(half))
        return (
            self.seen >= max(_LONG_ENOUGH * 2.0 * middle, _SHORTEST)
            and float(self.clear.mean()) >= _SEEN_SHARE
            and float(np.median(np.abs(half - middle))) <= _STEADY * middle
        )


def half_widths(shape: tuple[int, int]) -> npt.NDArray[np.float64]:
    """Half widths that are looked for [pixel], up to an eighth of the picture's shorter side."""
    widest = max(min(shape) / 8.0, 2 * _THINNEST)
    count = int(math.log(widest / _THINNEST) / math.log(_WIDTHS_RATIO)) + 1
    widths: npt.NDArray[np.float64] = _THINNEST * _WIDTHS_RATIO ** np.arange(count, dtype=np.float64)
    return widths


def traces(slopes: Slopes) -> list[Trace]:
    """Follow every ribbon of a picture.

    Parameters
    ----------
    slopes : Slopes

    Returns
    -------
    list of Trace
        The clearest first.
    """
    rows, columns = slopes.across.shape[1:]
    widths = half_widths((rows, columns))
    response, direction, width = _best_ribbons(slopes.across, widths, _CLEAR * slopes.noise, _STRIDE)
    starts = np.argsort(-response, axis=None, kind="stable")
    starts = starts[: int((response > 0).sum())]
    where = np.column_stack(np.unravel_index(starts, response.shape))
    taken = np.zeros((rows, columns), np.int64)
    found = []
    for row, column in where:
        k = direction[row, column]
        y, x = _STRIDE * row, _STRIDE * column
        if (taken[y, x] >> k) & 1:
            continue
        trace = _follow_both(
            slopes.across, taken, x, y, k, widths[width[row, column]], response[row, column], _FAINT * slopes.noise
        )
        if trace.is_fiber:
            found.append(trace)
        _take(taken, trace.points, trace.half_width, trace.clear, _BESIDE_FIBER if trace.is_fiber else _BESIDE)
    return found


def _follow_both(
    across: Image,
    taken: npt.NDArray[np.int64],
    x: float,
    y: float,
    k: int,
    half: float,
    response: float,
    least: float,
) -> Trace:
    angle = k * math.pi / DIRECTIONS
    one = _follow(across, taken, float(x), float(y), angle, float(half), float(response), least)
    other = _follow(across, taken, float(x), float(y), angle + math.pi, float(half), float(response), least)
    # the start stands once
    whole = np.concatenate([other[:0:-1], one])
    return Trace(whole[:, :2].copy(), whole[:, 2].copy(), whole[:, 3] > 0, whole[:, 3].copy())


@compiled
def _sample(across: Image, k: int, x: float, y: float) -> float:
    rows, columns = across.shape[1], across.shape[2]
    if x < 0.0 or y < 0.0 or x > columns - 1.001 or y > rows - 1.001:
        return 0.0
    c, r = int(x), int(y)
    u, v = x - c, y - r
    upper = across[k, r, c] + u * (across[k, r, c + 1] - across[k, r, c])
    lower = across[k, r + 1, c] + u * (across[k, r + 1, c + 1] - across[k, r + 1, c])
    return float(upper + v * (lower - upper))


@compiled
def _is_filled(across: Image, k: int, x: float, y: float, nx: float, ny: float, half: float) -> bool:
    """Tell whether the middle stands out by a quarter of what the rims do: else two fibers lie side by side."""
    beyond = 2.5
    count = int(2 * (half + beyond)) + 1
    level, left, right = 0.0, 0.0, 0.0
    lowest, highest_left, highest_right = 1e30, 0.0, 0.0
    for i in range(count + 1):
        place = -half - beyond + i
        level += _sample(across, k, x + place * nx, y + place * ny)
        if place < 0.0:
            highest_left = max(highest_left, level)
        if -0.5 * half <= place <= 0.5 * half:
            lowest = min(lowest, level)
    right = level
    level = 0.0
    for i in range(count + 1):
        place = -half - beyond + i
        level += _sample(across, k, x + place * nx, y + place * ny)
        if place >= 0.0:
            highest_right = max(highest_right, level)
    return lowest >= left + 0.25 * (highest_left - left) and lowest >= right + 0.25 * (highest_right - right)


@compiled
def _best_ribbons(
    across: Image, widths: npt.NDArray[np.float64], least: float, stride: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Give the strongest ribbon through each of a grid of pixels: its weaker edge, direction and width."""
    directions, rows, columns = across.shape
    shape = ((rows + stride - 1) // stride, (columns + stride - 1) // stride)
    response = np.zeros(shape)
    direction = np.zeros(shape, np.int64)
    width = np.zeros(shape, np.int64)
    for k in range(directions):
        angle = k * np.pi / directions
        nx, ny = -np.sin(angle), np.cos(angle)
        for i in range(shape[0]):
            for j in range(shape[1]):
                x, y = float(j * stride), float(i * stride)
                best = max(response[i, j], least)
                for w in range(len(widths)):
                    half = widths[w]
                    c, r = int(x - half * nx + 0.5), int(y - half * ny + 0.5)
                    if c < 0 or r < 0 or c >= columns or r >= rows or across[k, r, c] <= best:
                        continue
                    c, r = int(x + half * nx + 0.5), int(y + half * ny + 0.5)
                    if c < 0 or r < 0 or c >= columns or r >= rows or -across[k, r, c] <= best:
                        continue
                    weaker = min(
                        _sample(across, k, x - half * nx, y - half * ny),
                        -_sample(across, k, x + half * nx, y + half * ny),
                    )
                    if weaker > best and _is_filled(across, k, x, y, nx, ny, half):
                        best = weaker
                        response[i, j] = weaker
                        direction[i, j] = k
                        width[i, j] = w
    return response, direction, width


@compiled
def _follow(
    across: Image,
    taken: npt.NDArray[np.int64],
    x: float,
    y: float,
    angle: float,
    half: float,
    response: float,
    least: float,
) -> npt.NDArray[np.float64]:
    """Follow a ribbon one way: rows of (column, row, half width, response or 0 where hidden), the start first."""
    directions, rows, columns = across.shape
    step, memory = 2.0, 12
    longest_gap = max(8.0 * half, 40.0)
    capacity = 2 * (rows + columns)
    path = np.zeros((capacity, 4))
    path[0] = (x, y, half, response)
    count, gap = 1, 0.0
    usual = response
    while count < capacity:
        x += step * np.cos(angle)
        y += step * np.sin(angle)
        if x < 0 or y < 0 or x > columns - 1 or y > rows - 1:
            break
        best, best_half = 0.0, half
        middle = int(np.floor(angle / np.pi * directions + 0.5))
        for turn in range(-1, 2):
            k = (middle + turn) % directions
            # of a direction seen the other way round, left and right are swapped: both edges are looked at alike
            theta = k * np.pi / directions
            nx, ny = -np.sin(theta), np.cos(theta)
            for i in range(-3, 4):
                px, py = x + 0.5 * i * nx, y + 0.5 * i * ny
                for j in range(-3, 4):
                    h = half * (1.0 + 0.05 * j)
                    weaker = min(
                        _sample(across, k, px - h * nx, py - h * ny), -_sample(across, k, px + h * nx, py + h * ny)
                    )
                    if weaker > best:
                        best, best_half = weaker, h
                        bx, by, bk = px, py, k
        seen = best > max(least, 0.3 * usual)
        if seen:
            nx, ny = -np.sin(bk * np.pi / directions), np.cos(bk * np.pi / directions)
            seen = (taken[int(by + 0.5), int(bx + 0.5)] >> bk) & 1 == 0 if _inside(bx, by, rows, columns) else False
            seen = seen and _is_filled(across, bk, bx, by, nx, ny, best_half)
        if seen:
            x, y = bx, by
            half += 0.2 * (best_half - half)
            usual += 0.1 * (best - usual)
            gap = 0.0
        else:
            gap += step
            if gap > longest_gap:
                break
        path[count] = (x, y, best_half if seen else half, best if seen else 0.0)
        count += 1
        if seen:
            # the direction is that from where the ribbon was seen some steps ago
            back = count - 1
            steps_back = 0
            while back > 0 and steps_back < memory:
                back -= 1
                steps_back += 1
            while back < count - 1 and path[back, 3] == 0.0:
                back += 1
            if count - 1 - back >= 4:
                toward = np.arctan2(y - path[back, 1], x - path[back, 0])
                turn_by = (toward - angle + np.pi) % (2 * np.pi) - np.pi
                angle += 0.5 * turn_by
    while count > 1 and path[count - 1, 3] == 0.0:
        count -= 1
    return path[:count].copy()


@compiled
def _inside(x: float, y: float, rows: int, columns: int) -> bool:
    return 0 <= int(x + 0.5) < columns and 0 <= int(y + 0.5) < rows


@compiled
def _take(
    taken: npt.NDArray[np.int64],
    points: npt.NDArray[np.float64],
    half_width: npt.NDArray[np.float64],
    clear: npt.NDArray[np.bool_],
    beside: int,
) -> None:
    """Claim the directions beside a trace's own, over its width, so that nothing is followed twice."""
    rows, columns = taken.shape
    count = len(points)
    for i in range(count):
        before, after = max(i - 2, 0), min(i + 2, count - 1)
        along_x, along_y = points[after, 0] - points[before, 0], points[after, 1] - points[before, 1]
        size = np.hypot(along_x, along_y)
        if size == 0.0:
            continue
        along_x, along_y = along_x / size, along_y / size
        middle = int(np.floor(np.arctan2(along_y, along_x) / np.pi * 36 + 0.5))
        bits = 0
        # what hides a fiber is another one's place
        claimed = beside if clear[i] else 2
        for turn in range(-claimed, claimed + 1):
            bits |= 1 << ((middle + turn) % 36)
        reach = half_width[i] + 1.5
        across = -reach
        while across <= reach:
            for forward in (-1.0, -0.5, 0.0, 0.5, 1.0):
                x = points[i, 0] - across * along_y + forward * along_x
                y = points[i, 1] + across * along_x + forward * along_y
                if _inside(x, y, rows, columns):
                    taken[int(y + 0.5), int(x + 0.5)] |= bits
            across += 0.5
