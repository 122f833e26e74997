"""The fibers laid so far, and how the next one comes to rest on them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Literal, TypeVar

import numpy as np
import numpy.typing as npt

from pipeline.geometry.triangles import Floats, Ints
from pipeline.mat.contact import supports
from pipeline.mat.profile import profile

_Scalar = TypeVar("_Scalar", bound=np.generic)


class Deposit:
    """A growing store of fibers that are straight in plan.

    Arrays are larger than what they hold: `count` fibers, ``first[count]`` nodes.

    Parameters
    ----------
    period : float [m]
        Period of the plan in x and y; 0 for a plan that does not wrap.
    """

    def __init__(self, period: float = 0.0) -> None:
        self.period = period
        self.count = 0
        self.ends: Floats = np.empty((256, 2, 2))
        self.chords: Floats = np.empty((256, 5))
        self.radius: Floats = np.empty(256)
        self.peaks: Floats = np.empty(256)
        self.first: Ints = np.zeros(257, np.int64)
        self.nodes: Floats = np.empty((4096, 2))

    def add(self, ends: Floats, chord: Floats, radius: float, nodes: Floats) -> None:
        """Store one more fiber: its ends in plan, its chord, and places along it with heights."""
        begin = int(self.first[self.count])
        end = begin + len(nodes)
        if self.count == len(self.radius):
            self.ends, self.chords = _doubled(self.ends), _doubled(self.chords)
            self.radius, self.peaks = _doubled(self.radius), _doubled(self.peaks)
            self.first = _doubled(self.first)
        while end > len(self.nodes):
            self.nodes = _doubled(self.nodes)
        self.ends[self.count] = ends
        self.chords[self.count] = chord
        self.radius[self.count] = radius
        self.peaks[self.count] = max(nodes[:, 1].max(), self.peaks[self.count - 1] if self.count else 0.0)
        self.nodes[begin:end] = nodes
        self.count += 1
        self.first[self.count] = end

    def points(self) -> Floats:
        """Nodes of all fibers in space, (n, 3) array [m]; the last of a fiber lies exactly at its end in plan."""
        first = self.first[: self.count + 1]
        nodes = self.nodes[: first[-1]]
        fiber = np.repeat(np.arange(self.count), np.diff(first))
        start, direction = self.ends[fiber, 0], self.chords[fiber, 2:4]
        points = np.column_stack([start + nodes[:, :1] * direction, nodes[:, 1]])
        points[first[1:] - 1, :2] = self.ends[: self.count, 1]
        return points


def as_chord(ends: Floats) -> Floats:
    """Start, unit direction and length of the line between two points in plan.

    Examples
    --------
    >>> as_chord(np.array([[1.0, 2.0], [4.0, 6.0]])).tolist()
    [1.0, 2.0, 0.6, 0.8, 5.0]
    """
    along = ends[1] - ends[0]
    length = float(np.hypot(along[0], along[1]))
    return np.array([ends[0, 0], ends[0, 1], along[0] / length, along[1] / length, length])


def drop(
    deposit: Deposit, chord: Floats, radius: float, slope: float, contact: Literal["paper", "clear"], spacing: float
) -> Floats:
    """Let a straight chord fall onto the deposit and bend over it.

    Parameters
    ----------
    deposit : Deposit
    chord : (5,) array [m, m, -, -, m]
        As `as_chord` gives it.
    radius : float [m]
    slope : float [-]
        Steepest slope of the fiber.
    contact : {"paper", "clear"}
    spacing : float [m]
        Gap between the surfaces of fibers that touch.

    Returns
    -------
    (nodes, 2) array [m]
        Place along the chord and height of each vertex.
    """
    count = deposit.count
    found = supports(
        chord,
        radius,
        deposit.chords[:count],
        deposit.radius[:count],
        deposit.peaks[:count],
        deposit.first[: count + 1],
        deposit.nodes,
        spacing,
        deposit.period,
        slope,
        contact == "clear",
    )
    return profile(found[:, 0].copy(), found[:, 1].copy(), slope, radius, float(chord[4]))


def _doubled(array: npt.NDArray[_Scalar]) -> npt.NDArray[_Scalar]:
    return np.concatenate([array, np.empty_like(array)])
