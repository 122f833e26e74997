"""The search for a twin: aim by a model, pack the fibers so, take the best seed, look at its flow, and aim again.

What a model makes of a mat's flow is off by as much as the model is; where the flow is solved, the ratio of the solved
pressure drop to the model's corrects the next aim, which lies close to the last, so that two or three solutions do.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from pipeline.analytics.models.growth import predictor
from pipeline.analytics.settings import FlowSettings
from pipeline.case import Case, validate
from pipeline.design.history import History, history
from pipeline.design.packing import Place
from pipeline.design.targets import Target
from pipeline.design.tune import OutOfReach, tune
from pipeline.mat.diameters import draw_diameters
from pipeline.mat.generate import generate
from pipeline.mat.settings import Stop
from pipeline.nouns.arrays import Floats
from pipeline.progress import Progress, silent
from pipeline.twin.case_file import Choice, case_text
from pipeline.twin.compromise import Medium, nearest, values_of
from pipeline.twin.fibers import FiberLaws
from pipeline.twin.measurement import Measurement
from pipeline.twin.settings import SIZES, MeasuredFilter

FIRST_SEED = 1
_DRAWN = 50_000
"""Diameters that stand for their law: their mean square is good to half a percent."""
_AIMS = 4
"""Solutions of the flow at most."""
_REACHES = 3
"""How often the range of solidities that fibers reach is corrected."""
_START = 0.15, 0.0
"""Relaxation slope and spacing where a search starts."""
_SEEDS = 64
"""Seeds whose mats are looked at, at most; no more of them once one is off the aim by no more tolerances than this."""
_ENOUGH = 0.4
_AROUND = 1.3
"""A mat's own stop is looked for up to this many times the mean one, and down to one over it."""

Solver = Callable[[Case], float]
"""Solves the flow through a case's mat and gives its pressure drop [Pa]."""


@dataclass(frozen=True, slots=True)
class Twin:
    """The mat that comes nearest to what was measured.

    Parameters
    ----------
    choice : Choice
    fibers : FiberLaws
    flow : FlowSettings
    side : float [m]
    contact : str
    measured : dict of str to Measurement
        Of ``fiber_diameter`` (the mean) and what else was measured [SI].
    values : dict of str to float
        Of the mat itself [SI], also what was not measured.
    spread : dict of str to float
        Standard deviation of these over the seeds [SI]: how far chance moves a mat of this size.
    alone : dict of str to float
        Where not all that was measured goes together: what each quantity would have to be for all others to be met.
    reach : tuple of 2 float
        Least and largest solidity that these fibers were found to reach; 0 and 1 where they were not asked for more.
    drop_by : str
        What told the pressure drop: a model's name, or ``solve``.
    count : int
        Fibers.
    """

    choice: Choice
    fibers: FiberLaws
    flow: FlowSettings
    side: float
    contact: str
    measured: dict[str, Measurement]
    values: dict[str, float]
    spread: dict[str, float]
    alone: dict[str, float]
    reach: tuple[float, float]
    drop_by: str
    count: int

    @property
    def misses(self) -> dict[str, float]:
        """By how many tolerances each quantity is off."""
        return {name: each.miss(self.values[name]) for name, each in self.measured.items()}

    @property
    def unmatched(self) -> tuple[str, ...]:
        """What is not within its tolerance."""
        return tuple(name for name, miss in self.misses.items() if abs(miss) > 1.0)

    @property
    def worst(self) -> float:
        """Largest miss in tolerances; what is at most 1 is matched."""
        return max(abs(miss) for miss in self.misses.values())

    def text(self, head: str, picture: str | None = None) -> str:
        """Write its case file with a comment at the top, and the path of the micrograph from the file's folder."""
        solved = "pressure_drop" in self.measured
        return case_text(self.fibers, self.side, self.contact, self.flow, self.choice, solved, head, picture)


