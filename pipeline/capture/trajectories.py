"""The way of each particle from the inlet until it touches a fiber, leaves by the outlet, or its time is over."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import NamedTuple

import numpy as np

from pipeline.capture.cells import Cells, near_cell, velocity_in, walked
from pipeline.capture.contact import FiberGrid, met_within, surface_distance
from pipeline.capture.langevin import Motion, moved, step_of
from pipeline.capture.random_numbers import normal_pair, stream, uniform
from pipeline.geometry.compiled import compiled, compiled_for_threads
from pipeline.nouns.arrays import Floats, Ints

PASSED, CAPTURED, TIMED_OUT = 0, 1, 2
"""How a particle ends."""

_DRAWS = 8  # numbers of its stream that a step may use


class Duct(NamedTuple):
    """The planes around the air.

    Parameters
    ----------
    x0, x1, y0, y1 : float [m]
        Sides.
    inlet, outlet : float [m]
        Lowest and highest z.
    wraps : bool
        Whether what leaves through a side enters through the opposite one; else sides are mirrors.
    """

    x0: float
    x1: float
    y0: float
    y1: float
    inlet: float
    outlet: float
    wraps: bool


class Pace(NamedTuple):
    """What sets the length of a step.

    Parameters
    ----------
    way : float [-]
        Most that the air carries a particle, over its distance from contact or the cell's size.
    spread : float [-]
        Most that it diffuses (one standard deviation), over its distance from contact.
    nearest : float [m]
        Distances from contact below this count as this.
    bridged : bool
        Whether contact within a step is looked for; False to show what is lost without it.
    time : float [s]
        After which a particle is given up.
    steps : int
        After which it is given up.
    """

    way: float
    spread: float
    nearest: float
    bridged: bool
    time: float
    steps: int


class Fates(NamedTuple):
    """What became of particles, one row each.

    Parameters
    ----------
    outcome : (n,) int array
        `PASSED`, `CAPTURED` or `TIMED_OUT`.
    piece : (n,) int array
        Piece of the fiber grid that caught it; -1 where none did.
    place : (n, 3) array [m]
        Where its center ended.
    time : (n,) array [s]
    steps : (n,) int array
    """

    outcome: Ints
    piece: Ints
    place: Floats
    time: Floats
    steps: Ints


@compiled
def _folded(x: float, low: float, high: float, wraps: bool) -> tuple[float, float]:
    """Bring a coordinate back between two sides; the sign that its velocity gets."""
    if low <= x <= high:
        return x, 1.0
    if wraps:
        return low + (x - low) % (high - low), 1.0
    period = 2.0 * (high - low)
    along = (x - low) % period
    if along > high - low:
        return low + period - along, -1.0
    return low + along, 1.0


@compiled
def _place(
    x: float, y: float, z: float, cell: int, duct: Duct, cells: Cells
) -> tuple[float, float, float, float, float, int]:
    """Bring a place back into the duct and find its cell; with the signs that velocities get."""
    fx, sx = _folded(x, duct.x0, duct.x1, duct.wraps)
    fy, sy = _folded(y, duct.y0, duct.y1, duct.wraps)
    if duct.wraps and (fx != x or fy != y):
        cell = near_cell(fx, fy, z, cells)
    found, inside = walked(fx, fy, z, cell, cells)
    if not inside:
        # the way there may lead past a fiber
        other, inside = walked(fx, fy, z, near_cell(fx, fy, z, cells), cells)
        if inside:
            found = other
    return fx, fy, z, sx, sy, found


@compiled
def _length_of_step(speed: float, lag: float, gap: float, size: float, motion: Motion, pace: Pace) -> float:
    room = max(gap, pace.nearest)
    way = pace.way * min(room, size)
    dt = pace.time
    if speed > 0.0:
        dt = min(dt, way / speed)
    # its own velocity carries a particle for a relaxation time at most
    if lag * motion.relaxation > way:
        dt = min(dt, way / lag)
    if motion.diffusivity > 0.0:
        spread = (pace.spread * room) ** 2
        dt = min(dt, spread / (2.0 * motion.diffusivity))
    return dt


@compiled
def _one(
    start: Floats, key: np.uint64, motion: Motion, duct: Duct, pace: Pace, cells: Cells, grid: FiberGrid
) -> tuple[int, int, float, float, float, float, int]:
    x, y, z = start[0], start[1], start[2]
    x, y, z, _, _, cell = _place(x, y, z, near_cell(x, y, z, cells), duct, cells)
    gap, piece = surface_distance(x, y, z, grid)
    gap -= motion.contact
    if gap <= 0.0 and piece >= 0:
        return CAPTURED, piece, x, y, z, 0.0, 0
    # behind a mirror the particle goes on in the mirrored mat: seen from here, its weight turns around
    gx, gy, gz = motion.settling_x, motion.settling_y, motion.settling_z
    ax, ay, az = velocity_in(x, y, z, cell, cells)
    ax, ay, az = ax + gx, ay + gy, az + gz
    vx, vy, vz = ax, ay, az
    inert, diffuse = motion.relaxation > 0.0, motion.diffusivity > 0.0
    if inert and diffuse:
        thermal = math.sqrt(motion.diffusivity / motion.relaxation)
        first, second = normal_pair(key, 0)
        third, _ = normal_pair(key, 2)
        vx, vy, vz = vx + thermal * first, vy + thermal * second, vz + thermal * third
    elapsed = 0.0
    for number in range(1, pace.steps + 1):
        lag = math.sqrt((vx - ax) ** 2 + (vy - ay) ** 2 + (vz - az) ** 2) if inert else 0.0
        speed = math.sqrt(ax * ax + ay * ay + az * az)
        dt = _length_of_step(speed, lag, gap, cells.size[cell], motion, pace)
        if elapsed + dt > pace.time:
            return TIMED_OUT, -1, x, y, z, elapsed, number
        step = step_of(dt, motion.relaxation, motion.diffusivity)
        n0, n1, n2, n3, n4, n5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        if diffuse:
            n0, n1 = normal_pair(key, _DRAWS * number)
            n2, n3 = normal_pair(key, _DRAWS * number + 2)
            if inert:
                n4, n5 = normal_pair(key, _DRAWS * number + 4)
        # with the air as it is here, then with the mean of here and there
        bx, by, bz = ax, ay, az
        px, py, pz, wx, wy, wz = x, y, z, vx, vy, vz
        for turn in range(2):
            sx, wx = moved(vx, ax, bx - ax, dt, motion.relaxation, step, n0, n3)
            sy, wy = moved(vy, ay, by - ay, dt, motion.relaxation, step, n1, n4)
            sz, wz = moved(vz, az, bz - az, dt, motion.relaxation, step, n2, n5)
            px, py, pz = x + sx, y + sy, z + sz
            if turn == 0:
                if pz >= duct.outlet:
                    break
                qx, qy, qz, mx, my, cell = _place(px, py, max(pz, duct.inlet), cell, duct, cells)
                bx, by, bz = velocity_in(qx, qy, qz, cell, cells)
                bx, by, bz = mx * bx + gx, my * by + gy, bz + gz
        elapsed += dt
        if pz >= duct.outlet:
            x, y, z, _, _, _ = _place(px, py, duct.outlet, cell, duct, cells)
            return PASSED, -1, x, y, z, elapsed, number
        if pz < duct.inlet:
            # what diffuses upstream comes back with the flow
            pz, wz = 2.0 * duct.inlet - pz, -wz
        x, y, z, mx, my, cell = _place(px, py, pz, cell, duct, cells)
        vx, vy, vz = mx * wx, my * wy, wz
        gx, gy = mx * gx, my * gy
        before, held = gap, piece
        gap, piece = surface_distance(x, y, z, grid)
        gap -= motion.contact
        if gap <= 0.0 and piece >= 0:
            return CAPTURED, piece, x, y, z, elapsed, number
        nearest = piece if piece >= 0 else held
        if diffuse and pace.bridged and nearest >= 0:
            chance = uniform(key, _DRAWS * number + 6)
            if met_within(before, gap, step.position * step.position, chance):
                return CAPTURED, nearest, x, y, z, elapsed, number
        ax, ay, az = velocity_in(x, y, z, cell, cells)
        ax, ay, az = ax + gx, ay + gy, az + gz
    return TIMED_OUT, -1, x, y, z, elapsed, pace.steps


@compiled_for_threads
def _all(
    starts: Floats, first: int, seed: int, size: int, motion: Motion, duct: Duct, pace: Pace, cells: Cells,
    grid: FiberGrid, outcome: Ints, piece: Ints, place: Floats, time: Floats, steps: Ints,
) -> None:  # fmt: skip
    for row in range(len(starts)):
        key = stream(seed, size, first + row)
        end = _one(starts[row], key, motion, duct, pace, cells, grid)
        outcome[row], piece[row], time[row], steps[row] = end[0], end[1], end[5], end[6]
        place[row, 0], place[row, 1], place[row, 2] = end[2], end[3], end[4]


def tracked(
    starts: Floats, first: int, seed: int, size: int, motion: Motion, duct: Duct, pace: Pace, cells: Cells,
    grid: FiberGrid,
) -> Fates:  # fmt: skip
    """Follow particles until each has an end; other threads run meanwhile.

    Parameters
    ----------
    starts : (n, 3) array [m]
    first : int
        Number of the first particle; it names its random numbers, together with `seed` and `size`.
    seed, size : int
        0 or more.
    motion : Motion
    duct : Duct
    pace : Pace
    cells : Cells
    grid : FiberGrid

    Returns
    -------
    Fates
        The same for the same numbers, however the particles are shared out among calls.

    Notes
    -----
    A step is one of Heun's with the exact update of Langevin's equation: of second order in the step for the mean
    motion, exact in its Brownian part.
    """
    count = len(starts)
    fates = Fates(
        np.empty(count, np.int64), np.empty(count, np.int64), np.empty((count, 3)), np.empty(count),
        np.empty(count, np.int64),
    )  # fmt: skip
    _all(np.ascontiguousarray(starts), first, seed, size, motion, duct, pace, cells, grid, *fates)
    return fates
