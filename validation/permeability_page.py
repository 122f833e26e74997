"""The page on the permeability of layered mats: fits, tables and plot of the data that the studies left."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import statistics
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from pipeline.analytics.formulas.slip import kuwabara_slip, slip_length
from pipeline.analytics.models.pressure_models import pressure_model
from pipeline.analytics.tables.plots import save_figure
from pipeline.study.summary import estimate
from validation.permeability_data import DATA, ROOT, SLIP_DATA, STUDIES, Measured, Slipping
from validation.records import read_records
from validation.tables import filled, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE = ROOT / "docs" / "permeability.md"
PICTURE = ROOT / "docs" / "gallery" / "permeability.svg"
FEWEST = 4
"""Mats that a fit and its scatter take."""
PLACES = (0.03, 0.05, 0.1, 0.15, 0.2)
"""Solidities at which the fit and the models are told."""
_MODELS = ("davies", "jackson_james", "spielman_goren_layers", "kuwabara", "happel")
_OF_SIZES = "clear", 0.286
"""Contact and spacing in diameters of the mats that were drawn in plans of several sides and at several thicknesses."""

Row = TypeVar("Row")


@dataclass(frozen=True, slots=True)
class Fit:
    """Resistance of mats by their solidity: 4 a^2 / k = factor x solidity^power x exp(growth x solidity).

    The exponential is what dense mats have beyond a power of their solidity, as in fits since Davies'.

    Parameters
    ----------
    factor, power, growth : float [-]
    scatter : float [-]
        Standard deviation of the logarithm of a mat's resistance about the fit.
    low, high : float [-]
        Solidities of the mats that were fitted.
    mats : int
    """

    factor: float
    power: float
    growth: float
    scatter: float
    low: float
    high: float
    mats: int

    def resistance(self, solidity: float) -> float:
        """4 a^2 / k."""
        return float(self.factor * solidity**self.power * math.exp(self.growth * solidity))

    def over(self, mat: Measured) -> float:
        """Give a mat's resistance over that of the fit."""
        return 4.0 / mat.permeability / self.resistance(mat.solidity)


def fit(rows: Sequence[Measured]) -> Fit:
    """Fit the resistance without slip."""
    solidity = np.array([each.solidity for each in rows])
    resistance = np.log([4.0 / each.permeability for each in rows])
    known = np.column_stack([np.ones(len(rows)), np.log(solidity), solidity])
    found = np.linalg.lstsq(known, resistance, rcond=None)[0]
    scatter = float(np.sqrt(np.sum((resistance - known @ found) ** 2) / (len(rows) - known.shape[1])))
    offset, power, growth = found.tolist()
    return Fit(math.exp(offset), power, growth, scatter, float(solidity.min()), float(solidity.max()), len(rows))


@dataclass(frozen=True, slots=True)
class SlipFit:
    """By how much slip lets more through: gain = factor x Kn^knudsen x solidity^solidity.

    Parameters
    ----------
    factor, knudsen, solidity : float [-]
    scatter : float [-]
        Standard deviation of the logarithm of a gain about the fit.
    """

    factor: float
    knudsen: float
    solidity: float
    scatter: float


def fit_slip(rows: Sequence[Slipping]) -> SlipFit:
    """Fit the gains of permeability by slip."""
    known = np.array([[1.0, math.log(each.knudsen), math.log(each.solidity)] for each in rows])
    gains = np.log([each.gain for each in rows])
    powers = np.linalg.lstsq(known, gains, rcond=None)[0]
    scatter = float(np.sqrt(np.sum((gains - known @ powers) ** 2) / (len(rows) - 3)))
    return SlipFit(math.exp(powers[0]), float(powers[1]), float(powers[2]), scatter)


def grouped(rows: Iterable[Row], key: Callable[[Row], Hashable]) -> list[list[Row]]:
    """Group rows of one key, in the order of their first ones."""
    groups: dict[Hashable, list[Row]] = {}
    for each in rows:
        groups.setdefault(key(each), []).append(each)
    return list(groups.values())


