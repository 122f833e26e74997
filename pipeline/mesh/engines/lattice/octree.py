"""Which cubes the duct is cut into: small ones at the fibers, two and four times as large away from them.

Corners of cubes have even coordinates on the *lattice*, whose unit is half the edge of the smallest cube: so the center
of every cube, and the middle of every face and edge, is a lattice point as well.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.geometry.triangles import Floats, Ints


@dataclass(frozen=True, eq=False, slots=True)
class Octree:
    """Cubes that fill a box, neighbors (through corners too) differing by one level at the most.

    Parameters
    ----------
    counts : tuple of int
        Smallest cubes along each axis.
    level : int8 array of shape `counts`
        Level of the cube that each smallest cube lies in.
    """

    counts: tuple[int, int, int]
    level: npt.NDArray[np.int8]

    def cubes(self, level: int) -> Ints:
        """Lowest corner of each cube of a level, in smallest cubes, (n, 3) int array."""
        step = 1 << level
        coarse = self.level[::step, ::step, ::step]
        return np.argwhere(coarse == level) * step


def octree(distance: Floats, sizes: tuple[float, ...], edge: float) -> Octree:
    """Choose the largest cubes that the distance from the fibers allows.

    Parameters
    ----------
    distance : (nx, ny, nz) array
        From the center of each smallest cube to the fibers, negative within them.
    sizes : tuple of float
        Distance that level 1, 2, ... asks for at every point.
    edge : float
        Of the smallest cube.

    Returns
    -------
    Octree
    """
    x, y, z = distance.shape
    largest = 1 << len(sizes)
    # where the count is no multiple of the largest cube, the last ones stay small
    padded = np.pad(distance, [(0, -count % largest) for count in distance.shape], constant_values=-np.inf)
    result = np.zeros(padded.shape, dtype=np.int8)
    # the distance at a center tells that anywhere in its cube to half a diagonal
    nearest = padded - 0.5 * np.sqrt(3.0) * edge
    smaller = np.ones(padded.shape, dtype=bool)
    for level, asked in enumerate(sizes, 1):
        nearest = _blocks(nearest).min(axis=(1, 3, 5))
        # a cube may touch only cubes that are at most one level smaller
        allowed = (nearest >= asked) & _blocks(_shrunk(smaller)).all(axis=(1, 3, 5))
        cubes = allowed
        for axis in range(3):
            cubes = cubes.repeat(1 << level, axis=axis)
        result[cubes] = level
        smaller = allowed
    return Octree((x, y, z), result[:x, :y, :z])


def _blocks(values: npt.NDArray[np.generic]) -> npt.NDArray[np.generic]:
    x, y, z = values.shape
    return values.reshape(x // 2, 2, y // 2, 2, z // 2, 2)


def _shrunk(cubes: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Cubes that are set together with all 26 around them; beyond the box all count as set."""
    for axis in range(3):
        padded = np.pad(cubes, [(1, 1) if k == axis else (0, 0) for k in range(3)], constant_values=True)
        lower, upper = (np.take(padded, range(start, start + cubes.shape[axis]), axis=axis) for start in (0, 2))
        cubes = cubes & lower & upper
    return cubes
