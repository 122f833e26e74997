"""Flows in closed form on meshes of second order, for what is tracked through them to be held against exact answers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
from collections.abc import Callable

import numpy as np

from pipeline.capture.cells import Cells, cells_of
from pipeline.capture.conservative import EDGES
from pipeline.nouns.arrays import Bools, Floats, Ints


def brick_tets(cells: tuple[int, int, int]) -> Ints:
    """Six positive tetrahedra (Kuhn) in each brick of a grid of points in C order, (6 cells, 4) int array."""
    shape = tuple(n + 1 for n in cells)
    corner = np.stack(np.meshgrid(*(np.arange(n) for n in cells), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    result = []
    for axes in itertools.permutations(range(3)):
        path = np.zeros((4, 3), np.int64)
        for step, axis in enumerate(axes):
            path[step + 1 :, axis] += 1
        if np.linalg.det(path[1:].astype(float)) < 0:
            path = path[[0, 1, 3, 2]]
        result.append(np.ravel_multi_index(np.moveaxis(corner + path, -1, 0), shape))
    return np.concatenate(result)


def sampled(
    points: Floats, tets: Ints, velocity: Callable[[Floats], Floats], opening: Callable[[Floats], Bools] | None = None
) -> Cells:
    """Take a velocity at the nodes of a mesh with straight edges.

    Parameters
    ----------
    points : (n, 3) array
    tets : (m, 4) int array
    velocity : function of (k, 3) places to (k, 3) velocities
    opening : function of (k, 3) places to (k,) bools, optional
        Where air that the sampled velocity lacks comes from; the outlet unless given.
    """
    pairs = np.sort(tets[:, EDGES], axis=2).reshape(-1, 2)
    ends, edge = np.unique(pairs, axis=0, return_inverse=True)
    nodes = np.hstack([tets, len(points) + edge.reshape(-1, 6)])
    position = np.vstack([points, points[ends].mean(axis=1)])
    return cells_of(nodes, position, velocity(position), opening=None if opening is None else opening(position))


def brick(lower: Floats, upper: Floats, cells: tuple[int, int, int]) -> tuple[Floats, Ints]:
    """Points and tetrahedra of a box."""
    axes = [np.linspace(a, b, n + 1) for a, b, n in zip(lower, upper, cells, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3), brick_tets(cells)


def half_ring(outer: float, depth: float, cells: tuple[int, int]) -> tuple[Floats, Ints]:
    """Points and tetrahedra of half a ring, x >= 0, about a fiber of radius 1 along y; finer toward the fiber."""
    across, around = cells
    radius = outer ** np.linspace(0.0, 1.0, across + 1)
    angle = np.linspace(0.0, np.pi, around + 1)
    r, y, theta = np.meshgrid(radius, [0.0, depth], angle, indexing="ij")
    # angle 0 is upstream; radius, y and angle are right-handed as x, y and z are
    points = np.stack([r * np.sin(theta), y, -r * np.cos(theta)], axis=-1).reshape(-1, 3)
    return points, brick_tets((across, 1, around))


def on_rim(outer: float) -> Callable[[Floats], Bools]:
    """Whether a place of a half ring is on its outer rim."""
    return lambda places: np.hypot(places[:, 0], places[:, 2]) > 0.999 * outer


def kuwabara(solidity: float) -> Callable[[Floats], Floats]:
    r"""Flow about a fiber of radius 1 along y, at velocity 1 along z, in Kuwabara's cell [1]_.

    With the stream function :math:`f(r)\sin\theta`,
    :math:`f = \{(1-\phi/2)/r - (1-\phi) r - (\phi/2) r^3 + 2 r\ln r\}/(2 Ku)`.

    References
    ----------
    .. [1] S. Kuwabara, J. Phys. Soc. Japan 14 (1959) 527, doi:10.1143/JPSJ.14.527.
    """
    factor = hydrodynamic(solidity)

    def velocity(places: Floats) -> Floats:
        x, z = places[:, 0], places[:, 2]
        r2 = np.maximum(x * x + z * z, 1.0)
        r = np.sqrt(r2)
        cos, sin = -z / r, x / r
        over_r = ((1 - solidity / 2) / r2 - (1 - solidity) - solidity / 2 * r2 + 2 * np.log(r)) / (2 * factor)
        slope = (-(1 - solidity / 2) / r2 - (1 - solidity) - 1.5 * solidity * r2 + 2 * np.log(r) + 2) / (2 * factor)
        # inward along the radius upstream, with the flow beside the fiber
        inward, along = over_r * cos, slope * sin
        return np.stack([-inward * sin + along * cos, np.zeros_like(r), inward * cos + along * sin], axis=1)

    return velocity


def hydrodynamic(solidity: float) -> float:
    """Kuwabara's factor Ku = -ln(phi)/2 - 3/4 + phi - phi^2/4."""
    return float(-0.5 * np.log(solidity) - 0.75 + solidity - 0.25 * solidity**2)


def kuwabara_interception(solidity: float, ratio: float) -> float:
    """Exact single-fiber efficiency of interception in Kuwabara's flow, for a particle over fiber diameter `ratio`."""
    r = 1.0 + ratio
    value = (1 - solidity / 2) / r - (1 - solidity) * r - solidity / 2 * r**3 + 2 * r * np.log(r)
    return float(value / (2 * hydrodynamic(solidity)))


def between_plates(places: Floats) -> Floats:
    """Poiseuille's flow of mean velocity 1 along z between plates at x = -1 and x = 1."""
    velocity = np.zeros_like(places)
    velocity[:, 2] = 1.5 * np.maximum(1.0 - places[:, 0] ** 2, 0.0)
    return velocity


def plate_starts(count: int) -> Floats:
    """Places at z = 0 between the plates, as dense as the flow: its flux within x is (3 x - x^3) / 4 + 1/2."""
    share = (np.arange(count) + 0.5) / count
    x = 2.0 * np.cos((np.arccos(1.0 - 2.0 * share) + 4.0 * np.pi) / 3.0)
    return np.column_stack([x, np.full(count, 0.1), np.zeros(count)])
