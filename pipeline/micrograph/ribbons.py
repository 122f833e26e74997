"""Bright ribbons of any width and direction, by their two edges.

A fiber is where brightness rises on one side and falls on the other. The weaker of the two edges is the response, after
Koller, Gerig, Szekely and Dettwiler, *Multiscale detection of curvilinear structures in 2-D and 3-D image data*,
ICCV 1995: a single edge gives none, and what lies between the edges, a bright rim or a dark middle, does not matter.
Edges are averaged along the ribbon, which takes noise and what crosses it away.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter

from pipeline.geometry.compiled import compiled

DIRECTIONS = 36
"""Directions of ribbons over half a turn; half a step turns the ends of the average by less than 0.3 pixels."""
SMOOTHING = 1.0
"""Standard deviation of the smoothing before brightness is differentiated, in pixels."""
_ALONG = 4.0
"""Standard deviation of the average along the ribbon, in pixels."""

Image = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True)
class Slopes:
    """How brightness rises across ribbons of every direction.

    Parameters
    ----------
    across : (`DIRECTIONS`, rows, columns) array [1/pixel]
        Slope of brightness along the normal of direction k, averaged along the ribbon.
    noise : float [1/pixel]
        Standard deviation of a slope where there is nothing but noise.
    """

    across: Image
    noise: float


def direction_angles() -> npt.NDArray[np.float64]:
    """Angle of each direction from the columns' axis toward the rows' axis [rad], from 0 up to below pi."""
    return np.arange(DIRECTIONS) * math.pi / DIRECTIONS


def slopes(brightness: Image) -> Slopes:
    """Differentiate a picture across ribbons of every direction.

    Parameters
    ----------
    brightness : (rows, columns) array [-]

    Returns
    -------
    Slopes
    """
    down = gaussian_filter(brightness, SMOOTHING, order=(1, 0), mode="nearest")
    right = gaussian_filter(brightness, SMOOTHING, order=(0, 1), mode="nearest")
    # every second pixel: the smoothing before has filled the rest in
    steps = np.arange(-int(2 * _ALONG), int(2 * _ALONG) + 1, 2)
    weights = np.exp(-0.5 * (steps / _ALONG) ** 2)
    weights = (weights / weights.sum()).astype(np.float32)
    across = np.empty((DIRECTIONS, *brightness.shape), np.float32)
    for k, angle in enumerate(direction_angles()):
        # the normal of (cos, sin) is (-sin, cos)
        slope = (np.cos(angle) * down - np.sin(angle) * right).astype(np.float32)
        _average_along(slope, math.cos(angle), math.sin(angle), steps, weights, across[k])
    return Slopes(across, _noise_of_slopes(brightness, weights))


def noise_of(brightness: Image) -> float:
    """Estimate the standard deviation of a picture's noise [-] (Immerkaer, CVIU 64, 1996; by the median)."""
    b = brightness.astype(np.float64)
    # of a pixel's neighborhood, what neither a plane nor an edge along rows or columns leaves
    cross = b[:-2, :-2] - 2 * b[:-2, 1:-1] + b[:-2, 2:]
    cross += -2 * b[1:-1, :-2] + 4 * b[1:-1, 1:-1] - 2 * b[1:-1, 2:]
    cross += b[2:, :-2] - 2 * b[2:, 1:-1] + b[2:, 2:]
    # the weights' squares sum to 36; the median of |normal| is 0.6745 deviations
    return float(np.median(np.abs(cross)) / 0.6745 / 6.0)


def _noise_of_slopes(brightness: Image, weights: npt.NDArray[np.float32]) -> float:
    """Propagate white noise through the derivative, sd / (sigma^2 sqrt(8 pi)), and the average along the ribbon."""
    # neighbors along the ribbon share the smoothing: they average as if spread by both
    spread = math.sqrt(2 * SMOOTHING**2 + _ALONG**2 * 2)
    along = math.sqrt(math.sqrt(2.0) * SMOOTHING / spread)
    return max(noise_of(brightness) / (SMOOTHING**2 * math.sqrt(8 * math.pi)) * along, 1e-6)


@compiled
def _average_along(
    slope: Image,
    cos: float,
    sin: float,
    steps: npt.NDArray[np.int64],
    weights: npt.NDArray[np.float32],
    out: Image,
) -> None:
    """Average along a line through each pixel; what lies outside counts as the nearest pixel."""
    rows, columns = slope.shape
    for row in range(rows):
        for column in range(columns):
            total = np.float32(0.0)
            for i in range(len(steps)):
                y = min(max(row + steps[i] * sin, 0.0), rows - 1.001)
                x = min(max(column + steps[i] * cos, 0.0), columns - 1.001)
                r, c = int(y), int(x)
                v, u = np.float32(y - r), np.float32(x - c)
                upper = slope[r, c] + u * (slope[r, c + 1] - slope[r, c])
                lower = slope[r + 1, c] + u * (slope[r + 1, c + 1] - slope[r + 1, c])
                total += weights[i] * (upper + v * (lower - upper))
            out[row, column] = total
