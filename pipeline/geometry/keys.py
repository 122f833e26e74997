"""A table from whole numbers to rows, for compiled loops: numba's own dictionary takes ten times as long."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Ints

KeyTable = tuple[Ints, npt.NDArray[np.int32]]
"""Keys by slot, -1 where a slot is free, and the row of each."""

_MIX = -7046029254386353131  # 2^64 over the golden ratio: neighboring keys go to distant slots


@compiled
def empty_table(most: int) -> KeyTable:
    """Make a table for at most so many keys."""
    size = 16
    while size < 2 * most:
        size *= 2
    return np.full(size, -1, np.int64), np.empty(size, np.int32)


@compiled
def _slot(keys: Ints, key: int) -> int:
    mask = len(keys) - 1
    mixed = key * _MIX
    place = (mixed ^ (mixed >> 32)) & mask
    while keys[place] != -1 and keys[place] != key:
        place = (place + 1) & mask
    return int(place)


@compiled
def row_of(table: KeyTable, key: int) -> int:
    """Row of a key that is 0 or more; -1 if it is not in the table."""
    place = _slot(table[0], key)
    return int(table[1][place]) if table[0][place] == key else -1


@compiled
def add(table: KeyTable, key: int, row: int) -> int:
    """Put in a key, 0 or more, with a row, unless it is there; give the row it has."""
    place = _slot(table[0], key)
    if table[0][place] == -1:
        table[0][place] = key
        table[1][place] = row
    return int(table[1][place])
