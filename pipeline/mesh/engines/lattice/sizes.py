"""How large the lattice's cubes may be at each fiber, and how many of the smallest ones the duct holds."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.nouns.arrays import Bools, Floats, Ints

_OVER = 1.05  # of its wanted edge that a cube may have, since edges double from level to level
_PHASES = 24  # smallest edges tried between one and twice the least
_FEWEST = 8  # cubes along an axis: with fewer of them rounding their number would change their shape too much


@dataclass(frozen=True, eq=False, slots=True)
class Grid:
    """The smallest cubes of a box, whose edges double from level to level.

    Parameters
    ----------
    counts : (3,) int array
        Smallest cubes along each axis.
    edge : (3,) array
        Extent of a smallest cube along each axis.
    """

    counts: Ints
    edge: Floats


def grid(size: Floats, wanted: Floats, weight: Floats, finer: int, largest: float, wrapped: Bools) -> Grid:
    """Choose the smallest edge so that cubes at the fibers are about as large as wanted, and fit it to the box.

    Parameters
    ----------
    size : (3,) array
        Of the box.
    wanted : (n,) array
        Largest edge of a cube at each fiber.
    weight : (n,) array
        Surface of each.
    finer : int
        Levels below what the thinnest fiber wants.
    largest : float
        Largest edge of any cube.
    wrapped : (3,) bool array
        Axes along which the box repeats itself.

    Returns
    -------
    Grid

    Notes
    -----
    The smallest edge is tried at `_PHASES` places within an octave; the one that makes the fewest cubes at the
    surfaces is taken. Fibers of one diameter get exactly the edge they want.
    """
    if np.ptp(wanted) <= 1e-6 * wanted.max():
        least = float(wanted[0])
    else:
        tried = wanted.min() * 2.0 ** -(np.arange(_PHASES) / _PHASES) * _OVER
        given = tried * 2.0 ** np.floor(np.log2(_OVER * wanted[:, None] / tried))
        least = float(tried[(weight[:, None] / given**2).sum(axis=0).argmin()])
    least /= 2.0**finer
    top = max(0, int(np.floor(np.log2(1.001 * largest / least))))
    counts = np.empty(3, np.int64)
    for axis in range(3):
        # along an axis that repeats, the largest cubes have to fit; else the last ones may stay small
        level = top
        while level > 0 and size[axis] / (least * 2.0**level) < (2.0 if wrapped[axis] else _FEWEST):
            level -= 1
        counts[axis] = max(1, round(float(size[axis] / (least * 2.0**level)))) << level
    return Grid(counts, size / counts)


def allowed(wanted: Floats) -> Floats:
    """Largest edge that a cube may have at each fiber, the edges of levels being what they are."""
    return wanted if np.ptp(wanted) <= 1e-6 * wanted.max() else _OVER * wanted
