"""What a filter is called: EN 1822 and ISO 29463 by what passes at the worst size, ISO 16890 by particulate matter."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from pipeline.nouns.arrays import Floats

EN_1822 = (
    ("U17", 5e-8), ("U16", 5e-7), ("U15", 5e-6), ("H14", 5e-5), ("H13", 5e-4), ("E12", 5e-3), ("E11", 5e-2),
    ("E10", 0.15),
)  # fmt: skip
"""EN 1822-1:2019: class and largest penetration over the whole element at the most penetrating size [-]."""

ISO_29463 = (
    ("ISO 75 U", 5e-8), ("ISO 70 U", 1e-7), ("ISO 65 U", 5e-7), ("ISO 60 U", 1e-6), ("ISO 55 U", 5e-6),
    ("ISO 50 U", 1e-5), ("ISO 45 H", 5e-5), ("ISO 40 H", 1e-4), ("ISO 35 H", 5e-4), ("ISO 30 E", 1e-3),
    ("ISO 25 E", 5e-3), ("ISO 20 E", 1e-2), ("ISO 15 E", 5e-2),
)  # fmt: skip
"""ISO 29463-1:2017: class and largest penetration over the whole element at the most penetrating size [-]."""


def _named(penetration: float, classes: tuple[tuple[str, float], ...]) -> str | None:
    # a limit that is met exactly is met, however it was rounded
    return next((name for name, limit in classes if penetration <= limit * (1.0 + 1e-9)), None)


def en_1822_class(penetration: float) -> str | None:
    """Class of a filter after EN 1822-1:2019.

    Parameters
    ----------
    penetration : float [-]
        Share of particles of the most penetrating size that pass, over the whole element (the standard's tests of
        leaks from class H13 on are of the element made, not of the medium).

    Returns
    -------
    str or None
        None below E10.

    Examples
    --------
    >>> en_1822_class(0.0004), en_1822_class(0.3)
    ('H13', None)
    """
    return _named(penetration, EN_1822)


def iso_29463_class(penetration: float) -> str | None:
    """Class of a filter after ISO 29463-1:2017; as `en_1822_class`, None below ISO 15 E.

    Examples
    --------
    >>> iso_29463_class(0.0004)
    'ISO 35 H'
    """
    return _named(penetration, ISO_29463)


@dataclass(frozen=True, slots=True)
class Dust:
    """A standard air: two lognormal modes of the particles' volume.

    Parameters
    ----------
    fine_share : float [-]
        Share of the volume in the fine mode.
    fine, coarse : float [m]
        Median diameters.
    fine_spread, coarse_spread : float [-]
        Geometric standard deviations.
    """

    fine_share: float
    fine: float
    fine_spread: float
    coarse: float
    coarse_spread: float

    def volume(self, diameter: Floats) -> Floats:
        """Volume per logarithm of the diameter [-] at each diameter [m]."""
        value: Floats = self.fine_share * _mode(diameter, self.fine, self.fine_spread) + (
            1.0 - self.fine_share
        ) * _mode(diameter, self.coarse, self.coarse_spread)
        return value


def _mode(diameter: Floats, median: float, spread: float) -> Floats:
    width = np.log(spread)
    value: Floats = np.exp(-0.5 * (np.log(diameter / median) / width) ** 2) / (width * np.sqrt(2.0 * np.pi))
    return value


URBAN = Dust(0.45, 0.3e-6, 2.2, 10e-6, 3.1)
"""ISO 16890-1:2016, Table 3: the air that PM1 and PM2.5 are counted in."""

RURAL = Dust(0.18, 0.25e-6, 2.2, 11e-6, 4.0)
"""ISO 16890-1:2016, Table 3: the air that PM10 is counted in."""

ISO_16890 = MappingProxyType({"ePM1": (1e-6, URBAN), "ePM2.5": (2.5e-6, URBAN), "ePM10": (10e-6, RURAL)})
"""Group, its largest optical particle diameter [m], and its air; each starts at 0.3 um."""

SMALLEST = 0.3e-6
"""Diameter that every group of ISO 16890 starts at [m]."""


def particulate_efficiency(diameter: Floats, efficiency: Floats, group: str) -> float | None:
    r"""Efficiency by particle volume of a group of ISO 16890-1:2016.

    .. math:: ePM_x = \frac{\int E(d)\, q_3(d)\, d\ln d}{\int q_3(d)\, d\ln d}, \qquad 0.3\,\mu m \le d \le x

    Parameters
    ----------
    diameter : (n,) array [m]
        Rising.
    efficiency : (n,) array [-]
    group : {"ePM1", "ePM2.5", "ePM10"}

    Returns
    -------
    float or None
        None where the sizes do not reach from 0.3 um to the group's largest.

    Notes
    -----
    The standard takes the mean of the medium as it is and of the medium without its charge; fibers without charge
    have one efficiency. Between sizes the efficiency is taken as linear in the logarithm of the diameter.

    Examples
    --------
    >>> round(particulate_efficiency(np.array([1e-7, 1e-5]), np.array([0.8, 0.8]), "ePM1"), 9)
    0.8
    """
    largest, dust = ISO_16890[group]
    # sizes written as text may miss a limit by rounding
    if diameter[0] > SMALLEST * (1 + 1e-9) or diameter[-1] < largest * (1 - 1e-9):
        return None
    fine = np.geomspace(SMALLEST, largest, 401)
    at = np.interp(np.log(fine), np.log(diameter), efficiency)
    weight = dust.volume(fine)
    return float(np.trapezoid(at * weight, np.log(fine)) / np.trapezoid(weight, np.log(fine)))


def iso_16890_group(efficiencies: dict[str, float | None]) -> str | None:
    """Name a filter as ISO 16890-1:2016 does: the finest group that it catches half of, rounded down to 5 %.

    Parameters
    ----------
    efficiencies : dict of str to float or None
        By group, of `particulate_efficiency`.

    Returns
    -------
    str or None
        ``ISO Coarse`` where ePM10 is known and below half; None where nothing can be said.

    Examples
    --------
    >>> iso_16890_group({"ePM1": 0.43, "ePM2.5": 0.58, "ePM10": 0.9})
    'ISO ePM2.5 55%'
    """
    for group in ISO_16890:
        value = efficiencies.get(group)
        if value is not None and value >= 0.5:
            rounded = min(5 * int(100.0 * value / 5.0 + 1e-9), 95)
            above = ">" if value > 0.95 else ""
            return f"ISO {group} {above}{rounded}%"
    return "ISO Coarse" if efficiencies.get("ePM10") is not None else None
