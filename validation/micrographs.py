"""Truth against measure: mats of known fibers, their pictures, and what `fibertwin measure` makes of them.

``python -m validation.micrographs`` prints the tables of docs/measuring.md; words behind it choose rows, by what their
names begin with. A fiber that was seen is told by the picture's own map of fibers, so that what the measure does to
diameters stands beside what chance does, which draws other fibers into the top layers than into the mat.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from pipeline.mat.generate import generate
from pipeline.mat.settings import Isotropic, LayeredSettings, Lognormal, Mixture, Part, Stop, VonMises
from pipeline.micrograph.laws import diameter_laws, orientation_law
from pipeline.micrograph.measure import Floats, Measured, measure
from pipeline.microscope.synthetic import Exposure, Seen, look_down, micrograph_of
from pipeline.nouns.fibers import Mat

UM = 1e-6
SIDE = 500
"""Pixels on a side of each picture."""
PICTURES = 2
"""Mats of a row."""


def exposure(edge: float = 1.0, blur: float = 1.0, noise: float = 0.05, depth: float = 5 * UM) -> Exposure:
    """Give an exposure: the typical one but for what is named."""
    return Exposure(depth, edge, blur, noise)


TYPICAL = exposure()


@dataclass(frozen=True, slots=True)
class Trial:
    """Pictures of several mats of one kind, measured together.

    Parameters
    ----------
    name : str
    median : float [pixel]
        Of the diameters; 1 um in the mat.
    geometric_std : float [-]
    exposure : Exposure
    """

    name: str
    median: float
    geometric_std: float = 1.3
    exposure: Exposure = TYPICAL


TRIALS = (
    *(Trial(f"{width} pixels", width) for width in (6, 8, 12, 20, 30)),
    Trial("6 pixels, narrow", 6, geometric_std=1.1),
    Trial("12 pixels, narrow", 12, geometric_std=1.1),
    Trial("12 pixels, wide", 12, geometric_std=1.6),
    *(Trial(f"{width} pixels, noise .1", width, exposure=exposure(noise=0.1)) for width in (8, 12)),
    Trial("12 pixels, noise .2", 12, exposure=exposure(noise=0.2)),
    Trial("12 pixels, blur 2", 12, exposure=exposure(blur=2.0)),
    Trial("12 pixels, bright rims", 12, exposure=exposure(edge=3.0)),
)
MIXTURES = tuple((ratio, width) for ratio in (3.0, 5.0) for width in (6, 8))
CONCENTRATIONS = (0.5, 2.0, 8.0)


def mats(diameter: Lognormal | Mixture, pixel: float, seeds: int, orientation: Isotropic | VonMises) -> Iterable[Mat]:
    """Grow the mats, each of the size of its picture."""
    for seed in range(seeds):
        yield generate(
            LayeredSettings(
                side=SIDE * pixel,
                fiber_diameter=diameter,
                relaxation_slope=0.15,
                orientation=orientation,
                seed=seed,
                stop=Stop(coverage=2.5),
            )
        )


@dataclass(frozen=True, eq=False, slots=True)
class Sample:
    """Fibers of several pictures.

    Parameters
    ----------
    drawn : (drawn,) array [m]
        Diameters of all fibers of the mats.
    true, seen : (fibers,) array [m]
        Diameter of each fiber that was seen: its own, and the measured one.
    angle : (fibers,) array [rad]
    length : (fibers,) array [m]
    """

    drawn: Floats
    true: Floats
    seen: Floats
    angle: Floats
    length: Floats


def sample(made: Iterable[Mat], pixel: float, taken: Exposure) -> Sample:
    """Measure the pictures of mats."""
    parts = []
    for mat in made:
        found = measure(micrograph_of(mat, pixel, taken))
        true = 2.0 * mat.radius[owners(found, look_down(mat, pixel))]
        parts.append((2.0 * mat.radius, true, found.diameter, found.angle, found.length))
    return Sample(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def owners(found: Measured, seen: Seen) -> "np.ndarray[tuple[int], np.dtype[np.int64]]":
    """Tell which of a mat's fibers each measured one is: that which most of its middle line lies on."""
    rows, columns = seen.fiber.shape
    which = []
    for number in range(found.fibers):
        points = np.concatenate([line for line, owner in zip(found.lines, found.owner, strict=True) if owner == number])
        column, row = np.rint(points).astype(np.int64).T
        fiber = seen.fiber[row.clip(0, rows - 1), column.clip(0, columns - 1)]
        which.append(int(np.bincount(fiber[fiber >= 0]).argmax()))
    return np.array(which)


