"""Which blocks the duct is cut into, how often those at the fibers are halved, and where the air is for sure."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.arrays import Floats

EDGES_PER_BLOCK = 2.0
"""Edges of a tetrahedron over edges of a cube of the same volume: (6 sqrt 2)^(1/3) = 2.04."""


@dataclass(frozen=True, slots=True)
class Layout:
    """How snappyHexMesh starts, in any unit of length.

    Parameters
    ----------
    counts : tuple of 3 ints
        Blocks along x, y and z.
    level : int
        How often a block at the fibers is halved along each axis.
    buffer : int
        Cells of each size between a smaller and a larger one.
    reach : tuple of floats
        Distance from the fibers within which each cell is halved, for level 0, 1, up to the last but one.
    inside : tuple of 3 floats
        A point in the air, within a cell whatever its level.
    """

    counts: tuple[int, int, int]
    level: int
    buffer: int
    reach: tuple[float, ...]
    inside: tuple[float, float, float]


def layout(lower: Floats, upper: Floats, fibers: Floats, settings: TetmeshSettings) -> Layout:
    """Choose blocks whose cells are as large as the tetrahedra that the settings speak of.

    Parameters
    ----------
    lower, upper : (3,) arrays
        Corners of the duct, in mean fiber diameters.
    fibers : (n, 3) array
        Points on the fibers' surface, in mean fiber diameters.
    settings : TetmeshSettings

    Returns
    -------
    Layout

    Notes
    -----
    A cell at the fibers has the edge h = `edge` / 2: such a cube is as large as a tetrahedron whose edge is `edge`.
    Blocks are the largest h 2^level that the settings allow. An edge that becomes longer by `growth` per distance
    doubles over the distance `edge` / `growth`, which is 2 / `growth` cells of h.
    """
    smallest = settings.edge / EDGES_PER_BLOCK
    level = max(0, math.floor(math.log2(settings.largest_edge / settings.edge) + 1e-9)) if settings.growth > 0 else 0
    counts = np.maximum(1, np.rint((upper - lower) / (smallest * 2**level))).astype(np.int64)
    buffer = max(1, round(EDGES_PER_BLOCK / settings.growth)) if settings.growth > 0 else 1
    x, y, z = (int(count) for count in counts)
    # snappyHexMesh itself looks for the surface between the cells' centers only, and a fiber fits between those of
    # blocks that are longer than it is thick; no point of a cell is farther from its center than half its diagonal
    half_diagonal = 0.5 * float(np.linalg.norm((upper - lower) / counts))
    reach = tuple(half_diagonal / 2**halved for halved in range(level))
    return Layout((x, y, z), level, buffer, reach, _in_the_air(lower, (upper - lower) / counts, (x, y), level, fibers))


def _in_the_air(
    lower: Floats, block: Floats, counts: tuple[int, int], level: int, fibers: Floats
) -> tuple[float, float, float]:
    """Find the block at the inlet whose first small cell is farthest from any fiber, and a point within that cell."""
    corners = np.stack(np.meshgrid(*map(np.arange, counts), [0], indexing="ij"), axis=-1).reshape(-1, 3) * block + lower
    # not its middle, which is a corner of smaller cells if it is halved once more
    points = corners + 0.47 * block / 2**level
    distance, _ = cKDTree(fibers).query(points)
    x, y, z = points[np.argmax(distance)].tolist()
    return (x, y, z)
