"""Which cells, triangles or points hang together."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]


def parts(first: Ints, second: Ints, count: int) -> tuple[int, Ints]:
    """Find the parts that links join.

    Parameters
    ----------
    first, second : (links,) int arrays
        The two things that each link joins, 0 to `count` - 1; any links.
    count : int
        Number of things; one without a link is a part by itself.

    Returns
    -------
    int, (count,) int array
        How many parts there are, and the part of each thing.

    Examples
    --------
    >>> number, part = parts(np.array([0, 3]), np.array([2, 1]), 5)
    >>> number, part.tolist()
    (3, [0, 1, 0, 1, 2])
    """
    # numba takes half a second to load, which no command that reads this module should wait for
    from pipeline.geometry.compiled import read_only
    from pipeline.geometry.joined import joined

    return joined(read_only(np.asarray(first, np.int64)), read_only(np.asarray(second, np.int64)), count)


def largest_part(first: Ints, second: Ints, among: Mask) -> Mask:
    """Find the things of the largest part.

    Parameters
    ----------
    first, second : (links,) int arrays
        The two things that each link joins.
    among : (count,) bool array
        Things that are there: a link to any other joins nothing.

    Returns
    -------
    (count,) bool array

    Examples
    --------
    >>> largest_part(np.array([0, 1, 3]), np.array([1, 2, 4]), np.array([True, True, True, False, True])).tolist()
    [True, True, True, False, False]
    """
    there = among[first] & among[second]
    _, part = parts(first[there], second[there], len(among))
    return np.asarray(among & (part == np.bincount(part[among]).argmax()))
