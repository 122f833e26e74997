"""The fibers that air meets first, in arrays of straight fibers across the flow."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.nouns.arrays import Bools, Floats
from pipeline.nouns.fibers import Mat


def first_row(mat: Mat) -> tuple[Bools, float] | None:
    """Find the fibers nearest to the inlet, and how much of the face they stand before.

    Parameters
    ----------
    mat : Mat

    Returns
    -------
    fibers : (fibers,) bool array
    area : float [m2]
        Their projection onto the face; of a fiber in a side plane, what is within.
    None
        If the mat is no array: a fiber is not straight, or not across the flow.
    """
    ends = np.stack([mat.nodes[mat.first[:-1]], mat.nodes[mat.first[1:] - 1]], axis=1)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    along = np.add.reduceat(mat.segment_lengths(), mat.first[:-1] - np.arange(mat.fibers))
    across = np.abs(ends[:, 1, 2] - ends[:, 0, 2]) <= 1e-6 * length
    if not (across & (along <= length * (1 + 1e-9))).all():
        return None
    height = ends[:, 0, 2]
    first = height - height.min() <= 1e-3 * mat.radius
    return first, sum(_shadow(ends[k], float(mat.radius[k]), mat) for k in np.flatnonzero(first))


def _shadow(ends: Floats, radius: float, mat: Mat) -> float:
    # only fibers along an axis can reach over a side, since the others end on it
    (x0, y0, _), (x1, y1, _) = mat.slab.lower, mat.slab.upper
    low, high = ends.min(axis=0), ends.max(axis=0)
    width = np.hypot(*(ends[1] - ends[0])[:2])
    if abs(ends[1, 0] - ends[0, 0]) <= 1e-9 * width:
        return float((min(high[0] + radius, x1) - max(low[0] - radius, x0)) * (min(high[1], y1) - max(low[1], y0)))
    if abs(ends[1, 1] - ends[0, 1]) <= 1e-9 * width:
        return float((min(high[1] + radius, y1) - max(low[1] - radius, y0)) * (min(high[0], x1) - max(low[0], x0)))
    return float(2.0 * radius * width)
