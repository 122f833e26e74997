"""Solidity, thickness and diameter of the mat that comes nearest to all that was measured, by a model of its flow."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import NonlinearConstraint, minimize

from pipeline.twin.measurement import Measurement

Floats = npt.NDArray[np.float64]

_FARTHEST = math.log(4.0)
"""How far the fibers' diameters are scaled, up or down."""
_THINNEST, _THICKEST = 1e-7, 1.0
"""Thicknesses that are looked at [m]."""
_HELD = 0.5
"""Tolerances within which one quantity is held while another is moved: one mat is not its kind's mean."""
_EVEN = 1e-3
"""Weight of all misses beside the largest: what is free lies in the middle of its tolerance."""


@dataclass(frozen=True, slots=True)
class Medium:
    """A mat in three numbers.

    Parameters
    ----------
    solidity : float [-]
    thickness : float [m]
    scale : float [-]
        Of its fibers' diameters, over those that were measured.
    """

    solidity: float
    thickness: float
    scale: float


Drop = Callable[[Medium], float]
"""Pressure drop of a medium [Pa]."""


def values_of(medium: Medium, mean_diameter: float, fiber_density: float | None, drop: Drop) -> dict[str, float]:
    """Give what would be measured on a medium [SI], by the names of what was."""
    values = {
        "fiber_diameter": medium.scale * mean_diameter,
        "solidity": medium.solidity,
        "thickness": medium.thickness,
        "pressure_drop": drop(medium),
    }
    if fiber_density is not None:
        values["basis_weight"] = fiber_density * medium.solidity * medium.thickness
    return values


def nearest(
    measured: Mapping[str, Measurement],
    fiber_density: float | None,
    drop: Drop,
    solidities: tuple[float, float],
) -> tuple[Medium, dict[str, float]]:
    """Find the medium that has all that was measured, or comes nearest.

    Parameters
    ----------
    measured : mapping of str to Measurement
        Of ``fiber_diameter`` (the mean), and of two or more of basis_weight, solidity, thickness and pressure_drop.
    fiber_density : float, optional [kg/m3]
    drop : callable
    solidities : tuple of 2 float
        Least and largest solidity that a mat of these fibers reaches.

    Returns
    -------
    medium : Medium
        That whose worst miss, in tolerances, is least. If that is more than one tolerance, and all but one of what was
        measured go together, that which has those and misses the one by least: the pressure drop where it can be, which
        follows of the others, else the one that is missed by the fewest tolerances.
    alone : dict of str to float
        Where not all go together: what each quantity would have to be [SI] for all others to be within their
        tolerances; without those for which that is not enough.
    """
    names = list(measured)
    mean = measured["fiber_diameter"].value
    bounds = [
        (math.log(solidities[0]), math.log(solidities[1])),
        (math.log(_THINNEST), math.log(_THICKEST)),
        (-_FARTHEST, _FARTHEST),
    ]

    def values(place: Floats) -> dict[str, float]:
        return values_of(_medium(place), mean, fiber_density, drop)

    def misses(place: Floats) -> Floats:
        found = values(place)
        return np.array([measured[name].miss(found[name]) for name in names])

    # from several starts: where little is known, the way to the answer is long
    starts = [np.array(start) for start in _starts(measured, fiber_density, solidities)]
    every = np.ones(len(names), dtype=bool)
    place = min((_descended(misses, start, bounds, every) for start in starts), key=lambda at: _worst(misses(at)))
    if _worst(misses(place)) <= 1.0:
        return _medium(place), {}
    alone = {}
    for k, name in enumerate(names):
        without = _descended(misses, place, bounds, np.arange(len(names)) == k)
        if _worst(np.delete(misses(without), k)) <= 1.0:
            alone[name] = without
    if "pressure_drop" in alone:
        # what the mat is made of counts more than what follows of it by a model
        place = alone["pressure_drop"]
    elif alone:
        place = min(alone.values(), key=lambda at: _worst(misses(at)))
    return _medium(place), {name: values(at)[name] for name, at in alone.items()}


def _medium(place: Floats) -> Medium:
    return Medium(*(math.exp(each) for each in place[:3]))


def _worst(misses: Floats) -> float:
    return float(np.abs(misses).max())


def _starts(
    measured: Mapping[str, Measurement], fiber_density: float | None, solidities: tuple[float, float]
) -> list[tuple[float, float, float]]:
    starts = []
    for solidity in (0.03, 0.08, 0.2):
        given = measured.get("solidity")
        solidity = min(max(given.value if given is not None else solidity, solidities[0]), solidities[1])
        if (thickness := measured.get("thickness")) is not None:
            thick = thickness.value
        elif (weight := measured.get("basis_weight")) is not None:
            assert fiber_density is not None
            thick = weight.value / (fiber_density * solidity)
        else:
            thick = 50.0 * measured["fiber_diameter"].value
        starts.append((math.log(solidity), math.log(thick), 0.0))
    return starts


def _descended(
    misses: Callable[[Floats], Floats],
    start: Floats,
    bounds: list[tuple[float, float]],
    free: npt.NDArray[np.bool_],
) -> Floats:
    """Lower the largest of the free misses, a variable of its own that none of them may exceed; the others are held."""

    def cost(place: Floats) -> float:
        return float(place[3] + _EVEN * (misses(place[:3]) ** 2).sum())

    def spare(place: Floats) -> Floats:
        off, most = misses(place[:3]), np.where(free, place[3], _HELD)
        return np.concatenate([most - off, most + off])

    result = minimize(
        cost,
        np.append(start, _worst(misses(start))),
        method="SLSQP",
        bounds=[*bounds, (0.0, None)],
        constraints=[NonlinearConstraint(spare, 0.0, np.inf)],
        options={"maxiter": 200, "ftol": 1e-9},
    )
    return np.asarray(result.x[:3])
