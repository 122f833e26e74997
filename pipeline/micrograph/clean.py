"""Streaks of charging, which a microscope puts into a picture and which are no fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from pipeline.micrograph.ribbons import Image, noise_of

_STREAK_ROWS = 9
"""Rows that a streak's neighborhood reaches over; it is at most four rows high, and fibers to be measured are wider."""
_STREAK_COLUMNS = 41
"""A streak is this many pixels long."""


def without_streaks(brightness: Image) -> tuple[Image, float]:
    """Take thin streaks along the rows out, which charging leaves.

    Parameters
    ----------
    brightness : (rows, columns) array [-]

    Returns
    -------
    brightness : (rows, columns) array [-]
        With the rows' neighborhood where there were streaks.
    share : float [-]
        Share of the pixels that were replaced.
    """
    around = median_filter(brightness, size=(_STREAK_ROWS, 1), mode="nearest")
    above = uniform_filter1d(brightness - around, _STREAK_COLUMNS, axis=1, mode="nearest")
    limit = 0.03 + 5.0 * noise_of(brightness) / np.sqrt(_STREAK_COLUMNS)
    core = np.abs(above) > limit
    # an average sees only half of itself at a streak's ends
    streak = uniform_filter1d(core.astype(np.float32), _STREAK_COLUMNS // 2, axis=1, mode="nearest") > 0
    return np.where(streak, around, brightness), float(streak.mean())
