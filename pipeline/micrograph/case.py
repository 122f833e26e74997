"""The case whose mat has the laws of a micrograph."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import math

from pipeline.mat.case_lines import table_lines
from pipeline.mat.settings import Isotropic, Lognormal, Mixture, Normal, Part, VonMises
from pipeline.micrograph.laws import DiameterLaw, OrientationLaw
from pipeline.micrograph.measure import Measured
from pipeline.units import written

_DIAMETERS_ACROSS = 30
"""Mean diameters on a side of the plan: enough fibers for a mean, few enough to mesh in minutes."""


def case_of(measured: Measured, origin: str, picture: str, pixel: float) -> str:
    """Write a case file (TOML) whose mat has the diameters and directions that were measured.

    Parameters
    ----------
    measured : Measured
    origin : str
        Of the picture, for people to read.
    picture : str
        Its path from the case file's folder.
    pixel : float [m]

    Returns
    -------
    str
        A picture tells neither how much mat there is nor how dense it is: coverage and relaxation slope are the ones of
        ``fibertwin twin`` and of the reader.
    """
    mean = measured.mean
    lines = [
        f"# The mat of a micrograph ({' '.join(origin.split())}): {measured.fibers} fibers, mean diameter "
        f"{mean.value * 1e6:.4g} um ({mean.low * 1e6:.4g} to {mean.high * 1e6:.4g}, 95 %).",
        "# Which pressure drop has a mat of these fibers?",
        "",
        "[mat]",
        'generator = "layered"',
        f'side = "{side_for(measured.length_mean) * 1e6:g} um"',
        "relaxation_slope = 0.15   # a picture does not tell: fibertwin twin finds it from what was measured",
        "seed = 1",
        "",
        "[mat.fiber_diameter]",
        *table_lines(diameters_of(measured.laws[0])),
        "",
        "[mat.orientation]",
        *table_lines(orientation_of(measured.orientation)),
        "",
        "[mat.stop]",
        "coverage = 2   # a picture does not tell: state the basis weight's, or a thickness",
        "",
        "[flow]",
        'face_velocity = "2.5 cm/s"',
        'temperature = "293 K"',
        *picture_lines(picture, pixel),
    ]
    return "\n".join(lines) + "\n"


def picture_lines(picture: str, pixel: float) -> list[str]:
    """Write the table that lets a run show the mat beside a picture, from the case file's folder, at its scale [m]."""
    # what TOML and JSON write between quotes is the same but for signs that no path has
    quoted = json.dumps(picture, ensure_ascii=False)
    return [
        "",
        "[micrograph]   # the page shows the mat beside it",
        f"file = {quoted}",
        f'pixel = "{written(float(f"{pixel:.6g}"), "m")}"',
    ]


def side_for(diameter: float) -> float:
    """Give the side of a plan [m] that has room for enough fibers of a mean diameter [m], rounded up to two digits."""
    side = _DIAMETERS_ACROSS * diameter * 1e6
    step = 10.0 ** (math.floor(math.log10(side)) - 1)
    return 1e-6 * step * math.ceil(side / step)


def diameters_of(law: DiameterLaw) -> Normal | Lognormal | Mixture:
    """Give a law of diameters as a mat's settings."""
    p = law.parameters
    match law.name:
        case "normal":
            return Normal(mean=p["mean"], std=p["std"])
        case "lognormal":
            return _lognormal(p["median"], p["geometric_std"])
    thin = Part(weight=p["share"], diameter=_lognormal(p["median_1"], p["geometric_std_1"]))
    thick = Part(weight=1.0 - p["share"], diameter=_lognormal(p["median_2"], p["geometric_std_2"]))
    return Mixture(parts=(thin, thick))


def _lognormal(median: float, geometric_std: float) -> Lognormal:
    # settings take no law without any spread
    return Lognormal(median=median, geometric_std=max(geometric_std, 1.001))


def orientation_of(law: OrientationLaw) -> Isotropic | VonMises:
    """Give a law of directions as a mat's settings."""
    if law.law == "isotropic":
        return Isotropic()
    return VonMises(axis=round(law.axis, 1), concentration=law.concentration)