def main() -> None:
    """Print the tables, row after row."""
    wanted = tuple(sys.argv[1:])
    _diameters([trial for trial in TRIALS if not wanted or trial.name.startswith(wanted)])
    if not wanted or "mixtures" in wanted:
        _mixtures()
    if not wanted or "directions" in wanted:
        _directions()


def _told(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def _diameters(trials: list[Trial]) -> None:
    _told(
        "| pictures | fibers drawn | seen | mean | spread | mean of all drawn | its standard error |\n"
        + "|---" * 7
        + "|"
    )
    for trial in trials:
        pixel = UM / trial.median
        law = Lognormal(median=UM, geometric_std=trial.geometric_std)
        s = sample(mats(law, pixel, PICTURES, Isotropic()), pixel, trial.exposure)
        chance = s.seen.std() / np.sqrt(len(s.seen)) / s.drawn.mean()
        _told(
            f"| {trial.name} | {len(s.drawn)} | {len(s.seen)} | {_error(s.seen.mean(), s.true.mean())} | "
            f"{_error(s.seen.std(), s.true.std())} | {_error(s.seen.mean(), s.drawn.mean())} | {100 * chance:.1f} % |"
        )


def _error(value: float, true: float) -> str:
    return f"{100 * (value / true - 1):+.1f} %"


def _mixtures() -> None:
    _told(
        "\n| ratio of two modes | thin ones | law | thin mode | thick mode | share of thin, drawn .75 |\n"
        + "|---" * 6
        + "|"
    )
    for ratio, width in MIXTURES:
        pixel = UM / width
        kinds = (
            Part(weight=3, diameter=Lognormal(median=UM, geometric_std=1.15)),
            Part(weight=1, diameter=Lognormal(median=ratio * UM, geometric_std=1.15)),
        )
        s = sample(mats(Mixture(parts=kinds), pixel, PICTURES, Isotropic()), pixel, TYPICAL)
        best = diameter_laws(s.seen)[0]
        p = best.parameters
        row = ("", "", "")
        if best.name == "mixture":
            row = (_error(p["median_1"], UM), _error(p["median_2"], ratio * UM), f"{p['share']:.2f}")
        _told(f"| {ratio:g} | {width} pixels | {best.name} | {' | '.join(row)} |")


def _directions() -> None:
    _told("\n| concentration about 20 degree | measured | order, drawn | measured | axis |")
    _told("|---" * 5 + "|")
    for concentration in CONCENTRATIONS:
        pixel = UM / 12
        law = Lognormal(median=UM, geometric_std=1.3)
        turned = VonMises(axis=20.0, concentration=concentration)
        made = list(mats(law, pixel, PICTURES, turned))
        s = sample(made, pixel, TYPICAL)
        fitted, drawn = orientation_law(s.angle, s.length), orientation_law(*_drawn_directions(made))
        axis = f"{fitted.axis:.0f} degree" if fitted.law == "von_mises" else fitted.law
        _told(f"| {concentration:g} | {fitted.concentration:.2f} | {drawn.order:.2f} | {fitted.order:.2f} | {axis} |")


def _drawn_directions(made: Iterable[Mat]) -> tuple[Floats, Floats]:
    angle, length = [], []
    for mat in made:
        way = mat.nodes[mat.first[1:] - 1] - mat.nodes[mat.first[:-1]]
        angle.append(np.arctan2(way[:, 1], way[:, 0]) % np.pi)
        length.append(np.hypot(way[:, 0], way[:, 1]))
    return np.concatenate(angle), np.concatenate(length)


if __name__ == "__main__":
    main()
