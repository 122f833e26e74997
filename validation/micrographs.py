"""Truth against measure: mats of known diameters, their pictures, and what `fibertwin measure` makes of them.

``python -m validation.micrographs`` prints the tables of docs/measuring.md.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from pipeline.mat.generate import generate
from pipeline.mat.settings import Isotropic, LayeredSettings, Lognormal, Mixture, Part, Stop, VonMises
from pipeline.micrograph.laws import diameter_laws, orientation_law
from pipeline.micrograph.measure import Floats, measure
from pipeline.microscope.synthetic import Exposure, micrograph_of
from pipeline.nouns.fibers import Mat

UM = 1e-6
SIDE = 700
"""Pixels on a side of each picture."""
TYPICAL = Exposure(depth=5 * UM, edge=1.0, blur=1.0, noise=0.05)


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
    seeds : int
    """

    name: str
    median: float
    geometric_std: float = 1.3
    exposure: Exposure = TYPICAL
    seeds: int = 6


TRIALS = (
    *(Trial(f"{width} pixels", width) for width in (6, 8, 12, 20, 30)),
    Trial("12 pixels, narrow", 12, geometric_std=1.1),
    Trial("12 pixels, wide", 12, geometric_std=1.6),
    Trial("12 pixels, no noise", 12, exposure=Exposure(5 * UM, 1.0, 1.0, 0.01)),
    Trial("12 pixels, noise .2", 12, exposure=Exposure(5 * UM, 1.0, 1.0, 0.2)),
    Trial("12 pixels, blur 2", 12, exposure=Exposure(5 * UM, 1.0, 2.0, 0.05)),
    Trial("12 pixels, bright rims", 12, exposure=Exposure(5 * UM, 3.0, 1.0, 0.05)),
    Trial("12 pixels, no rims", 12, exposure=Exposure(5 * UM, 0.0, 1.0, 0.05)),
    Trial("12 pixels, flat light", 12, exposure=Exposure(50 * UM, 1.0, 1.0, 0.05)),
)


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


def measured(made: Iterable[Mat], pixel: float, exposure: Exposure) -> tuple[Floats, Floats, Floats, Floats]:
    """Give the fibers' true diameters, the measured ones, directions and lengths [m, m, rad, m]."""
    true, seen, angle, length = [], [], [], []
    for mat in made:
        result = measure(micrograph_of(mat, pixel, exposure))
        true.append(2.0 * mat.radius)
        seen.append(result.diameter)
        angle.append(result.angle)
        length.append(result.length)
    return np.concatenate(true), np.concatenate(seen), np.concatenate(angle), np.concatenate(length)


def main() -> None:
    """Print the tables, row after row."""
    write = sys.stdout.write
    write("| pictures | fibers drawn | fibers seen | mean | its standard error | spread |\n|---|---|---|---|---|---|\n")
    for trial in TRIALS:
        pixel = UM / trial.median
        law = Lognormal(median=UM, geometric_std=trial.geometric_std)
        true, seen, _, _ = measured(mats(law, pixel, trial.seeds, Isotropic()), pixel, trial.exposure)
        error, spread = seen.mean() / true.mean() - 1, seen.std() / true.std() - 1
        chance = seen.std() / np.sqrt(len(seen)) / true.mean()
        write(
            f"| {trial.name} | {len(true)} | {len(seen)} | {100 * error:+.1f} % | {100 * chance:.1f} % | "
            f"{100 * spread:+.0f} % |\n"
        )
        sys.stdout.flush()
    write(
        "\n| ratio of two modes | law | thin, true 1 um | thick | its true | share of thin, true .75 |\n"
        "|---|---|---|---|---|---|\n"
    )
    for ratio in (2.0, 3.0, 5.0):
        pixel = UM / 8
        kinds = (
            Part(weight=3, diameter=Lognormal(median=UM, geometric_std=1.15)),
            Part(weight=1, diameter=Lognormal(median=ratio * UM, geometric_std=1.15)),
        )
        _, seen, _, _ = measured(mats(Mixture(parts=kinds), pixel, 6, Isotropic()), pixel, TYPICAL)
        best = diameter_laws(seen)[0]
        p = best.parameters
        modes = (p["median_1"] / UM, p["median_2"] / UM, p["share"]) if best.name == "mixture" else (0, 0, 0)
        write(f"| {ratio:g} | {best.name} | {modes[0]:.2f} um | {modes[1]:.2f} um | {ratio:g} um | {modes[2]:.2f} |\n")
        sys.stdout.flush()
    write("\n| concentration about 20 degree | measured | axis |\n|---|---|---|\n")
    for concentration in (0.5, 2.0, 8.0):
        pixel = UM / 12
        law = Lognormal(median=UM, geometric_std=1.3)
        turned = VonMises(axis=20.0, concentration=concentration)
        _, _, angle, length = measured(mats(law, pixel, 4, turned), pixel, TYPICAL)
        fitted = orientation_law(angle, length)
        write(f"| {concentration:g} | {fitted.concentration:.2f} | {fitted.axis:.0f} degree |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