def match(given: MeasuredFilter, fibers: FiberLaws, solver: Solver | None = None, progress: Progress = silent) -> Twin:
    """Find the mat that has what was measured, or comes nearest.

    Parameters
    ----------
    given : MeasuredFilter
    fibers : FiberLaws
    solver : callable, optional
        Solves the flow of a case; without it the pressure drop is the model's.
    progress : Progress

    Returns
    -------
    Twin

    Raises
    ------
    CaseError
        If a mat of this thickness takes more fibers than a mat may have.
    StageError
        If the flow cannot be solved.
    """
    measured = {"fiber_diameter": fibers.mean}
    for name in SIZES:
        value = given.drop if name == "pressure_drop" else getattr(given, name)
        if value is not None:
            measured[name] = value
    search = _Search(given, fibers, measured, progress)
    best = search.aimed()
    if solver is None:
        return best
    solved: list[Twin] = []
    for number in range(1, _AIMS + 1):
        progress(f"solution {number} of at most {_AIMS}")
        drop = solver(search.case(best.choice))
        solved.append(_with_drop(best, drop))
        if solved[-1].worst <= 1.0:
            break
        # mats of other seeds are off the model by other ratios: this one stays
        search.correct(drop / best.values["pressure_drop"], best.choice.seed)
        before, best = best.choice, search.aimed()
        if best.choice == before:
            break
    return min(solved, key=lambda twin: twin.worst)


def _with_drop(twin: Twin, drop: float) -> Twin:
    return replace(twin, values={**twin.values, "pressure_drop": drop}, drop_by="solve")


