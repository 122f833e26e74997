"""A unit cube in tetrahedra."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools

import numpy as np

from pipeline.geometry.triangles import Floats, Ints

_PATHS = list(itertools.permutations(range(3)))


def kuhn_box(count: int) -> tuple[Floats, Ints]:
    """Split the unit cube into count^3 cubes of six tetrahedra each, along their diagonals."""
    number = np.arange((count + 1) ** 3).reshape((count + 1,) * 3)
    points = np.stack(np.meshgrid(*[np.linspace(0, 1, count + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    tets = []
    for corner in itertools.product(range(count), repeat=3):
        for path in _PATHS:
            place = np.array(corner)
            cell = [number[tuple(place)]]
            for axis in path:
                place[axis] += 1
                cell.append(number[tuple(place)])
            odd = np.linalg.det(np.eye(3)[list(path)]) < 0
            tets.append([cell[1], cell[0], cell[2], cell[3]] if odd else cell)
    return points, np.array(tets, dtype=np.int64)
