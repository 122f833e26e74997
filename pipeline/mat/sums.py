"""Running sums over the fibers of a growing mat, and whether they have reached the stop."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Callable
from dataclasses import dataclass

from pipeline.mat.settings import Stop
from pipeline.nouns.mat_measures import MatMeasures

Predict = Callable[[float, float, float], float]
"""Predicts the quantity of a stop from solidity [-], thickness [m] and mean fiber diameter [m]."""


@dataclass(slots=True)
class RunningSums:
    """Sums that make every stop's quantity available after each fiber at the same small cost.

    Parameters
    ----------
    face_area : float [m2]
    slab : float [m]
        Thickness of a slab that is given; 0 where the fibers make it.
    """

    face_area: float
    slab: float = 0.0
    count: int = 0
    plan_area: float = 0.0
    volume: float = 0.0
    diameters: float = 0.0
    top: float = 0.0

    def add(self, radius: float, plan_length: float, length: float, top: float) -> None:
        """Count one more fiber, whose axis reaches up to the height `top` [m]."""
        self.count += 1
        self.plan_area += 2.0 * radius * plan_length
        self.volume += math.pi * radius**2 * length
        self.diameters += 2.0 * radius
        self.top = max(self.top, top + radius)

    @property
    def thickness(self) -> float:
        """Height of the highest axis plus its radius, or the given slab's thickness [m]."""
        return self.slab or self.top

    @property
    def coverage(self) -> float:
        """Summed plan area over the face's area [-]."""
        return self.plan_area / self.face_area

    @property
    def solidity(self) -> float:
        """Summed cylinder volume over the slab's volume [-]."""
        return self.volume / (self.face_area * self.thickness)

    def value(self, stop: Stop, predict: Predict | None) -> float:
        """Give the stop's quantity as it stands [SI].

        Raises
        ------
        ValueError
            If a model has to predict it and `predict` is None.
        """
        if stop.predicted:
            if predict is None:
                raise ValueError(f"a stop by {stop.quantity} needs a model that predicts it")
            return predict(self.solidity, self.thickness, self.diameters / self.count)
        return float(getattr(self, stop.quantity))


@dataclass(frozen=True, slots=True)
class StopReport:
    """By how much the last fiber brought a mat beyond its stop [SI]; `relative` is that over the target [-]."""

    quantity: str
    target: float
    reached: float
    overshoot: float
    relative: float


def report_stop(stop: Stop, measures: MatMeasures, predict: Predict | None = None) -> StopReport:
    """Tell by how much a mat goes beyond its stop.

    Parameters
    ----------
    stop : Stop
    measures : MatMeasures
        Of the mat that the stop ended.
    predict : callable, optional
        As for `pipeline.mat.generate`.

    Returns
    -------
    StopReport

    Raises
    ------
    ValueError
        If a model has to predict the quantity and `predict` is None.
    """
    if stop.predicted:
        if predict is None:
            raise ValueError(f"a stop by {stop.quantity} needs a model that predicts it")
        reached = predict(measures.solidity, measures.thickness, measures.diameters.mean)
    else:
        reached = float(measures.fibers if stop.quantity == "count" else getattr(measures, stop.quantity))
    beyond = reached - stop.target
    return StopReport(stop.quantity, stop.target, reached, beyond, beyond / stop.target)
