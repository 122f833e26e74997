"""How large the tetrahedra may be at each place: small at the fibers, larger with the distance from them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools

import numpy as np
from scipy.spatial import cKDTree

from pipeline.nouns.arrays import Floats

_SPACING = 1.0  # of the field's own grid, in fiber diameters: the field is linear in the distance, so coarse will do
_MOST_NODES = 400_000  # of the grid; wider ducts get a coarser one

# Kuhn's six tetrahedra of a cube, by the corner's index 4 x + 2 y + z: they match across neighboring cubes.
_KUHN = np.array([[0, 4, 6, 7], [0, 6, 2, 7], [0, 2, 3, 7], [0, 3, 1, 7], [0, 1, 5, 7], [0, 5, 4, 7]])


def size_field(
    lower: Floats, upper: Floats, fiber_points: Floats, edge: float, growth: float, largest: float
) -> dict[str, np.ndarray]:
    """Make the background mesh that tells fTetWild the edge length wanted at each place.

    Parameters
    ----------
    lower, upper : (3,) array
        Corners of the duct, in fiber diameters.
    fiber_points : (n, 3) array
        Points on the fibers, not much farther apart than a diameter.
    edge : float
        Edge length at the fibers.
    growth : float
        Added edge length per distance from the fibers, 0 for the same length everywhere.
    largest : float
        No edge length is above this.

    Returns
    -------
    dict
        ``bg_vertices`` (n, 3), ``bg_tets`` (m, 4) and ``bg_values`` (n,): arguments of the mesher.
    """
    spacing = max(_SPACING, float(np.prod(upper - lower) / _MOST_NODES) ** (1 / 3))
    counts = np.maximum(2, np.ceil((upper - lower) / spacing).astype(np.int64) + 1)
    axes = [np.linspace(low, high, count) for low, high, count in zip(lower, upper, counts, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(nodes)).reshape(counts)
    corners = np.stack(
        [
            number[x : x + counts[0] - 1, y : y + counts[1] - 1, z : z + counts[2] - 1].ravel()
            for x, y, z in itertools.product((0, 1), repeat=3)
        ],
        axis=1,
    )
    distance, _ = cKDTree(fiber_points).query(nodes)
    # the nearest point on a fiber is nearer than its nearest vertex, by half a vertex spacing at most
    clear = np.maximum(0.0, distance - 0.5)
    return {
        "bg_vertices": nodes,
        "bg_tets": corners[:, _KUHN].reshape(-1, 4).astype(np.int32),
        "bg_values": np.minimum(largest, edge + growth * clear),
    }
