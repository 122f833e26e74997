"""The fibers: a mat of center lines, and the straight pieces that a surface stands for."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.geometry.box import Box
from pipeline.nouns.arrays import Floats, Ints, freeze, require

ON_SIDE = 1e-6
"""Distance from a side of the plan, in radii, within which a point of an axis lies on it: coordinates are rounded."""


@dataclass(frozen=True, eq=False, slots=True)
class Mat:
    """A fiber mat: one polyline per fiber, in a slab that the flow crosses along +z.

    Parameters
    ----------
    nodes : (n, 3) array [m]
        Center lines, fiber after fiber. In a periodic mat they may leave the slab sideways: what leaves
        through one side enters through the opposite one.
    first : (fibers + 1,) int array
        Fiber k owns ``nodes[first[k]:first[k + 1]]``, at least two of them.
    radius : (fibers,) array [m]
        Above 0.
    slab : Box [m]
        The mat's own space: its plan, and z from 0 to its thickness.
    seed : int
        Seed of the generator that drew the mat; -1 for fibers that nobody drew.
    origin : str
        How the mat was made, for people to read.
    periodic : bool
        Whether the plan wraps in x and y.
    """

    nodes: Floats
    first: Ints
    radius: Floats
    slab: Box
    seed: int
    origin: str
    periodic: bool = False

    def __post_init__(self) -> None:
        freeze(
            self,
            nodes=np.asarray(self.nodes, np.float64),
            first=np.asarray(self.first, np.int64),
            radius=np.asarray(self.radius, np.float64),
        )
        fibers = len(self.radius)
        require(fibers > 0, "a mat has at least one fiber")
        require(self.nodes.ndim == 2 and self.nodes.shape[1] == 3, "nodes have three coordinates")
        require(self.first.shape == (fibers + 1,), f"{fibers} radii, but {len(self.first) - 1} center lines")
        require(self.first[0] == 0 and self.first[-1] == len(self.nodes), "first does not span the nodes")
        require(bool((np.diff(self.first) >= 2).all()), "a center line has fewer than two nodes")
        require(bool(np.isfinite(self.nodes).all()), "a node is not finite")
        require(bool(((self.radius > 0) & np.isfinite(self.radius)).all()), "a radius is not above 0")
        short = int((self.segment_lengths() <= 0).sum())
        require(short == 0, f"{short} segments have no length")

    @property
    def fibers(self) -> int:
        """Number of fibers."""
        return len(self.radius)

    @property
    def segments(self) -> int:
        """Number of straight pieces of all fibers."""
        return len(self.nodes) - self.fibers

    @property
    def thickness(self) -> float:
        """Extent of the slab along the flow [m]."""
        return self.slab.size[2]

    def segment_starts(self) -> Ints:
        """Node at which each segment starts; it ends at the next node, (segments,) int array."""
        is_start = np.ones(len(self.nodes), dtype=bool)
        is_start[self.first[1:] - 1] = False
        return np.flatnonzero(is_start)

    def segment_fibers(self) -> Ints:
        """Fiber that each segment belongs to, (segments,) int array."""
        return np.repeat(np.arange(self.fibers), np.diff(self.first) - 1)

    def segment_lengths(self) -> Floats:
        """Length of each segment, (segments,) array [m]."""
        start = self.segment_starts()
        lengths: Floats = np.linalg.norm(self.nodes[start + 1] - self.nodes[start], axis=1)
        return lengths

    def share_inside(self) -> Floats:
        """Share of each segment's cylinder that lies within the plan, (segments,) array [-].

        1, or half for each side of the plan in which its axis runs: a symmetry plane there halves the fiber. Whoever
        adds up volumes, areas or lengths of fibers adds up these shares.
        """
        share = np.ones(self.segments)
        if self.periodic:
            return share
        start = self.segment_starts()
        near = ON_SIDE * self.radius[self.segment_fibers()]
        for axis in (0, 1):
            for side in (self.slab.lower[axis], self.slab.upper[axis]):
                off = np.abs(self.nodes[:, axis] - side)
                share[(off[start] <= near) & (off[start + 1] <= near)] *= 0.5
        return share

    def inside_lengths(self) -> Floats:
        """Length of each segment times `share_inside`, (segments,) array [m]."""
        return self.share_inside() * self.segment_lengths()


@dataclass(frozen=True, eq=False, slots=True)
class Pieces:
    """Straight pieces of fibers, by their axes: where the true cylinders are that a surface stands for.

    Parameters
    ----------
    start, end : (n, 3) arrays [m]
        Of each axis; what ends on a side of the plan runs on beyond it.
    fiber : (n,) int array
        Fiber that each piece belongs to.
    flat : (n, 2) bool array
        Whether a piece ends flat at its start and at its end; else in half a ball, as it does at bends.
    """

    start: Floats
    end: Floats
    fiber: Ints
    flat: npt.NDArray[np.bool_]

    def __post_init__(self) -> None:
        freeze(
            self,
            start=np.asarray(self.start, np.float64),
            end=np.asarray(self.end, np.float64),
            fiber=np.asarray(self.fiber, np.int64),
            flat=np.asarray(self.flat, np.bool_),
        )
        count = len(self.fiber)
        require(self.start.shape == self.end.shape == (count, 3), "not every piece has a start and an end")
        require(self.flat.shape == (count, 2), "not every piece says how it ends")
        require(bool((self.start != self.end).any(axis=1).all()), "a piece has no length")

    def __len__(self) -> int:
        """Count the pieces."""
        return len(self.fiber)
