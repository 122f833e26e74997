"""A micrograph: pixels of one color and the length that a pixel stands for."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.nouns.arrays import freeze, require


@dataclass(frozen=True, eq=False, slots=True)
class Micrograph:
    """A picture of fibers seen along the flow.

    Parameters
    ----------
    brightness : (rows, columns) array [-]
        From 0 to 1; the first row is the picture's upper edge.
    pixel : float [m]
        Edge of a pixel, above 0.
    origin : str
        Where the picture came from, for people to read.
    """

    brightness: npt.NDArray[np.float32]
    pixel: float
    origin: str

    def __post_init__(self) -> None:
        freeze(self, brightness=np.asarray(self.brightness, np.float32))
        require(self.brightness.ndim == 2, "a micrograph has rows and columns")
        require(min(self.brightness.shape) > 0, "a micrograph has pixels")
        require(bool(np.isfinite(self.brightness).all()), "a brightness is not finite")
        require(self.pixel > 0, "a pixel has a length")

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [m]."""
        rows, columns = self.brightness.shape
        return columns * self.pixel, rows * self.pixel
