"""When a pressure drop that changes from iteration to iteration may be believed."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.nouns.arrays import Floats


def change(values: Floats, window: int) -> float:
    """Spread of the last `window` changes, relative to the last value.

    Parameters
    ----------
    values : (k,) array
        The pressure drop at each iteration.
    window : int
        Iterations to look back.

    Returns
    -------
    float [-]
        1 or more while fewer than `window` + 1 values are there.

    Examples
    --------
    >>> import numpy as np
    >>> change(np.array([9.0, 4.0, 4.0, 5.0]), 2)
    0.2
    """
    if len(values) <= window or values[-1] == 0:
        return 1.0
    recent = values[-window - 1 :]
    return float((recent.max() - recent.min()) / abs(values[-1]))
