"""A mat's whole growth from one mat: what it was like after each of its fibers.

A mat that stops at a smaller coverage is the beginning of one that stops at a larger, so one growth answers for all
stops.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np

from pipeline.analytics.models.growth import predictor
from pipeline.analytics.settings import FlowSettings
from pipeline.mat.settings import Stop
from pipeline.nouns.arrays import Floats
from pipeline.nouns.fibers import Mat


@dataclass(frozen=True, eq=False, slots=True)
class History:
    """What a growing layered mat was like after each fiber.

    Parameters
    ----------
    coverage, solidity : (fibers,) array [-]
    thickness : (fibers,) array [m]
    diameter : (fibers,) array [m]
        The one that keeps length and volume.
    mean_diameter : (fibers,) array [m]
        Each fiber counted once.
    """

    coverage: Floats
    solidity: Floats
    thickness: Floats
    diameter: Floats
    mean_diameter: Floats

    def until(self, coverage: float) -> int:
        """Index of the fiber that ends a mat which stops at this coverage."""
        return min(int(np.searchsorted(self.coverage, coverage)), len(self.coverage) - 1)

    def value(self, quantity: str, fiber: int, flow: FlowSettings) -> float:
        """Give a quantity [SI] as it was after the fiber of this index; `quantity` is a target's or ``count``."""
        if quantity == "count":
            return fiber + 1.0
        if quantity in ("pressure_drop", "efficiency"):
            predict = predictor(Stop.model_validate({quantity: 0.5}), flow)
            assert predict is not None
            return predict(float(self.solidity[fiber]), float(self.thickness[fiber]), float(self.diameter[fiber]))
        return float(getattr(self, quantity)[fiber])


def history(mat: Mat) -> History:
    """Tell how a layered mat grew.

    Parameters
    ----------
    mat : Mat
        Its fibers in the order in which they were laid down.

    Returns
    -------
    History
    """
    start = mat.segment_starts()
    step = mat.nodes[start + 1] - mat.nodes[start]
    fiber = mat.segment_fibers()
    length = np.bincount(fiber, np.linalg.norm(step, axis=1), mat.fibers)
    plan = np.bincount(fiber, np.hypot(step[:, 0], step[:, 1]), mat.fibers)
    volume = np.cumsum(math.pi * mat.radius**2 * length)
    top = np.maximum.accumulate(np.maximum.reduceat(mat.nodes[:, 2], mat.first[:-1]) + mat.radius)
    return History(
        coverage=np.cumsum(2.0 * mat.radius * plan) / mat.slab.face_area,
        solidity=volume / (mat.slab.face_area * top),
        thickness=top,
        diameter=np.sqrt(4.0 * volume / (math.pi * np.cumsum(length))),
        mean_diameter=np.cumsum(2.0 * mat.radius) / np.arange(1, mat.fibers + 1),
    )
