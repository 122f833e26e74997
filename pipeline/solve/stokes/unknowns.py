"""Which nodes of a mesh are one: opposite sides of a periodic duct."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.patches import SIDES
from pipeline.solve.stokes.nodes import Nodes

TOLERANCE = 1e-6
"""Largest distance of two vertices that are the same, over the distance of the sides."""


def unknown_of_nodes(points: Floats, nodes: Nodes, triangles: dict[str, Ints], cyclic: bool) -> Ints:
    """Give each node the number of its unknown, vertices first.

    Parameters
    ----------
    points : (n, 3) array
        Vertices of the straight mesh.
    nodes : Nodes
    triangles : dict of (b, 3) int array
        By patch.
    cyclic : bool
        Whether what lies on ``xmax`` and ``ymax`` is what lies on ``xmin`` and ``ymin``.

    Returns
    -------
    (nodes,) int array

    Raises
    ------
    StageError
        If two opposite sides do not carry the same nodes.
    """
    partner = np.arange(nodes.count)
    if cyclic:
        places = np.concatenate([points, nodes.middles(points)])
        for low, high in (SIDES[:2], SIDES[2:]):
            _pair(places, nodes, triangles, low, high, partner)
        # an edge of the duct lies on two sides: its image's image
        partner = partner[partner]
    alone = partner == np.arange(nodes.count)
    number = np.cumsum(alone) - 1
    return np.asarray(number[partner], np.int64)


def _pair(places: Floats, nodes: Nodes, triangles: dict[str, Ints], low: str, high: str, partner: Ints) -> None:
    from scipy.spatial import cKDTree

    below, above = (np.unique(nodes.of_triangles(triangles[name])) for name in (low, high))
    axis = SIDES.index(low) // 2
    across = np.delete(np.arange(3), axis)
    size = float(places[above, axis].mean() - places[below, axis].mean())
    gap, nearest = cKDTree(places[below][:, across]).query(places[above][:, across])
    lonely = int(np.count_nonzero(np.asarray(gap) > TOLERANCE * size))
    if len(below) != len(above) or lonely or len(np.unique(nearest)) != len(below):
        raise StageError(
            f"cyclic sides need the same triangles on {low} and {high}, but {lonely} of {len(above)} nodes of {high} "
            "have no partner: take another tetmesh.engine, or set enclosure.sides to symmetry"
        )
    partner[above] = below[nearest]
