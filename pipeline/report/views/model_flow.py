"""What moves through a model to turn: streamlines, particles that were caught, and the drag on each fiber."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.analytics.tables.rows import length
from pipeline.line.results import Results
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.capture import Capture
from pipeline.nouns.flow import Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.report.views.drawing import MICRO
from pipeline.report.views.flow_scenes import streamlines_between

MOST_PARTICLES = 4_000
"""Particles of a size that a model holds at most; of more, as many are drawn by lot."""
_MOST_POINTS = 60_000  # of all streamlines
_LOUD = 99.5
_COLORS = ("#4e79a7", "#e8833a", "#3f9e7d", "#c43c39", "#8a6bbe", "#a0741f")


@dataclass(frozen=True, eq=False, slots=True)
class Streamlines:
    """Lines along the velocity.

    Parameters
    ----------
    points : (n, 3) array [m]
    starts : (lines + 1,) int array
        Line k is ``points[starts[k]:starts[k + 1]]``.
    speed : (n,) array [cm/s]
    fastest : float [cm/s]
        Where the colors end.
    """

    points: Floats
    starts: Ints
    speed: Floats
    fastest: float


@dataclass(frozen=True, eq=False, slots=True)
class Particles:
    """Caught particles of one size: how many they were, and the places (n, 3) [m] of those that are drawn."""

    name: str
    places: Floats
    radius: float
    color: str


@dataclass(frozen=True, eq=False, slots=True)
class NumberField:
    """A value for each number of a layer, as for each fiber."""

    name: str
    unit: str
    values: tuple[float, ...]


def streamlines_of(field: FlowField) -> Streamlines:
    """Give streamlines from a grid of points on the inlet."""
    found = streamlines_between(field)
    speed = np.asarray(found.point_data["speed"], np.float64)
    lines = [line for line in _lines(np.asarray(found.lines, np.int64)) if len(line) > 1]
    every = 1 + sum(map(len, lines)) // _MOST_POINTS
    # the end of a line stays, wherever one stops between
    kept = [np.append(line[:-1][::every], line[-1]) for line in lines]
    order = np.concatenate(kept) if kept else np.empty(0, np.int64)
    starts = np.cumsum([0, *map(len, kept)])
    fastest = float(np.percentile(speed[order], _LOUD)) if len(order) else 1.0
    return Streamlines(np.asarray(found.points, np.float64)[order] / MICRO, starts, speed[order], fastest)


def _lines(listed: Ints) -> list[Ints]:
    # VTK lists the number of a line's points before them
    found, place = [], 0
    while place < len(listed):
        count = int(listed[place])
        found.append(listed[place + 1 : place + 1 + count])
        place += 1 + count
    return found


def caught(content: Results) -> tuple[Particles, ...]:
    """Give the particles that a run caught, size by size; none where it did not look for any."""
    import pyvista as pv

    if content.get(Capture) is None:
        return ()
    path = content.path(Capture).parent / "captured.vtp"
    if not path.is_file():
        return ()
    cloud = pv.read(path)
    places, size = np.asarray(cloud.points, np.float64), np.asarray(cloud.point_data["particle_diameter"])
    drawn, found = np.random.default_rng(0), []
    for number, diameter in enumerate(np.unique(size)):
        mine = np.flatnonzero(size == diameter)
        some = mine if len(mine) <= MOST_PARTICLES else drawn.choice(mine, MOST_PARTICLES, replace=False)
        part = "" if len(some) == len(mine) else f"{len(some):,} of "
        name = f"caught particles of {length(float(diameter)).replace('um', 'µm')}: {part}{len(mine):,}"
        found.append(Particles(name, places[some], 0.5 * float(diameter), _COLORS[number % len(_COLORS)]))
    return tuple(found)


def drag(solution: Solution) -> tuple[NumberField, ...]:
    """Give the drag along the flow of each fiber, where the solver told it."""
    if not solution.drag_per_fiber:
        return ()
    return (NumberField("drag", "nN", tuple(1e9 * drag for drag in solution.drag_per_fiber)),)
