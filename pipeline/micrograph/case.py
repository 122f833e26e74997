"""The case whose mat has the laws of a micrograph."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

from pipeline.micrograph.laws import DiameterLaw
from pipeline.micrograph.measure import Measured

_DIAMETERS_ACROSS = 30
"""Mean diameters on a side of the plan: enough fibers for a mean, few enough to mesh in minutes."""


def case_of(measured: Measured, origin: str) -> str:
    """Write a case file (TOML) whose mat has the diameters and directions that were measured.

    Parameters
    ----------
    measured : Measured
    origin : str
        Of the picture, for people to read.

    Returns
    -------
    str
        A picture tells neither how much mat there is nor how dense it is: coverage and relaxation slope are the ones of
        ``fibertwin tune`` and of the reader.
    """
    mean = measured.mean
    side = _rounded(_DIAMETERS_ACROSS * measured.length_mean * 1e6)
    lines = [
        f"# The mat of a micrograph ({' '.join(origin.split())}): {measured.fibers} fibers, mean diameter "
        f"{mean.value * 1e6:.4g} um ({mean.low * 1e6:.4g} to {mean.high * 1e6:.4g}, 95 %).",
        "# Which pressure drop has a mat of these fibers?",
        "",
        "[mat]",
        'generator = "layered"',
        f'side = "{side:g} um"',
        "relaxation_slope = 0.15   # a picture does not tell: fibertwin tune finds it from what was measured",
        "seed = 1",
        "",
        "[mat.fiber_diameter]",
        *_diameters(measured.laws[0]),
        "",
        "[mat.orientation]",
        *_directions(measured),
        "",
        "[mat.stop]",
        "coverage = 2   # a picture does not tell: state the basis weight's, or a thickness",
        "",
        "[flow]",
        'face_velocity = "2.5 cm/s"',
        'temperature = "293 K"',
    ]
    return "\n".join(lines) + "\n"


def _diameters(law: DiameterLaw) -> list[str]:
    p = law.parameters
    match law.name:
        case "normal":
            return ['distribution = "normal"', f'mean = "{_um(p["mean"])}"', f'std = "{_um(p["std"])}"']
        case "lognormal":
            return [
                'distribution = "lognormal"',
                f'median = "{_um(p["median"])}"',
                f"geometric_std = {p['geometric_std']:.4g}",
            ]
    kinds = ((p["share"], "1"), (1.0 - p["share"], "2"))
    parts = [
        f'    {{ weight = {share:.4g}, diameter = {{ distribution = "lognormal", median = "{_um(p["median_" + k])}", '
        f"geometric_std = {max(p['geometric_std_' + k], 1.001):.4g} }} }},"
        for share, k in kinds
    ]
    return ['distribution = "mixture"', "parts = [", *parts, "]"]


def _directions(measured: Measured) -> list[str]:
    law = measured.orientation
    if law.law == "isotropic":
        return ['law = "isotropic"']
    return [
        'law = "von_mises"',
        f'axis = "{law.axis:.1f} degree"',
        f"concentration = {law.concentration:.4g}",
    ]


def _um(length: float) -> str:
    return f"{length * 1e6:.4g} um"


def _rounded(length: float) -> float:
    """Round up to two digits."""
    step = 10.0 ** (math.floor(math.log10(length)) - 1)
    return math.ceil(length / step) * step
