"""The fibers of a picture: traces that belong together, each with its diameter."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.geometry.parts import parts
from pipeline.micrograph.profile import Floats, Optics, fitted, middle_line, optics_of, profiles
from pipeline.micrograph.ribbons import Image, slopes
from pipeline.micrograph.trace import Trace, traces

_EXPLAINED = 0.985
"""Share of a profile's variance below which it is no cylinder's: two fibers side by side, or a bead's foot."""
_EVEN = 0.3
"""How far a fiber stands out of one side over how far out of the other, at least; rims stand out of one alone."""
_NARROWEST = 4.0
"""Diameter in pixels below which the beam's width is all that is seen, and bright rims look like fibers."""
_LONG = 4.0
"""A fiber is seen over this many of its diameters, or what runs beside it may be its edge."""
_SLENDER = 10.0
"""One fiber at least is seen over this many of its diameters: no blob or wrinkle is."""
_FOR_OPTICS = 10
"""The clearest fibers tell the picture's blur and rims."""
_UNCERTAIN = 0.6
"""Two diameters of one fiber differ by this many pixels in noise."""
_TURN = math.radians(3.0)
_ASIDE = 0.35
_ALIKE = 0.1
"""Two traces are one fiber if they differ by less than this in direction, run on into each other within this share of
their width, and are as wide within this share: in a picture of 60 random fibers less than one pair is so by chance."""


@dataclass(frozen=True, eq=False, slots=True)
class FiberSeen:
    """A fiber of a picture.

    Parameters
    ----------
    lines : tuple of (n, 2) arrays [pixel]
        Middle lines of its parts: column and row.
    diameter : float [pixel]
    seen : float [pixel]
        Length over which both edges are seen.
    angle : float [rad]
        Direction from the picture's x-axis (to the right) toward its y-axis (upward), from 0 up to below pi.
    """

    lines: tuple[Floats, ...]
    diameter: float
    seen: float
    angle: float


@dataclass(frozen=True, eq=False, slots=True)
class Sight:
    """What was seen in a picture: its fibers, and how it shows them."""

    fibers: tuple[FiberSeen, ...]
    optics: Optics
    noise: float


def fibers_of(brightness: Image) -> Sight | None:
    """Find the fibers of a picture and measure their diameters.

    Parameters
    ----------
    brightness : (rows, columns) array [-]
        Fibers are brighter than what lies below them.

    Returns
    -------
    Sight or None
        None where there is no fiber.
    """
    steepness = slopes(brightness)
    found = traces(steepness)
    if not found:
        return None
    taken = profiles(brightness, found)
    clearest = np.argsort([-trace.seen * float(np.median(trace.response)) for trace in found], kind="stable")
    optics = optics_of([taken[k] for k in clearest[:_FOR_OPTICS]])
    kept: list[Trace] = []
    widths: list[float] = []
    for trace, profile in zip(found, taken, strict=True):
        fit = fitted(profile, optics)
        width = 2.0 * fit.half_width
        shaped = fit.explained >= _EXPLAINED and fit.evenness >= _EVEN
        if shaped and width >= _NARROWEST and trace.seen >= _LONG * width:
            kept.append(trace)
            widths.append(width)
    slenderness = np.array([trace.seen for trace in kept]) / np.array(widths)
    if not kept or slenderness.max() < _SLENDER:
        return None
    return Sight(tuple(_linked(kept, np.array(widths))), optics, steepness.noise)


def _linked(found: Sequence[Trace], width: Floats) -> list[FiberSeen]:
    """Put the traces of one fiber together, whose parts other fibers hide from each other."""
    lines = [middle_line(trace) for trace in found]
    ends = np.array([(line[0], line[-1]) for line in lines])
    outward = np.array([(_outward(line[::-1]), _outward(line)) for line in lines])
    pairs = []
    for i in range(len(found)):
        for j in range(i + 1, len(found)):
            if abs(math.log(width[i] / width[j])) > _ALIKE + _UNCERTAIN / min(width[i], width[j]):
                continue
            if any(
                _runs_on(ends[i, a], outward[i, a], ends[j, b], outward[j, b], width[i]) for a in (0, 1) for b in (0, 1)
            ):
                pairs.append((i, j))
    one, other = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    count, fiber = parts(one, other, len(found))
    return [_fiber(np.flatnonzero(fiber == k), found, lines, width) for k in range(count)]


def _outward(line: Floats) -> Floats:
    """Give the direction in which a line leaves its last point."""
    along: Floats = line[-1] - line[-min(len(line), 30)]
    return along / max(float(np.linalg.norm(along)), 1e-9)


def _runs_on(end: Floats, way: Floats, other: Floats, other_way: Floats, width: float) -> bool:
    if float(way @ other_way) > -math.cos(_TURN):
        return False
    gap = other - end
    along = float(gap @ way)
    aside = abs(float(gap[0] * way[1] - gap[1] * way[0]))
    return -2.0 * width <= along <= 30.0 * width and aside <= _ASIDE * width + 0.01 * max(along, 0.0)


def _fiber(parts: npt.NDArray[np.int64], found: Sequence[Trace], lines: Sequence[Floats], width: Floats) -> FiberSeen:
    seen = np.array([found[k].seen for k in parts])
    # directions are told apart modulo half a turn: doubled, they add as vectors
    doubled = 0.0j
    for k in parts:
        step = np.diff(lines[k], axis=0)
        vector = step[:, 0] - 1j * step[:, 1]
        doubled += complex((vector**2 / np.maximum(np.abs(vector), 1e-9)).sum())
    return FiberSeen(
        tuple(lines[k] for k in parts),
        float(np.average(width[parts], weights=seen)),
        float(seen.sum()),
        float(0.5 * np.angle(doubled) % math.pi),
    )