def kinds(rows: Sequence[Measured]) -> list[list[Measured]]:
    """Group mats that differ by their seed only, from loose to dense."""
    groups = grouped(
        rows, lambda each: (round(each.side, 3), each.coverage, each.slope, each.contact, round(each.spacing, 3))
    )
    return sorted(groups, key=lambda group: statistics.fmean(each.solidity for each in group))


def of_sizes(rows: Sequence[Measured]) -> list[list[Measured]]:
    """Group the mats of the kind that was drawn in several sizes, by side, then by coverage."""
    own = [each for each in rows if (each.contact, round(each.spacing, 3)) == _OF_SIZES]
    return sorted(kinds(own), key=lambda group: (group[0].coverage, group[0].side))


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Give the mean and the half width of its 95 % confidence interval (Student's t)."""
    found = estimate(values)
    return found.mean, found.half_width


def _contact(mat: Measured | Slipping) -> str:
    return mat.contact + (f", {mat.spacing:.2g} d" if mat.spacing else "")


def _told(values: Sequence[float], form: str, unit: str = "") -> str:
    """Give a mean with its interval, where there are several values."""
    mean, half = interval(values)
    return f"{mean:{form}}" + (f" ± {half:{form}}" if len(values) > 1 else "") + unit


def kinds_table(rows: Sequence[Measured], found: Fit) -> str:
    """Permeability by kind of mat, with 95 % intervals over seeds."""
    lines = []
    for group in kinds(rows):
        first = group[0]
        mean, half = interval([each.permeability for each in group])
        gains = [100.0 * (each.permeability_slip / each.permeability - 1.0) for each in group]
        lines.append(
            [
                _contact(first),
                f"{first.slope:g}",
                str(len(group)),
                _told([100.0 * each.solidity for each in group], ".1f", " %"),
                f"{mean:.3g}" + (f" ± {100.0 * half / mean:.0f} %" if len(group) > 1 else ""),
                _told([found.over(each) for each in group], ".2f"),
                f"{statistics.fmean(gains):+.1f} % (Kn {first.knudsen:.3f})",
            ]
        )
    head = ["contact", "slope", "mats", "solidity", "k/a2, no slip", "resistance over the fit", "k with slip"]
    return table(head, lines)


def sizes_table(rows: Sequence[Measured], found: Fit) -> str:
    """Show where the mean of mats lies, and how far one scatters about it, by their side and coverage."""
    lines = []
    for group in of_sizes(rows):
        if len(group) < 2:
            continue
        first = group[0]
        ratios = [found.over(each) for each in group]
        k = [each.permeability for each in group]
        lines.append(
            [
                f"{first.side:.3g} d",
                f"{first.coverage:g}",
                f"{statistics.fmean(each.thickness for each in group):.0f} d",
                str(len(group)),
                _told([100.0 * each.solidity for each in group], ".1f", " %"),
                _told(k, ".2f"),
                f"{100.0 * statistics.stdev(k) / statistics.fmean(k):.0f} %",
                _told(ratios, ".2f"),
                f"{100.0 * statistics.stdev(ratios) / statistics.fmean(ratios):.0f} %",
            ]
        )
    head = [
        "side", "coverage", "thickness", "mats", "solidity", "k/a2, no slip", "one mat scatters by",
        "resistance over the fit", "one mat scatters by",
    ]  # fmt: skip
    return table(head, lines)


def slip_table(rows: Sequence[Slipping]) -> str:
    """By how much slip lets more through, by kind of mat and Knudsen number, and in Kuwabara's cell."""
    numbers = sorted({each.knudsen for each in rows})
    groups = grouped(rows, lambda each: (each.slope, each.contact, round(each.spacing, 3)))
    lines = []
    for group in sorted(groups, key=lambda group: statistics.fmean(each.solidity for each in group)):
        first, solidity = group[0], statistics.fmean(each.solidity for each in group)
        cells = []
        for kn in numbers:
            gains = [100.0 * each.gain for each in group if each.knudsen == kn]
            cell = 100.0 * (kuwabara_slip(solidity, 0.0) / kuwabara_slip(solidity, slip_length(kn)) - 1.0)
            spread = f" to {max(gains):+.1f}" if len(gains) > 1 else ""
            cells.append(f"{min(gains):+.1f}{spread} % ({cell:+.1f} %)")
        mats = len({each.seed for each in group})
        lines.append([_contact(first), f"{first.slope:g}", str(mats), f"{100.0 * solidity:.1f} %", *cells])
    return table(["contact", "slope", "mats", "solidity", *(f"Kn {kn:g}" for kn in numbers)], lines)


def models_table(rows: Sequence[Measured], found: Fit) -> str:
    """Show what models say of the same solidities, over the fit."""
    places = [s for s in PLACES if 0.85 * found.low <= s <= 1.05 * found.high]
    lines = []
    for title, resistance in resistances().items():
        ratios = [resistance(s) / found.resistance(s) for s in places]
        own = [math.log(4.0 / each.permeability / resistance(each.solidity)) for each in rows]
        bias, scatter = math.exp(statistics.fmean(own)), statistics.stdev(own)
        lines.append([title, *(f"{ratio:.2f}" for ratio in ratios), f"{bias:.2f}", f"{100.0 * scatter:.0f} %"])
    head = ["model", *(f"over the fit at {s:g}" for s in places), "mats over it", "scatter about it"]
    return table(head, lines)


def resistances() -> dict[str, Callable[[float], float]]:
    """4 a^2 / k of models and of published fits to random media, without slip."""

    def of_model(name: str) -> Callable[[float], float]:
        return lambda solidity: float(pressure_model(name).coefficient(solidity, 0.0))

    found = {pressure_model(name).title: of_model(name) for name in _MODELS}
    # Nabovati, Llewellin & Sousa, Composites A 40, 860 (2009): k/d^2 fitted to lattice Boltzmann flows in random fibers
    found["Nabovati et al. (2009)"] = lambda s: 1.0 / (0.491 / 4.0 * (math.sqrt(0.9257 / s) - 1.0) ** 2.31)
    # Koponen et al., Phys. Rev. Lett. 80, 716 (1998): layered random webs
    found["Koponen et al. (1998)"] = lambda s: 4.0 / (5.55 / (math.exp(10.1 * s) - 1.0))
    return found


def law(rows: Sequence[Measured], found: Fit) -> str:
    """Say the fit, its scatter, and its interval: seeds are fitted one by one, since kinds share their plans."""
    by_seed = [fit(group) for group in grouped(rows, lambda each: each.seed) if len(group) >= FEWEST]
    text = (
        f"4 a²/k = {found.factor:.3g} φ^{found.power:.3g} exp({found.growth:.3g} φ), {found.mats} mats of "
        f"{100 * found.low:.1f} to {100 * found.high:.1f} %; one mat lies {100 * found.scatter:.0f} % about it "
        "(one standard deviation)."
    )
    if len(by_seed) < 2:
        return text
    places = [s for s in PLACES if 0.85 * found.low <= s <= 1.05 * found.high]
    known = []
    for s in places:
        _, half = interval([math.log(each.resistance(s)) for each in by_seed])
        known.append(f"{100.0 * half:.0f} % at {s:g}")
    return f"{text} Fitted seed by seed ({len(by_seed)}): resistance ± {', '.join(known)} (95 %)."


def slip_law(rows: Sequence[Slipping]) -> str:
    """Say the fit of the gains by slip."""
    kn = sorted({each.knudsen for each in rows})
    mats = len({(each.slope, each.contact, each.spacing, each.seed) for each in rows})
    if min(len(kn), mats) < 2:
        return "Too few mats or Knudsen numbers for a fit."
    found = fit_slip(rows)
    return (
        f"k(Kn) = k(0) (1 + {found.factor:.3g} Kn^{found.knudsen:.3g} φ^{found.solidity:.3g}), {mats} mats at Kn "
        f"{kn[0]:g} to {kn[-1]:g}; a gain lies {100.0 * found.scatter:.1f} % of itself about it."
    )


def figure(rows: Sequence[Measured], slipped: Sequence[Slipping], found: Fit) -> "Figure":
    """Plot k/a^2 over solidity with the models, the resistance of sizes over the fit, and the gains by slip."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    drawn = Figure(figsize=(15.0, 4.6), layout="constrained")
    left, middle, right = drawn.subplots(1, 3)
    solidities = np.geomspace(found.low, found.high, 60)
    for title, resistance in resistances().items():
        left.loglog(solidities, [4.0 / resistance(s) for s in solidities], linewidth=1.0, label=title)
    left.loglog(
        solidities, [4.0 / found.resistance(s) for s in solidities], "k-", linewidth=2.0, label="fit to the mats"
    )
    for contact, mark in (("clear", "o"), ("paper", "s")):
        own = [each for each in rows if each.contact == contact and each.study == STUDIES[0].stem]
        left.loglog(
            [each.solidity for each in own], [each.permeability for each in own], f"k{mark}", fillstyle="none",
            markersize=4, label=f"mats, contact {contact}",
        )  # fmt: skip
    ticks = [place for place in PLACES if found.low <= place <= found.high]
    left.set_xticks(ticks, [f"{place:g}" for place in ticks])
    left.set_xticks([], minor=True)
    left.set_xlabel("solidity of the mesh")
    left.set_ylabel("k/a2, without slip")
    left.grid(alpha=0.3, which="both")
    left.legend(fontsize="x-small")
    for group in of_sizes(rows):
        ratios = [found.over(each) for each in group]
        mean, half = interval(ratios)
        first = group[0]
        of_plan = first.coverage == 2.0
        # thinner and thicker mats beside those of their side
        at = first.side + (0.0 if of_plan else 0.3 * (first.coverage - 2.0))
        middle.plot([at] * len(ratios), ratios, ".", color="#999999")
        if len(ratios) > 1:
            middle.errorbar(at, mean, yerr=half, color="k" if of_plan else "C0", marker="o", capsize=3)
        if not of_plan:
            middle.annotate(f"coverage {first.coverage:g}", (at, mean), xytext=(5, 5), textcoords="offset points")
    middle.set_xlabel("side of the plan [diameters]")
    middle.set_ylabel("resistance over the fit")
    middle.grid(alpha=0.3)
    mats = grouped(slipped, lambda each: (each.slope, each.contact, round(each.spacing, 3), each.seed))
    shades = colormaps["viridis"](np.linspace(0.9, 0.0, max(len(mats), 1)))
    for mat, shade in zip(sorted(mats, key=lambda mat: mat[0].solidity), shades, strict=False):
        ordered = sorted(mat, key=lambda each: each.knudsen)
        right.plot([each.knudsen for each in ordered], [100.0 * each.gain for each in ordered], ".-", linewidth=0.8,
                   color=shade, label=f"{100.0 * ordered[0].solidity:.1f} %, seed {ordered[0].seed}")  # fmt: skip
    right.set_xlabel("Knudsen number")
    right.set_ylabel("k with slip over k without, less 1 [%]")
    right.grid(alpha=0.3)
    if slipped:
        right.legend(fontsize="xx-small", ncols=2, title="solidity")
    return drawn


def write_page() -> None:
    """Make the page's tables and its plot of the data."""
    rows, slipped = read_records(DATA, Measured), read_records(SLIP_DATA, Slipping)
    fitted = [each for each in rows if each.study == STUDIES[0].stem]
    found = fit(fitted)
    parts = {
        "mats": kinds_table(fitted, found),
        "fit": law(fitted, found),
        "sizes": sizes_table(rows, found),
        "slip": slip_table(slipped),
        "slip fit": slip_law(slipped),
        "models": models_table(fitted, found),
    }
    page = PAGE.read_text(encoding="utf-8")
    for name, content in parts.items():
        page = filled(page, name, content)
    PAGE.write_text(page, encoding="utf-8")
    save_figure(figure(rows, slipped, found), PICTURE)
