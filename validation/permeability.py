"""The permeability of layered random mats: from finished studies to a table, a fit, and a plot beside models.

``python -m validation.permeability RUNS`` does ``fibertwin study`` with each of ``cases/studies/permeability*.toml``
into a folder of RUNS, goes on where it was interrupted, and writes docs/data/permeability.csv, the tables of
docs/permeability.md and its plot; without RUNS it makes tables and plot of the data that are there.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import statistics
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pipeline.analytics.models.pressure_models import pressure_model
from pipeline.analytics.tables.plots import save_figure
from pipeline.line.places import MANIFEST
from pipeline.line.store import read_json
from pipeline.units import parse
from validation.records import read_records, write_records
from validation.tables import filled, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOT = Path(__file__).parents[1]
STUDIES = sorted((ROOT / "cases" / "studies").glob("permeability*.toml"))
DATA = ROOT / "docs" / "data" / "permeability.csv"
PAGE = ROOT / "docs" / "permeability.md"
PICTURE = ROOT / "docs" / "gallery" / "permeability.svg"
_MODELS = ("davies", "jackson_james", "spielman_goren_layers", "kuwabara", "happel")
_SLOPE = 0.15
_OF_SIDES = "clear", 0.286
"""Contact and spacing in diameters of the mats that were drawn in plans of several sides."""
_REPRESENTATIVE = 9.9  # sides in fiber diameters from which mats take part in the fit


@dataclass(frozen=True, slots=True)
class Measured:
    """One mat.

    Parameters
    ----------
    study : str
    side : float [-]
        Of the plan, in fiber diameters.
    slope : float [-]
        Relaxation slope.
    contact : str
    spacing : float [-]
        Least gap between fibers in diameters.
    seed : int
    solidity : float [-]
        Of the mesh.
    thickness : float [-]
        In fiber diameters.
    permeability : float [-]
        Without slip, over the squared fiber radius.
    knudsen : float [-]
        Mean free path over fiber radius.
    permeability_slip : float [-]
        With slip at that Knudsen number, over the squared fiber radius.
    """

    study: str
    side: float
    slope: float
    contact: str
    spacing: float
    seed: int
    solidity: float
    thickness: float
    permeability: float
    knudsen: float
    permeability_slip: float


def measured(folder: Path) -> Iterator[Measured]:
    """Read the finished runs of a study."""
    for path in sorted(folder.glob("results/*/result.json")):
        found = read_json(path)
        swept = tomllib.loads("\n".join(read_json(path.parent / MANIFEST)["set"]))["mat"]
        solve, compare, mat = found["solve"], found["compare"], found["mat"]
        diameter = compare["fiber_diameter"]
        slip = solve["permeability"] / (0.5 * diameter) ** 2
        yield Measured(
            study=folder.name,
            side=parse(swept["side"], "m") / diameter,
            slope=swept.get("relaxation_slope", _SLOPE),
            contact=swept["contact"],
            spacing=parse(swept["spacing"], "m") / diameter,
            seed=swept["seed"],
            solidity=compare["solidity"]["mesh"],
            thickness=mat["thickness"] / diameter,
            permeability=slip * solve["pressure_drop_slip"] / solve["pressure_drop_no_slip"],
            knudsen=compare["knudsen"],
            permeability_slip=slip,
        )


@dataclass(frozen=True, slots=True)
class Fit:
    """Resistance of mats as a power of their solidity: 4 a^2 / k = factor x solidity^power.

    Parameters
    ----------
    factor, power : float [-]
    scatter : float [-]
        Standard deviation of the logarithm of a mat's resistance about the fit.
    low, high : float [-]
        Solidities of the mats that were fitted.
    mats : int
    """

    factor: float
    power: float
    scatter: float
    low: float
    high: float
    mats: int


def fit(rows: Sequence[Measured]) -> Fit:
    """Fit the resistance without slip."""
    solidity = [each.solidity for each in rows]
    x, y = [math.log(s) for s in solidity], [math.log(4.0 / each.permeability) for each in rows]
    power, offset = statistics.linear_regression(x, y)
    rest = [value - offset - power * at for at, value in zip(x, y, strict=True)]
    scatter = math.sqrt(sum(value**2 for value in rest) / (len(rest) - 2))
    return Fit(math.exp(offset), power, scatter, min(solidity), max(solidity), len(rows))


def kinds(rows: Sequence[Measured]) -> list[list[Measured]]:
    """Group mats that differ by their seed only, from loose to dense."""
    groups: dict[tuple[str, float, float, str, float], list[Measured]] = {}
    for each in rows:
        key = (each.study, round(each.side, 3), each.slope, each.contact, round(each.spacing, 3))
        groups.setdefault(key, []).append(each)
    return sorted(groups.values(), key=lambda group: statistics.fmean(each.solidity for each in group))


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Give the mean and the half width of its 95 % confidence interval (Student's t)."""
    from scipy.stats import t

    mean = statistics.fmean(values)
    if len(values) < 2:
        return mean, math.nan
    return mean, float(t.ppf(0.975, len(values) - 1)) * statistics.stdev(values) / math.sqrt(len(values))


