"""Looking at the mats of one relaxation slope and spacing: how they are once there is enough of them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.analytics.settings import FlowSettings
from pipeline.design.history import History, history
from pipeline.design.packing import Place
from pipeline.design.targets import Target, readable
from pipeline.mat.generate import generate
from pipeline.mat.settings import LayeredSettings, Stop
from pipeline.progress import Progress

TOLERANCE = 1e-3
"""A target counts as met when the mean over the seeds is this close, relative: well below the spread of one mat."""


class Search:
    """Looks at mats of one slope and spacing at a time, and remembers them: growing is what takes the time.

    Parameters
    ----------
    settings : LayeredSettings
    flow : FlowSettings
    seeds : int
        How many mats each look grows, from the settings' seed on.
    amount : Target
        What the number of fibers has to meet.
    progress : Progress
    """

    def __init__(
        self, settings: LayeredSettings, flow: FlowSettings, seeds: int, amount: Target, progress: Progress
    ) -> None:
        self.settings, self.flow, self.amount, self.progress = settings, flow, amount, progress
        self.seeds = tuple(range(settings.seed, settings.seed + seeds))
        self.looked: dict[Place, tuple[list[History], float | None]] = {}
        # nearly the most that max_fibers allows, which a few fibers must not exceed by chance
        face = settings.side**2
        self.most = 0.95 * settings.max_fibers * settings.fiber_diameter.mean * settings.mean_length / face
        self.guess = min(amount.value if amount.quantity == "coverage" else 2.0, self.most)

    def grow(self, place: Place, coverage: float, seeds: tuple[int, ...]) -> list[History]:
        """Grow a mat of each of the seeds there, up to a coverage."""
        slope, spacing = place
        update = {"relaxation_slope": slope, "spacing": spacing, "stop": Stop(coverage=coverage)}
        grown = []
        for seed in seeds:
            mat = generate(self.settings.model_copy(update={**update, "seed": seed}))
            grown.append(history(mat))
        return grown

    def mean(self, quantity: str, grown: list[History], coverage: float) -> float:
        """Give the mean of a quantity over mats that stop at a coverage."""
        return float(np.mean([one.value(quantity, one.until(coverage), self.flow) for one in grown]))

    def look(self, place: Place) -> tuple[list[History], float | None]:
        """Grow mats there, and find the coverage at which they have their amount; None where they cannot."""
        if place not in self.looked:
            slope, spacing = place
            self.progress(f"look {len(self.looked) + 1}, slope {slope:.4g}, spacing {readable('spacing', spacing)}")
            self.looked[place] = self._look(place)
        return self.looked[place]

    def _look(self, place: Place) -> tuple[list[History], float | None]:
        wanted = self.amount.value
        coverage = self.guess
        # one mat finds out cheaply how far the others have to grow
        for seeds, step in ((self.seeds[:1], 2.0), (self.seeds, 1.2)):
            grown = self.grow(place, coverage, seeds)
            while self.mean(self.amount.quantity, grown, coverage) < wanted:
                if coverage >= self.most:
                    return grown, None
                coverage = min(step * coverage, self.most)
                grown = self.grow(place, coverage, seeds)
        low, high = 0.0, coverage
        while high - low > 1e-5 * high:
            middle = 0.5 * (low + high)
            enough = self.mean(self.amount.quantity, grown, middle) >= wanted
            low, high = (low, middle) if enough else (middle, high)
        # the next look starts a little beyond what this one needed
        self.guess = min(1.2 * high, self.most)
        return grown, float(f"{high:.4g}")

    def miss(self, place: Place, target: Target) -> tuple[float, float]:
        """Give the mean of the target's quantity there, and by how much its logarithm misses the target."""
        grown, coverage = self.look(place)
        if coverage is None:
            return math.nan, math.nan
        value = self.mean(target.quantity, grown, coverage)
        miss = math.log(scale(target.quantity, value) / scale(target.quantity, target.value))
        return value, 0.0 if abs(miss) < TOLERANCE else miss


def scale(quantity: str, value: float) -> float:
    """Give a quantity on a scale whose logarithm compares: efficiencies crowd below 1, depths of capture do not."""
    return -math.log1p(-value) if quantity == "efficiency" else value
