"""Mats made by hand: what each one is can be seen in its name."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Sequence

import numpy as np

from pipeline.geometry.box import Box
from pipeline.nouns.fibers import Mat

RADIUS = 0.7e-6
SIDE = 10e-6

Line = Sequence[tuple[float, float, float]]


def mat_of(*lines: Line, radius: float = RADIUS, periodic: bool = False) -> Mat:
    """Fibers along polylines given in micrometers, in a cube of 10 um."""
    nodes = [1e-6 * np.array(line, dtype=float) for line in lines]
    first = np.concatenate([[0], np.cumsum([len(line) for line in nodes])])
    slab = Box((0.0, 0.0, 0.0), (SIDE, SIDE, SIDE))
    return Mat(np.concatenate(nodes), first, np.full(len(nodes), radius), slab, -1, "by hand", periodic)


ALONG_X: Line = [(0, 5, 5), (10, 5, 5)]
ALONG_Y: Line = [(5, 0, 5), (5, 10, 5)]

CROSSING = mat_of(ALONG_X, ALONG_Y)
RESTING = mat_of(ALONG_X, [(5, 0, 6.4), (5, 10, 6.4)])
SIDE_BY_SIDE = mat_of(ALONG_X, [(0, 6.4, 5), (10, 6.4, 5)])
COINCIDENT = mat_of(ALONG_X, ALONG_X)
BENT = mat_of([(0, 5, 2), (4, 5, 2), (6, 5, 4), (10, 5, 4)])
HAIRPIN = mat_of([(0, 3, 5), (9, 3, 5), (0, 3.2, 5)])
STUBBY = mat_of([(0, 5, 2), (5, 5, 2), (5.05, 5, 2.05), (5.1, 5, 2), (10, 5, 2)])
BROKEN = mat_of([(2, 2, 3), (7, 7, 6)])
CORNER_TO_CORNER = mat_of([(0, 0, 3), (10, 10, 3)])
GRAZING_A_CORNER = mat_of([(0, 9.99, 3), (0.01, 10, 3)])
GRAZING_A_SIDE = mat_of([(0, 5, 5), (0.01, 10, 5)])
HALF_FIBERS = mat_of([(0, 0, 3), (0, 10, 3)], [(10, 0, 3), (10, 10, 3)], [(5, 0, 7), (5, 10, 7)])
WRAPPING = mat_of([(-3, 2, 3), (17, 7, 6)], periodic=True)
WRAPPING_A_CORNER = mat_of([(8, 8, 3), (13, 12, 3)], periodic=True)
EVERY_MAT = {name: mat for name, mat in globals().items() if isinstance(mat, Mat)}
