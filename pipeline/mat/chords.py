"""Where fibers lie in plan: straight chords of the square, or pieces of a plan that wraps."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.geometry.triangles import Floats
from pipeline.mat.settings import Aligned, DrawnSettings, Isotropic, MachineDirection, Perimeter, VonMises


def draw_chords(settings: DrawnSettings, diameters: Floats, rng: np.random.Generator) -> Floats:
    """Draw the two ends of each fiber in plan.

    Parameters
    ----------
    settings : DrawnSettings
    diameters : (count,) array [m]
        A broken fiber is no shorter than its diameter, unless its chord is.
    rng : numpy.random.Generator

    Returns
    -------
    (count, 2, 2) array [m]
        Start and end, each with x and y. An end on a side of the plan has that coordinate exactly 0 or `side`;
        in a periodic plan the middle lies in the plan and the ends may lie beyond it.
    """
    law, count = settings.law, len(diameters)
    if settings.periodic:
        return _wrapped(settings, draw_angles(law, count, rng), rng)
    chords = _perimeter(count, rng) if isinstance(law, Perimeter) else _through(law, count, rng)
    return _broken(settings.side * chords, settings.broken, diameters, rng)


def draw_angles(
    law: Perimeter | Isotropic | Aligned | VonMises | MachineDirection, count: int, rng: np.random.Generator
) -> Floats:
    """Draw directions in the plan, each as likely as the length of fiber that is to point that way.

    Parameters
    ----------
    law : settings of the orientation, other than `Perimeter`
    count : int
    rng : numpy.random.Generator

    Returns
    -------
    (count,) array [rad]
        From x toward y.

    Raises
    ------
    ValueError
        For `Perimeter`, whose directions follow from its chords.
    """
    match law:
        case Isotropic():
            return math.pi * rng.random(count)
        case Aligned():
            return np.full(count, math.radians(law.axis))
        case VonMises():
            # fibers have no head: the doubled angle goes round once in half a turn
            return math.radians(law.axis) + 0.5 * rng.vonmises(0.0, law.concentration, count)
        case MachineDirection():
            # stretching by k gives the densities k along and 1/k across: their ratio is k^2
            stretch = math.sqrt(law.ratio)
            turn = 2.0 * math.pi * rng.random(count)
            return math.radians(law.axis) + np.arctan2(np.sin(turn), stretch * np.cos(turn))
    raise ValueError("the directions of perimeter chords follow from their ends")


def _perimeter(count: int, rng: np.random.Generator) -> Floats:
    """Chords of the unit square from a point of the perimeter to one on another edge, both walked clockwise."""
    u, v = 4.0 * rng.random(count), 3.0 * rng.random(count)
    start_edge, skipped = np.floor(u).astype(int), np.floor(v).astype(int)
    return np.stack(
        [_on_edge(start_edge, u - start_edge), _on_edge((start_edge + 1 + skipped) % 4, v - skipped)], axis=1
    )


def _on_edge(edge: np.ndarray, along: Floats) -> Floats:
    # clockwise from the corner (0, 0): up the left edge, along the top, down the right edge, back along the bottom
    zero, one = np.zeros_like(along), np.ones_like(along)
    x = np.choose(edge, [zero, along, one, 1.0 - along])
    y = np.choose(edge, [along, one, 1.0 - along, zero])
    return np.stack([x, y], axis=1)


def _through(law: Isotropic | Aligned | VonMises | MachineDirection, count: int, rng: np.random.Generator) -> Floats:
    """Chords of the unit square that cover it evenly, with a length of fiber per direction that follows the law.

    The number of chords per direction must grow with the width that the square shows to them, |sin| + |cos|,
    since their mean length falls with it; their offsets are uniform over that width.
    """
    angles = np.empty(count)
    missing = np.arange(count)
    while len(missing):
        angles[missing] = draw_angles(law, len(missing), rng)
        width = np.abs(np.sin(angles[missing])) + np.abs(np.cos(angles[missing]))
        missing = missing[math.sqrt(2) * rng.random(len(missing)) > width]
    direction = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    offset = (rng.random(count) - 0.5) * np.abs(normal).sum(axis=1)
    foot = 0.5 + offset[:, None] * normal
    return _clipped(foot, direction)


def _clipped(foot: Floats, direction: Floats) -> Floats:
    """Parts of the lines through `foot` within the unit square, their ends exactly on its edges."""
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = -foot / direction, (1.0 - foot) / direction
    # a line parallel to an edge never meets it
    enter = np.where(direction == 0, -np.inf, np.minimum(low, high))
    leave = np.where(direction == 0, np.inf, np.maximum(low, high))
    rows = np.arange(len(foot))
    ends = []
    for times, pick, sign in ((enter, np.argmax, -1.0), (leave, np.argmin, 1.0)):
        axis = pick(times, axis=1)
        point = np.clip(foot + times[rows, axis][:, None] * direction, 0.0, 1.0)
        point[rows, axis] = np.where(sign * direction[rows, axis] > 0, 1.0, 0.0)
        ends.append(point)
    return np.stack(ends, axis=1)


def _wrapped(settings: DrawnSettings, angles: Floats, rng: np.random.Generator) -> Floats:
    middle = settings.side * rng.random((len(angles), 2))
    half = 0.5 * settings.wrapped_length * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return np.stack([middle - half, middle + half], axis=1)


def _broken(chords: Floats, share: float, shortest: Floats, rng: np.random.Generator) -> Floats:
    """Cut a share of the chords short: they keep their start and a uniform part of their length."""
    if share == 0.0:
        return chords
    is_broken = rng.random(len(chords)) < share
    along = chords[:, 1] - chords[:, 0]
    part = np.maximum(1.0 - rng.random(len(chords)), shortest / np.hypot(along[:, 0], along[:, 1]))
    is_broken &= part < 1.0
    chords[is_broken, 1] = (chords[:, 0] + part[:, None] * along)[is_broken]
    return chords
