"""Streaks of charging, which a microscope puts into a picture and which are no fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter, uniform_filter1d

from pipeline.micrograph.ribbons import Image, noise_of

_HIGHEST = 4
"""A streak has at most this many rows; fibers to be measured are wider."""
_ROWS = 9
"""Rows that a streak's neighborhood reaches over."""
_COLUMNS = 41
"""A streak is this many pixels long."""
_ABRUPT = 0.75
"""A streak begins and ends from one row to the next: this share at least of what brightness changes by over three rows.

The beam's width spreads the edge of what is in the picture: by a standard deviation of .5 pixels, to a share of .68.
"""
_FAINTEST = 0.03


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
    steps = np.diff(brightness, axis=0)
    one = uniform_filter1d(steps, _COLUMNS, axis=1, mode="reflect")
    padded = np.pad(one, ((1, 1), (0, 0)), mode="edge")
    three = padded[:-2] + padded[1:-1] + padded[2:]
    limit = _FAINTEST + 5.0 * noise_of(brightness) * np.sqrt(2.0 / _COLUMNS)
    abrupt = np.where((np.abs(one) > limit) & (np.abs(one) >= _ABRUPT * np.abs(three)), one, 0.0)
    streak = np.zeros(brightness.shape, dtype=bool)
    for rows in range(1, _HIGHEST + 1):
        begins, ends = abrupt[:-rows], -abrupt[rows:]
        there = (begins * ends > 0) & (np.abs(begins) < 2.0 * np.abs(ends)) & (np.abs(ends) < 2.0 * np.abs(begins))
        for row in range(rows):
            streak[1 + row : 1 + row + len(there)] |= there
    # an average sees only half of itself at a streak's ends
    streak = maximum_filter1d(streak, _COLUMNS // 2, axis=1, mode="nearest")
    if not streak.any():
        return brightness, 0.0
    around = median_filter(brightness, size=(_ROWS, 1), mode="nearest")
    return np.where(streak, around, brightness), float(streak.mean())
