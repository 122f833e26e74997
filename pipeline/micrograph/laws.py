"""The law of diameters and of directions that measured fibers follow."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq
from scipy.special import i0e, i1e, logsumexp

Floats = npt.NDArray[np.float64]

_FEWEST_FOR_TWO = 12
"""Fibers below which two kinds are not told apart."""
_STEPS = 500
_EARNED = 6.0
"""What two kinds must gain in the criterion over one: where there is but one, twice the gain in likelihood of a second
one is spread wider than the criterion's theory has it (McLachlan and Peel, Finite Mixture Models, 2000, 6.4)."""


@dataclass(frozen=True, slots=True)
class DiameterLaw:
    """A law of diameters that was fitted by maximum likelihood.

    Parameters
    ----------
    name : {"normal", "lognormal", "mixture"}
    parameters : dict of str to float
        As the case file has them [m, -]: of a normal law mean and std, of a lognormal one median and geometric_std; of
        a mixture of two lognormal laws share (of the thinner kind), median_1, geometric_std_1, median_2 and
        geometric_std_2.
    aic : float
        Akaike's criterion with its correction for few fibers: the lowest is best.
    """

    name: str
    parameters: dict[str, float]
    aic: float


def diameter_laws(diameter: Floats) -> list[DiameterLaw]:
    """Fit a normal law, a lognormal one and a mixture of two, the best first.

    Parameters
    ----------
    diameter : (fibers,) array [m]
        Two or more; a mixture is tried with 12 or more.

    Returns
    -------
    list of DiameterLaw
    """
    # a spread below a thousandth is the measure's own grain
    log = np.log(diameter)
    mean, std = float(diameter.mean()), max(float(diameter.std()), 1e-3 * float(diameter.mean()))
    middle, width = float(log.mean()), max(float(log.std()), 1e-3)
    laws = [
        DiameterLaw("normal", {"mean": mean, "std": std}, _aic(float(_normal(diameter, mean, std).sum()), 2, len(log))),
        DiameterLaw(
            "lognormal",
            {"median": math.exp(middle), "geometric_std": math.exp(width)},
            _aic(float((_normal(log, middle, width) - log).sum()), 2, len(log)),
        ),
    ]
    if len(log) >= _FEWEST_FOR_TWO:
        laws.append(_two_kinds(log))
    return sorted(laws, key=lambda law: law.aic + (_EARNED if law.name == "mixture" else 0.0))


def _normal(value: Floats, mean: float | Floats, std: float | Floats) -> Floats:
    """Logarithm of the normal density."""
    density: Floats = -0.5 * ((value - mean) / std) ** 2 - np.log(std) - 0.5 * math.log(2 * math.pi)
    return density


def _aic(likelihood: float, parameters: int, count: int) -> float:
    spare = count - parameters - 1
    correction = 2.0 * parameters * (parameters + 1) / spare if spare > 0 else math.inf
    return 2.0 * parameters - 2.0 * likelihood + correction


def _two_kinds(log: Floats) -> DiameterLaw:
    """Fit two lognormal kinds by expectation and maximization, from several splits; the likeliest is kept."""
    ordered = np.sort(log)
    best: tuple[float, Floats, Floats, Floats] | None = None
    for split in (0.25, 0.5, 0.75):
        at = int(split * len(ordered))
        share = np.array([split, 1 - split])
        mean = np.array([ordered[:at].mean(), ordered[at:].mean()])
        # a kind is no narrower than 3 %: else one fiber is a kind of its own
        std = np.maximum([ordered[:at].std(), ordered[at:].std()], 0.03)
        likelihood = -math.inf
        for _ in range(_STEPS):
            parts = np.log(share)[:, None] + _normal(log[None, :], mean[:, None], std[:, None])
            whole = logsumexp(parts, axis=0)
            before, likelihood = likelihood, float(whole.sum())
            belongs = np.exp(parts - whole)
            amount = np.maximum(belongs.sum(axis=1), 1e-9)
            share = amount / amount.sum()
            mean = (belongs * log).sum(axis=1) / amount
            std = np.maximum(np.sqrt((belongs * (log - mean[:, None]) ** 2).sum(axis=1) / amount), 0.03)
            if likelihood - before < 1e-8 * abs(likelihood):
                break
        if best is None or likelihood > best[0]:
            best = (likelihood, share, mean, std)
    assert best is not None
    likelihood, share, mean, std = best
    thin, thick = np.argsort(mean)
    parameters = {
        "share": float(share[thin]),
        "median_1": math.exp(mean[thin]),
        "geometric_std_1": math.exp(std[thin]),
        "median_2": math.exp(mean[thick]),
        "geometric_std_2": math.exp(std[thick]),
    }
    return DiameterLaw("mixture", parameters, _aic(likelihood - float(log.sum()), 5, len(log)))


@dataclass(frozen=True, slots=True)
class OrientationLaw:
    """The law of directions in the plane.

    Parameters
    ----------
    law : {"isotropic", "von_mises"}
        Isotropic unless the other one has the lower criterion of Akaike.
    axis : float [degree]
        Most frequent direction, from the picture's x-axis toward its y-axis, from -90 to below 90.
    concentration : float [-]
        Of the density proportional to exp(concentration cos 2(angle - axis)).
    order : float [-]
        Mean of cos 2(angle - axis): 0 for all directions alike, 1 for parallel fibers.
    """

    law: str
    axis: float
    concentration: float
    order: float


def orientation_law(angle: Floats, length: Floats) -> OrientationLaw:
    """Fit the directions of fibers, each weighted by its length.

    Parameters
    ----------
    angle : (fibers,) array [rad]
    length : (fibers,) array
        A fiber that crosses a picture is seen over more of it than one that crosses a corner.

    Returns
    -------
    OrientationLaw
    """
    sum_of = complex((length * np.exp(2j * angle)).sum() / length.sum())
    order, axis = abs(sum_of), 0.5 * float(np.angle(sum_of))
    # beyond .9999 the concentration is a matter of the last digits
    concentration = float(brentq(lambda k: i1e(k) / i0e(k) - min(order, 0.9999), 0.0, 1e4) if order > 1e-6 else 0.0)
    independent = float(length.sum() ** 2 / (length**2).sum())
    # log I0(k) = log i0e(k) + k
    gain = independent * (concentration * order - math.log(float(i0e(concentration))) - concentration)
    axis = (math.degrees(axis) + 90.0) % 180.0 - 90.0
    return OrientationLaw("von_mises" if gain > 2.0 else "isotropic", axis, concentration, order)
