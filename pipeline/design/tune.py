"""Find relaxation slope, spacing and coverage of the mat whose measures a filter has.

A search over one number at a time: at each slope and spacing, mats of several seeds are grown, and the coverage is
read off their mean growth; slope and spacing are then moved along one way from loose to tight (`packing`) until the
second target is met. All steps use the same seeds, so chance does not come between two of them.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from pipeline.case import Case
from pipeline.design.packing import Place, between, stretches
from pipeline.design.search import Search, scale
from pipeline.design.targets import QUANTITIES, Target, readable
from pipeline.errors import CaseError
from pipeline.mat.settings import LayeredSettings
from pipeline.progress import Progress, silent

_STEPS_AWAY = 3

# the first of these that is asked for is met by the number of fibers, the other one by slope and spacing
_BY_AMOUNT = ("coverage", "count", "thickness", "pressure_drop", "efficiency")


class OutOfReach(CaseError):  # noqa: N818 (it names what is the case, as StopIteration does)
    """A second target that no slope and spacing meets.

    Parameters
    ----------
    message : str
    value : float
        Where it comes closest [SI].
    place : tuple of float
        Relaxation slope [-] and spacing [m] there.
    """

    def __init__(self, message: str, value: float, place: Place) -> None:
        super().__init__(message)
        self.value, self.place = value, place


@dataclass(frozen=True, slots=True)
class Spread:
    """Mean and standard deviation of a quantity over the seeds [SI]; the deviation is that of one mat."""

    mean: float
    std: float


@dataclass(frozen=True, slots=True)
class Tuned:
    """A mat that meets its targets on average.

    Parameters
    ----------
    relaxation_slope : float [-]
    spacing : float [m]
    coverage : float [-]
        The stop.
    seed : int
        The one whose mat comes closest to all targets.
    seeds : tuple of int
        Those that were grown.
    targets : tuple of Target
    measured : dict of str to Spread
        Every quantity of `QUANTITIES`, and ``count``, over the seeds.
    closest : dict of str to float
        The same of the mat of `seed`.
    """

    relaxation_slope: float
    spacing: float
    coverage: float
    seed: int
    seeds: tuple[int, ...]
    targets: tuple[Target, ...]
    measured: dict[str, Spread]
    closest: dict[str, float]

    def toml(self) -> str:
        """Write the keys that were found as lines for a case file."""
        return (
            "[mat]\n"
            f"relaxation_slope = {self.relaxation_slope:.4g}\n"
            f'spacing = "{readable("spacing", self.spacing)}"\n'
            f"seed = {self.seed}\n\n"
            "[mat.stop]\n"
            f"coverage = {self.coverage:.4g}\n"
        )


def tune(
    case: Case,
    targets: tuple[Target, ...],
    seeds: int = 8,
    keep: frozenset[str] = frozenset(),
    progress: Progress = silent,
) -> Tuned:
    """Find the slope, the spacing and the coverage with which layered mats meet targets on average.

    Parameters
    ----------
    case : Case
        With a layered mat. One target leaves a freedom: solidity is then met at the case's own stop, any other
        quantity with the case's own slope and spacing.
    targets : tuple of Target
        One or two.
    seeds : int
        How many mats each step looks at, from the case's seed on; 2 or more.
    keep : frozenset of str
        ``relaxation_slope`` or ``spacing``: what stays as the case has it. Without it, spacing stays as long as the
        slope will do.
    progress : Progress

    Returns
    -------
    Tuned

    Raises
    ------
    CaseError
        If the mat is not layered, or a target is out of reach; the message says what is within reach. Where the first
        target can be met but not the second, it is an `OutOfReach`.
    """
    settings = case.mat
    if not isinstance(settings, LayeredSettings):
        raise CaseError(
            f'only a mat of generator = "layered" can be tuned, not of "{settings.generator}": '
            "the thickness and the solidity of the others are settings of their own"
        )
    if seeds < 2:
        raise CaseError(f"--seeds {seeds}: a spread takes two mats or more")
    amount, other = _roles(settings, targets)
    search = Search(settings, case.flow, seeds, amount, progress)
    place = (settings.relaxation_slope, settings.spacing)
    if other is not None:
        place = _solve(search, settings, keep, other)
    return _finished(search, place, targets)


def _roles(settings: LayeredSettings, targets: tuple[Target, ...]) -> tuple[Target, Target | None]:
    """Tell which target the number of fibers meets, and which one slope and spacing."""
    ordered = sorted(targets, key=lambda target: (*_BY_AMOUNT, "solidity").index(target.quantity))
    if len(ordered) == 2:
        return ordered[0], ordered[1]
    if ordered[0].quantity != "solidity":
        return ordered[0], None
    stop = settings.stop
    if stop.quantity == "solidity":
        raise CaseError(
            "the case stops its mat at a solidity, so a target solidity does not say how much mat there shall be; "
            'add another, like --target thickness="50 um"'
        )
    return Target(stop.quantity, stop.target), ordered[0]


def _solve(search: Search, settings: LayeredSettings, keep: frozenset[str], target: Target) -> Place:
    """Find the place where the target is met: scan each stretch for a change of sign, then close in on it."""
    seen: list[tuple[float, float, Place]] = []
    for stretch in stretches(settings, keep):
        before: tuple[Place, float] | None = None
        away = 0
        for place in stretch:
            value, miss = search.miss(place, target)
            if math.isnan(value):
                before = None
                continue
            seen.append((abs(miss), value, place))
            if miss == 0.0:
                return place
            if before is not None and (before[1] < 0.0) != (miss < 0.0):
                return _close_in(lambda spot: search.miss(spot, target)[1], before[0], place)
            # mats with clear contact get looser again at the steepest slopes, so one step away proves nothing yet
            away = away + 1 if before is not None and abs(miss) >= abs(before[1]) else 0
            if away == _STEPS_AWAY:
                break
            before = (place, miss)
    if not seen:
        raise CaseError(f"{_amount_out_of_reach(search)}, at any slope and spacing")
    raise _out_of_reach(search, target, *min(seen)[1:])


def _close_in(miss: Callable[[Place], float], first: Place, second: Place) -> Place:
    share = brentq(lambda share: miss(between(first, second, share)), 0.0, 1.0, xtol=1e-4, maxiter=40, disp=False)
    return between(first, second, float(share))


def _out_of_reach(search: Search, target: Target, value: float, place: Place) -> OutOfReach:
    slope, spacing = place
    return OutOfReach(
        f"{target} is out of reach together with {search.amount}: the closest that these fibers come, on average over "
        f"{len(search.seeds)} mats, is {readable(target.quantity, value)}, at relaxation slope {slope:.4g} and spacing "
        f"{readable('spacing', spacing)}; ask for that, or change mat.fiber_diameter",
        value,
        place,
    )


def _amount_out_of_reach(search: Search, reached: float | None = None) -> str:
    most = f"mat.max_fibers = {search.settings.max_fibers} fibers"
    end = "" if reached is None else f": they give {readable(search.amount.quantity, reached)}"
    return f"{search.amount} is out of reach of {most}{end}; raise mat.max_fibers, or lower mat.side"


def _finished(search: Search, place: Place, targets: tuple[Target, ...]) -> Tuned:
    grown, coverage = search.look(place)
    if coverage is None:
        raise CaseError(_amount_out_of_reach(search, search.mean(search.amount.quantity, grown, search.most)))
    # grown again with the stop as it will stand in the case file: what is reported is what the case will give
    ends = search.grow(place, coverage, search.seeds)
    names = (*QUANTITIES, "count")
    values = {name: [one.value(name, len(one.coverage) - 1, search.flow) for one in ends] for name in names}
    misses = [
        sum(
            math.log(scale(target.quantity, values[target.quantity][k]) / scale(target.quantity, target.value)) ** 2
            for target in targets
        )
        for k in range(len(ends))
    ]
    best = int(np.argmin(misses))
    return Tuned(
        relaxation_slope=place[0],
        spacing=place[1],
        coverage=coverage,
        seed=search.seeds[best],
        seeds=search.seeds,
        targets=targets,
        measured={name: Spread(float(np.mean(each)), float(np.std(each, ddof=1))) for name, each in values.items()},
        closest={name: each[best] for name, each in values.items()},
    )
