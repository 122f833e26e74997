"""Straight parallel fibers across the flow: the mats with exact drag."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.box import Box
from pipeline.mat.settings import ArraySettings
from pipeline.nouns.fibers import Mat


def array(settings: ArraySettings) -> Mat:
    """Lay rows of fibers along y, one pitch wide, with symmetry planes at both x sides.

    A square array has one fiber per row, midway between the sides. In a hexagonal one every other row has its
    fibers in the side planes instead, half of each within the plan. The slab is as thick as its rows are apart,
    so the solidity of the slab is that of the endless array.

    Parameters
    ----------
    settings : ArraySettings

    Returns
    -------
    Mat

    Examples
    --------
    >>> array(ArraySettings(arrangement="hexagonal", solidity=0.1, fiber_diameter=1e-6, rows=2)).fibers
    3
    """
    pitch, row_pitch = settings.pitch, settings.pitch * settings.row_pitch_ratio
    depth = pitch if settings.depth is None else settings.depth
    nodes = []
    for row in range(settings.rows):
        beside = settings.arrangement == "hexagonal" and row % 2 == 0
        for x in (0.0, pitch) if beside else (0.5 * pitch,):
            z = (row + 0.5) * row_pitch
            nodes += [(x, 0.0, z), (x, depth, z)]
    fibers = len(nodes) // 2
    return Mat(
        nodes=np.array(nodes),
        first=2 * np.arange(fibers + 1),
        radius=np.full(fibers, 0.5 * settings.fiber_diameter),
        slab=Box((0.0, 0.0, 0.0), (pitch, depth, settings.rows * row_pitch)),
        seed=-1,
        origin=f"{settings.arrangement} array, solidity {settings.solidity:g}, {settings.rows} rows",
    )
