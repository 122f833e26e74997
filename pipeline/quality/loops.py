"""Loops over all values of a metric. Compiled by numba: imported only where a mesh is judged."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled_for_threads
from pipeline.geometry.tets import Cells
from pipeline.nouns.arrays import Floats, Ints


@compiled_for_threads
def worst_of_faces(
    first: Ints, faces: Cells, values: Floats, largest: bool, field: Floats, begin: int, end: int
) -> None:
    """Fill in the worst of their faces' values for some cells.

    Parameters
    ----------
    first, faces
        As in `pipeline.geometry.polyhedra.Polyhedra`.
    values : (faces,) or (internal,) array
        A cell with no face among them gets 0 where the largest is worst, else 1.
    largest : bool
        Whether the largest is worst, or the smallest.
    field : (cells,) array
    """
    for cell in range(begin, end):
        worst = -np.inf if largest else np.inf
        for k in range(first[cell], first[cell + 1]):
            face = faces[k] if faces[k] >= 0 else -1 - faces[k]
            if face < len(values):
                worst = max(worst, values[face]) if largest else min(worst, values[face])
        field[cell] = worst if np.isfinite(worst) else 0.0 if largest else 1.0


@compiled_for_threads
def worst_rows(values: Floats, few: int, largest: bool) -> Ints:
    """Find the worst few, worst first; of equal ones those that come first.

    Parameters
    ----------
    values : (n,) array
    few : int
    largest : bool
        Whether the largest is worst, or the smallest.

    Returns
    -------
    (few,) int array
        Fewer where values are no numbers.
    """
    rows = np.empty(few, np.int64)
    count = 0
    sign = 1.0 if largest else -1.0
    for row in range(len(values)):
        value = sign * values[row]
        if np.isnan(value) or (count == few and value <= sign * values[rows[few - 1]]):
            continue
        place = min(count, few - 1)
        while place > 0 and value > sign * values[rows[place - 1]]:
            rows[place] = rows[place - 1]
            place -= 1
        rows[place] = row
        count = min(count + 1, few)
    return rows[:count]