def kinds_table(rows: Sequence[Measured], found: Fit) -> str:
    """Permeability by kind of mat, with 95 % intervals over seeds."""
    lines = []
    for group in kinds(rows):
        first = group[0]
        solidity, _ = interval([100.0 * each.solidity for each in group])
        k, half = interval([each.permeability for each in group])
        ratio, ratio_half = interval(
            [4.0 / each.permeability / (found.factor * each.solidity**found.power) for each in group]
        )
        gain = statistics.fmean(each.permeability_slip / each.permeability - 1.0 for each in group)
        made = first.contact + (f", {first.spacing:.2g} d" if first.spacing else "")
        lines.append(
            [
                f"{first.side:.3g} d",
                f"{first.slope:g}",
                made,
                str(len(group)),
                f"{solidity:.1f} %",
                f"{k:.3g}" + (f" ± {half:.1g}" if len(group) > 1 else ""),
                f"{ratio:.2f}" + (f" ± {ratio_half:.2f}" if len(group) > 1 else ""),
                f"{100.0 * gain:+.1f} % (Kn {first.knudsen:.3f})",
            ]
        )
    head = ["side", "slope", "contact", "mats", "solidity", "k/a2, no slip", "resistance over the fit", "k with slip"]
    return table(head, lines)


def models_table(rows: Sequence[Measured], found: Fit) -> str:
    """Show what models say of the same solidities, over the fit."""
    places = [s for s in (0.03, 0.05, 0.1, 0.15, 0.2) if 0.95 * found.low <= s <= 1.05 * found.high]
    lines = []
    for title, resistance in resistances().items():
        ratios = [resistance(s) / (found.factor * s**found.power) for s in places]
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


def figure(rows: Sequence[Measured], found: Fit) -> "Figure":
    """Plot k/a^2 over solidity with the models, and over the side where plans of several were drawn."""
    from matplotlib.figure import Figure

    of_sides = kinds([each for each in rows if (each.contact, round(each.spacing, 3)) == _OF_SIDES])
    sides = len({round(group[0].side, 3) for group in of_sides})
    drawn = Figure(figsize=(11.0 if sides > 1 else 7.0, 4.6), layout="constrained")
    left, *others = drawn.subplots(1, 2 if sides > 1 else 1, squeeze=False)[0]
    solidities = np.geomspace(found.low, found.high, 60)
    for title, resistance in resistances().items():
        left.loglog(solidities, [4.0 / resistance(s) for s in solidities], linewidth=1.0, label=title)
    left.loglog(
        solidities, 4.0 / (found.factor * solidities**found.power), "k-", linewidth=2.0, label="fit to the mats"
    )
    for contact, mark in (("clear", "o"), ("paper", "s")):
        own = [each for each in rows if each.contact == contact and each.side >= _REPRESENTATIVE]
        left.loglog(
            [each.solidity for each in own], [each.permeability for each in own], f"k{mark}", fillstyle="none",
            markersize=5, label=f"mats, contact {contact}",
        )  # fmt: skip
    left.set_xlabel("solidity of the mesh")
    left.set_ylabel("k/a2, without slip")
    left.grid(alpha=0.3, which="both")
    left.legend(fontsize="x-small")
    for right in others:
        for group in of_sides:
            ratios = [4.0 / each.permeability / (found.factor * each.solidity**found.power) for each in group]
            mean, half = interval(ratios)
            right.plot([group[0].side] * len(ratios), ratios, ".", color="#999999")
            right.errorbar(group[0].side, mean, yerr=half, color="k", marker="o", capsize=3)
        right.set_xlabel("side of the plan [diameters]")
        right.set_ylabel("resistance over the fit")
        right.grid(alpha=0.3)
    return drawn


def main(folder: Path) -> None:
    """Run the studies, and write data, page and plot."""
    for study in STUDIES:
        place = folder / study.stem
        subprocess.run(
            [sys.executable, "-m", "pipeline.cli", "study", str(study), "--out", str(place), "--quiet"], check=True
        )
    write_records(DATA, [each for study in STUDIES for each in measured(folder / study.stem)])
    write_page()


def write_page() -> None:
    """Make the page's tables and its plot of the data."""
    rows = read_records(DATA, Measured)
    fitted = [each for each in rows if each.side >= _REPRESENTATIVE]
    found = fit(fitted)
    page = PAGE.read_text(encoding="utf-8")
    page = filled(page, "mats", kinds_table(rows, found))
    page = filled(page, "models", models_table(fitted, found))
    law = (
        f"4 a²/k = {found.factor:.3g} φ^{found.power:.3g}, {found.mats} mats of {100 * found.low:.1f} to "
        f"{100 * found.high:.1f} %; one mat lies {100 * found.scatter:.0f} % about it (one standard deviation)."
    )
    PAGE.write_text(filled(page, "fit", law), encoding="utf-8")
    save_figure(figure(rows, found), PICTURE)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        write_page()
