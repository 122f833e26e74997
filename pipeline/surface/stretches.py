"""Where a tube that runs into itself is cut, so that no part of it does."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.geometry.crossings import crossing_pairs
from pipeline.geometry.segments import near_pairs
from pipeline.geometry.triangles import Floats, Ints

_STRAIGHT = math.cos(math.radians(30.0))


def stretches(points: Floats, triangles: Ints, band: Ints, piece: Ints, nodes: Floats, reach: float) -> list[int]:
    """Choose the rings at which a tube is cut so that no stretch of it cuts or covers itself.

    Two parts of a tube are in conflict if triangles of theirs cut each other, or if their axes come nearer than two
    radii although the way from one to the other along the axis is longer than half a turn about the tube's own
    radius: on a shorter way they cannot meet as long as the bends are open enough for miters. The second rule finds
    what covers itself without a cut, as a coil without a pitch does.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        Of the whole tube.
    band : (m,) int array
        The band between two rings that each triangle belongs to, from 0; the caps belong to their neighbors.
    piece : (rings,) int array
        Piece of the center line that the band after each ring lies on.
    nodes : (k, 3) array [m]
        The center line.
    reach : float [m]
        From the axis to the tube's corners.

    Returns
    -------
    list of int
        Rings, ascending, none of them the first or the last; empty for nearly every tube.

    Notes
    -----
    A line whose pieces all lie within 30 degrees of one direction is not looked at: there a way along the axis is no
    longer than 1.16 times the distance it leads, so that two parts nearer than two radii are never half a turn apart.
    """
    steps = np.diff(nodes, axis=0)
    along = steps @ (nodes[-1] - nodes[0])
    length = np.linalg.norm(steps, axis=1) * np.linalg.norm(nodes[-1] - nodes[0])
    if (along > _STRAIGHT * length).all():
        return []
    conflicts = np.sort(band[crossing_pairs(points, triangles)], axis=1)
    conflicts = np.concatenate([conflicts[conflicts[:, 0] < conflicts[:, 1]], _covering(piece, nodes, reach)])
    cuts: list[int] = []
    # the fewest cuts that part every pair: take the pairs by their ends, and cut as late as possible
    for first, second in conflicts[np.argsort(conflicts[:, 1], kind="stable")].tolist():
        if not cuts or cuts[-1] <= first:
            cuts.append(second)
    return cuts


def _covering(piece: Ints, nodes: Floats, reach: float) -> Ints:
    """Pairs of bands, (k, 2), between which the tube comes back to where it has been; each stands for its piece."""
    pieces = len(nodes) - 1
    near = near_pairs(nodes[:-1], nodes[1:], np.full(pieces, reach), np.arange(pieces))
    traveled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])
    far = traveled[near.second] - traveled[near.first + 1] > math.pi * reach
    # a cut at any ring from the end of the one piece to the start of the other parts them
    last = np.searchsorted(piece[:-1], near.first[far], "right") - 1
    start = np.searchsorted(piece[:-1], near.second[far], "left")
    return np.stack([last, start], axis=1)