class _Search:
    """One aim after the other, with what the last one taught."""

    def __init__(
        self, given: MeasuredFilter, fibers: FiberLaws, measured: Mapping[str, Measurement], progress: Progress
    ) -> None:
        self.given, self.fibers, self.measured, self.progress = given, fibers, dict(measured), progress
        self.flow = given.flow()
        self.side = given.side or fibers.side
        drawn = draw_diameters(fibers.diameters, _DRAWN, np.random.default_rng(0))
        self.mean, self.effective = float(drawn.mean()), float(np.sqrt(np.mean(drawn**2)))
        model = predictor(Stop(pressure_drop=1.0), self.flow)
        assert model is not None
        self.model = model
        self.factor = 1.0
        self.reach = (0.0, 1.0)
        self.seeds = tuple(range(FIRST_SEED, FIRST_SEED + given.seeds))
        self.seed: int | None = None

    def correct(self, factor: float, seed: int) -> None:
        """Take the model's drop times a factor from now on, and mats of one seed only."""
        self.factor *= factor
        self.seed = seed

    def case(self, choice: Choice) -> Case:
        """Give the case of a mat, as its file will have it."""
        solved = self.given.drop is not None
        text = case_text(self.fibers, self.side, self.given.contact, self.flow, choice, solved, "a step of a search")
        return validate(tomllib.loads(text), "the twin")

    def drop(self, medium: Medium) -> float:
        """Give the pressure drop of a medium by the model [Pa]."""
        return self.factor * self.model(medium.solidity, medium.thickness, medium.scale * self.effective)

    def values(self, grown: History, fiber: int) -> dict[str, float]:
        """Give all quantities of a mat as it was after the fiber of this index."""
        solidity, thickness = float(grown.solidity[fiber]), float(grown.thickness[fiber])
        found = {
            "fiber_diameter": float(grown.mean_diameter[fiber]),
            "solidity": solidity,
            "thickness": thickness,
            "pressure_drop": self.factor * self.model(solidity, thickness, float(grown.diameter[fiber])),
        }
        if self.given.fiber_density is not None:
            found["basis_weight"] = self.given.fiber_density * solidity * thickness
        return found

    def aimed(self) -> Twin:
        """Find the mat nearest to what was measured, by the model."""
        place: Place | None = None
        for _ in range(_REACHES):
            low, high = max(self.reach[0], 1e-3), min(self.reach[1], 0.9)
            medium, alone = nearest(self.measured, self.given.fiber_density, self.drop, (low, high))
            self.progress(f"aim at solidity {medium.solidity:.2%}, thickness {medium.thickness * 1e6:.4g} um")
            found = self._packed(medium, place)
            if isinstance(found, Choice):
                return self._chosen(medium, found, alone)
            # these fibers do not get there: the next aim stays within what they reach
            value, place = found
            self.reach = (value, self.reach[1]) if value > medium.solidity else (self.reach[0], value)
        raise AssertionError("a place that was found is packed at once")

    def _packed(self, medium: Medium, place: Place | None) -> Choice | tuple[float, Place]:
        """Find where fibers lie as densely and how many it takes; or how densely they come to lie at most or least."""
        start = Choice(medium.scale, _START if place is None else place, 2.0, FIRST_SEED)
        targets = (Target("thickness", medium.thickness), Target("solidity", medium.solidity))
        case = self.case(start)
        try:
            tuned = tune(case, targets if place is None else targets[:1], len(self.seeds), progress=self.progress)
        except OutOfReach as problem:
            return problem.value, problem.place
        return Choice(medium.scale, (tuned.relaxation_slope, tuned.spacing), tuned.coverage, FIRST_SEED)

    def _chosen(self, medium: Medium, packed: Choice, alone: dict[str, float]) -> Twin:
        """Take the seed and the last fiber with which a mat comes nearest to the aim."""
        aim = values_of(medium, self.mean, self.given.fiber_density, self.drop)
        grown = {seed: self._grown(packed, seed) for seed in self.seeds}
        if self.seed is None:
            near = [self._nearest(grown[seed], packed, aim) for seed in self.seeds]
            off, fiber, seed = min((*each, seed) for each, seed in zip(near, self.seeds, strict=True))
            # chance may keep all of them from an aim that others meet
            for further in range(self.seeds[-1] + 1, FIRST_SEED + _SEEDS):
                if off <= _ENOUGH:
                    break
                mat = self._grown(packed, further)
                there, last = self._nearest(mat, packed, aim)
                if there < off:
                    off, fiber, seed, grown[further] = there, last, further, mat
        else:
            seed = self.seed
            grown[seed] = self._grown(packed, seed)
            _, fiber = self._nearest(grown[seed], packed, aim)
        stop = _between(grown[seed].coverage, fiber)
        ends = [self.values(grown[each], grown[each].until(stop)) for each in self.seeds]
        values = self.values(grown[seed], fiber)
        return Twin(
            choice=Choice(packed.scale, packed.place, stop, seed),
            fibers=self.fibers,
            flow=self.flow,
            side=self.side,
            contact=self.given.contact,
            measured=self.measured,
            values=values,
            spread={name: float(np.std([end[name] for end in ends], ddof=1)) for name in values},
            alone=alone,
            reach=self.reach,
            drop_by=self.flow.pressure_model,
            count=fiber + 1,
        )

    def _nearest(self, mat: History, packed: Choice, aim: Mapping[str, float]) -> tuple[float, int]:
        """Give how near a growing mat comes to the aim, in tolerances, and with which fiber."""

        def off(fiber: int) -> float:
            values = self.values(mat, fiber)
            return max(abs(values[name] - aim[name]) / each.tolerance for name, each in self.measured.items())

        return min((off(fiber), fiber) for fiber in range(mat.until(packed.coverage / _AROUND), len(mat.coverage)))

    def _grown(self, packed: Choice, seed: int) -> History:
        further = Choice(packed.scale, packed.place, _AROUND * packed.coverage, seed)
        return history(generate(self.case(further).mat))


def _between(coverage: Floats, fiber: int) -> float:
    """Give a coverage of few digits that this fiber is the first to reach."""
    low, high = (float(coverage[fiber - 1]) if fiber else 0.0), float(coverage[fiber])
    for digits in range(3, 17):
        middle = float(f"{0.5 * (low + high):.{digits}g}")
        if low < middle <= high:
            return middle
    return high
