"""Loop over links that join things. Compiled by numba: imported only where parts are looked for."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.tets import Cells
from pipeline.geometry.triangles import Ints


@compiled
def joined(first: Ints, second: Ints, count: int) -> tuple[int, Ints]:
    """Find the parts that links join, as `pipeline.geometry.parts.parts` gives them.

    Notes
    -----
    Disjoint sets whose paths are halved (Tarjan & van Leeuwen, J. ACM 31:245, 1984); the thing of lowest number stands
    for its part, so that parts are numbered by their first thing.
    """
    above = np.arange(count).astype(np.int32)
    for link in range(len(first)):
        one, two = _top(above, first[link]), _top(above, second[link])
        if one < two:
            above[two] = one
        else:
            above[one] = two
    part = np.empty(count, np.int64)
    number = 0
    for thing in range(count):
        if above[thing] == thing:
            part[thing] = number
            number += 1
        else:
            # one of lower number, which has its part already
            part[thing] = part[above[thing]]
    return number, part


@compiled
def _top(above: Cells, thing: int) -> int:
    while above[thing] != thing:
        above[thing] = above[above[thing]]
        thing = above[thing]
    return thing
