"""The strip with its settings that a microscope writes below or above a picture."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.float32]

_FLAT = 0.45
"""A row belongs to an info strip if this share of its pixels have one and the same brightness."""
_HIGHEST_STRIP = 0.25


def strip_rows(brightness: Image) -> tuple[int, int]:
    """Give the rows that are picture, from the first up to below the last; what is above or below is an info strip.

    Parameters
    ----------
    brightness : (rows, columns) array [-]
    """
    rows = len(brightness)
    levels = np.round(brightness * 255).astype(np.int64)
    share = np.array([np.bincount(row, minlength=256).max() for row in levels]) / levels.shape[1]
    flat = share >= _FLAT
    most = int(_HIGHEST_STRIP * rows)
    below = _run(flat[::-1])
    above = _run(flat)
    middle = share[most : rows - most]
    # a picture that is flat all over, as of a few fibers before a black ground, has no strip
    busy = len(middle) > 0 and float(np.median(middle)) < 0.75 * float(np.median(share[flat])) if flat.any() else False
    first = above if busy and 0 < above <= most else 0
    last = rows - below if busy and 0 < below <= most else rows
    return first, last


def _run(flat: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> int:
    """Count the rows of a strip from its outer edge; up to three rows of its text may be busier."""
    last, gap = 0, 0
    for number, is_flat in enumerate(flat, start=1):
        if is_flat:
            last, gap = number, 0
        else:
            gap += 1
            if gap > 3:
                break
    return last
