"""How large the tetrahedra may be at each place: small at each fiber by its own diameter, larger away from them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
from scipy.spatial import Delaunay, cKDTree

from pipeline.geometry.tets import volumes
from pipeline.nouns.arrays import Floats

_SPACING = 1.0  # of the field's nodes away from fibers, in mean diameters: it is linear there, so coarse will do
_MOST_NODES = 20_000  # of those; wider ducts get them farther apart
_ON_FIBERS = 0.7  # cubes of this many diameters hold one node each, on the surface of a fiber
_CLASS = 1.2  # ratio of diameters within which fibers are told apart by the thinnest of them
_JITTER = 0.1  # spacings: nodes in rows and columns have no one Delaunay mesh
_FLAT = 1e-6  # volume of a tetrahedron, in cubed spacings, in which nothing can be interpolated


def size_field(
    lower: Floats, upper: Floats, points: Floats, diameter: Floats, edge: float, growth: float, largest: float
) -> dict[str, np.ndarray]:
    """Make the background mesh that tells fTetWild the edge length wanted at each place.

    Parameters
    ----------
    lower, upper : (3,) array
        Corners of the duct, in mean fiber diameters, as all lengths here.
    points : (n, 3) array
        Points on the fibers, not much farther apart than the diameter of the fiber.
    diameter : (n,) array
        Of the fiber that each lies on.
    edge : float
        Edge length at a fiber, in diameters of that fiber.
    growth : float
        Added edge length per distance from the fibers, 0 for the same length everywhere.
    largest : float
        No edge length is above this.

    Returns
    -------
    dict
        ``bg_vertices`` (n, 3), ``bg_tets`` (m, 4) and ``bg_values`` (n,): arguments of the mesher.
    """
    nodes = np.concatenate([_grid(lower, upper), np.clip(_thinned(points, diameter), lower, upper)])
    tets = np.asarray(Delaunay(nodes).simplices, dtype=np.int64)
    size = volumes(nodes, tets)
    tets = np.where(size[:, None] < 0.0, tets[:, [0, 1, 3, 2]], tets)[np.abs(size) > _FLAT * _SPACING**3]
    return {
        "bg_vertices": nodes,
        "bg_tets": tets.astype(np.int32),
        "bg_values": wanted(nodes, points, diameter, edge, growth, largest),
    }


def wanted(places: Floats, points: Floats, diameter: Floats, edge: float, growth: float, largest: float) -> Floats:
    """Give the edge length wanted at each place, (k,), by the fiber that asks for the shortest."""
    shortest = np.full(len(places), largest)
    for number in np.unique(_classes(diameter)):
        of_class = _classes(diameter) == number
        thinnest = float(diameter[of_class].min())
        distance, _ = cKDTree(points[of_class]).query(places)
        # the nearest point on a fiber is nearer than its nearest vertex, by half a vertex spacing at most
        clear = np.maximum(0.0, distance - 0.5 * thinnest)
        shortest = np.minimum(shortest, edge * thinnest + growth * clear)
    return shortest


def _classes(diameter: Floats) -> Floats:
    return np.asarray(np.floor(np.log(diameter / diameter.min()) / np.log(_CLASS) + 1e-9))


def _grid(lower: Floats, upper: Floats) -> Floats:
    spacing = max(_SPACING, float(np.prod(upper - lower) / _MOST_NODES) ** (1 / 3))
    counts = np.maximum(2, np.ceil((upper - lower) / spacing).astype(np.int64) + 1)
    axes = [np.linspace(low, high, count) for low, high, count in zip(lower, upper, counts, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    inner = (nodes > lower) & (nodes < upper)
    step = _JITTER * (upper - lower) / (counts - 1)
    return np.asarray(nodes + inner * step * np.random.default_rng(0).uniform(-1.0, 1.0, nodes.shape))


def _thinned(points: Floats, diameter: Floats) -> Floats:
    cubes = np.floor(points / (_ON_FIBERS * diameter[:, None])).astype(np.int64)
    # fibers of another diameter have cubes of another size
    _, first = np.unique(np.column_stack([cubes, _classes(diameter)]), axis=0, return_index=True)
    return points[np.sort(first)]
