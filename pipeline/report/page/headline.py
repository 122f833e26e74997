"""The number that a run was made for, with what is known of its interval."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

from pipeline.line.results import Results
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.convergence import ConvergedDrop
from pipeline.nouns.flow import Solution
from pipeline.report.page.converged import read_convergence

_TWO = 2.0  # standard deviations


@dataclass(frozen=True, slots=True)
class Headline:
    """The number that stands above everything else.

    Parameters
    ----------
    what : str
    value : float [Pa]
    low, high : float [Pa], optional
        Its interval; None where nothing is known of it.
    of : str
        What the interval holds, in a sentence; or why there is none.
    notes : tuple of str
        What else would move the number, a sentence each.
    """

    what: str
    value: float
    low: float | None
    high: float | None
    of: str
    notes: tuple[str, ...] = ()

    @property
    def number(self) -> str:
        """The value with its unit."""
        return f"{self.value:.3g} Pa"

    @property
    def interval(self) -> str:
        """The interval with its unit; empty where there is none."""
        return "" if self.low is None or self.high is None else f"{self.low:.3g} to {self.high:.3g} Pa"


def headline(content: Results) -> Headline | None:
    """Give the pressure drop: on several meshes, else solved on one, else by the models; None before any of them."""
    solution, comparison = content.get(Solution), content.get(Comparison)
    converged = read_convergence(content.folder)
    if converged is not None and solution is not None:
        return _converged(converged)
    if solution is not None:
        return _solved(solution)
    if comparison is not None:
        return _by_models(comparison)
    return None


def wall_of(fiber_wall: str) -> str:
    """Say what the air does on the fibers."""
    return {"slip": "with slip on the fibers", "no_slip": "without slip on the fibers"}[fiber_wall]


def _converged(found: ConvergedDrop) -> Headline:
    drop, parts = found.pressure_drop, found.contributions
    notes = []
    if parts.slip is not None:
        notes.append(f"Without slip it would be {parts.slip:+.0%}.")
    if parts.box is not None:
        notes.append(f"In a larger box it was {parts.box:+.0%}.")
    if parts.seed is not None:
        notes.append(f"Mats of {len(found.seeds)} seeds differ by {parts.seed:.0%} (standard deviation).")
    return Headline(
        f"pressure drop, {wall_of(found.fiber_wall)}", drop.value, drop.low, drop.high,
        "What three meshes leave open of this mat's number.", tuple(notes),
    )  # fmt: skip


def _solved(s: Solution) -> Headline:
    notes = []
    if s.pressure_drop_no_slip is not None and s.pressure_drop_slip is not None:
        other = s.pressure_drop_no_slip if s.fiber_wall == "slip" else s.pressure_drop_slip
        word = "Without" if s.fiber_wall == "slip" else "With"
        notes.append(f"{word} slip it is {other:.3g} Pa ({other / s.pressure_drop - 1.0:+.1%}).")
    spread = s.seed_spread
    if spread is not None:
        notes.append(f"Another seed of the same medium: ±{_TWO * spread:.0%}, two standard deviations of such mats.")
    what = f"pressure drop, {wall_of(s.fiber_wall)}"
    if s.mesh_error is None:
        of = "One mesh tells no interval; fibertwin converge solves on three and does."
        return Headline(what, s.pressure_drop, None, None, of, tuple(notes))
    mean, least, most = s.mesh_error
    # the number less its error, for the largest and the least error that meshes like this had; and the number itself,
    # since few mats tell
    low, *_, high = sorted((s.pressure_drop, s.pressure_drop / (1.0 + least), s.pressure_drop / (1.0 + most)))
    of = f"What such a mesh leaves: it was {mean:+.1%} off on other mats ({least:+.1%} to {most:+.1%})."
    return Headline(what, s.pressure_drop, low, high, of, tuple(notes))


def _by_models(c: Comparison) -> Headline | None:
    inside = [row.mesh for row in c.models.values() if math.isfinite(row.mesh) and not row.notes]
    if "davies" not in c.models or not math.isfinite(c.models["davies"].mesh):
        return None
    low, high = (min(inside), max(inside)) if inside else (None, None)
    of = f"The {len(inside)} models that are in their range." if inside else "No model is in its range."
    note = "The flow of this very mat is not solved; fibertwin solve does it."
    return Headline("pressure drop by Davies' fit to measurements", c.models["davies"].mesh, low, high, of, (note,))
