"""Which nodes of a mesh are one: opposite sides of a periodic duct."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.patches import SIDES
from pipeline.solve.stokes.nodes import Nodes

TOLERANCE = 1e-6
"""Largest distance of two vertices that are the same, over the distance of the sides."""
_CURVE_BITS = 16  # of each coordinate's place: three of them fit into an integer


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
    places = np.concatenate([points, nodes.middles(points)])
    if cyclic:
        for low, high in (SIDES[:2], SIDES[2:]):
            _pair(places, nodes, triangles, low, high, partner)
        # an edge of the duct lies on two sides: its image's image
        partner = partner[partner]
    alone = np.flatnonzero(partner == np.arange(nodes.count))
    # neighbors in space get neighboring numbers, which keeps what a loop over rows reads close together
    order = np.lexsort((_along_a_curve(places[alone]), alone >= nodes.vertices))
    number = np.empty(nodes.count, np.int64)
    number[alone[order]] = np.arange(len(alone))
    return number[partner]


def _along_a_curve(places: Floats) -> Ints:
    """Place of each point along Morton's curve, which visits a cube's eighths one after the other, and so on within."""
    low = places.min(axis=0)
    grid = ((places - low) / (places - low).max() * (2**_CURVE_BITS - 1)).astype(np.int64)
    key = np.zeros(len(places), np.int64)
    for bit in range(_CURVE_BITS):
        for axis in range(3):
            key |= (grid[:, axis] >> bit & 1) << (3 * bit + axis)
    return key


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
