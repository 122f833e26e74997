"""Diameters to a fraction of a pixel: the brightness across a fiber, fitted by what the microscope makes of a cylinder.

A surface that is tilted sends more electrons, about as 1 / cos of the tilt, so rims are brighter than the middle; in
light they are darker. With one level on the left and one on the right, all is blurred by the beam. Blur and rims belong
to the picture: were they free for each fiber, a thin one with bright rims would look like a wide one without.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter, gaussian_filter1d, map_coordinates, spline_filter
from scipy.optimize import minimize, minimize_scalar, nnls

from pipeline.micrograph.ribbons import Image, noise_of
from pipeline.micrograph.trace import Trace

Floats = npt.NDArray[np.float64]

_SPACING = 0.25
"""Distance between the samples of a profile, in pixels."""
_FINE = 0.2
"""Distance between the samples that the blur is computed on, in pixels."""
_CALM, _DARKEST = 3.0, 0.005
"""Standard deviation of the average [pixel] and share of the picture by which the darkest places are found."""
_UNLIKE = 3.5
"""How far a row across a fiber is off the median one over what half of them are, at most."""
_BLURS = (0.5, 0.9, 1.5, 2.3)
_RIMS = (0.0, 1.0, 3.0)
_DARKS = (0.0, 0.6)
"""Where the search for a picture's blur [pixel], bright rims and dark sides starts from."""
_FIRST_STEPS = np.array([[0.0, 0.0, 0.0], [0.15, 0.0, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.15]])
_STEEPEST = 4.0
"""Brightness of a grazing rim over that of a level surface at most: the escape of electrons is bounded."""


@dataclass(frozen=True, eq=False, slots=True)
class Profile:
    """Brightness across a fiber, the mean along it where it is undisturbed.

    Parameters
    ----------
    place : (n,) array [pixel]
        From the fiber's middle line.
    brightness : (n,) array [-]
    half_width : float [pixel]
        As traced.
    grain : float [-]
        Variance that noise leaves in the mean.
    """

    place: Floats
    brightness: Floats
    half_width: float
    grain: float


def profiles(brightness: Image, traced: Sequence[Trace]) -> list[Profile]:
    """Take the brightness across fibers, above that of the darkest places.

    What a detector gives where nothing is seen is no part of a fiber's light, whose rims are a share of it.

    Parameters
    ----------
    brightness : (rows, columns) array [-]
    traced : sequence of Trace

    Returns
    -------
    list of Profile
        One per trace.
    """
    nothing = float(np.quantile(gaussian_filter(brightness, _CALM), _DARKEST))
    smooth = spline_filter(brightness.astype(np.float64) - nothing, order=3)
    noise = noise_of(brightness)
    return [_profile(smooth, trace, noise) for trace in traced]


def _profile(spline: Floats, trace: Trace, noise: float) -> Profile:
    points = middle_line(trace)
    along = np.gradient(points, axis=0)
    along /= np.linalg.norm(along, axis=1)[:, None]
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    half = float(np.median(trace.half_width[trace.clear]))
    reach = half + max(0.35 * half, 5.0)
    place = np.arange(-int(reach / _SPACING), int(reach / _SPACING) + 1) * _SPACING
    clear = trace.clear
    at = points[clear][:, None, :] + place[None, :, None] * normal[clear][:, None, :]
    rows, columns = spline.shape
    values = map_coordinates(spline, [at[..., 1], at[..., 0]], order=3, prefilter=False, mode="nearest")
    values[(at[..., 0] < 0) | (at[..., 0] > columns - 1) | (at[..., 1] < 0) | (at[..., 1] > rows - 1)] = np.nan
    known = np.isfinite(values).sum(axis=0) > 0.5 * len(values)
    place, values = place[known], values[:, known]
    kept = values[_alike(values, np.abs(place) <= half + 2.0)]
    return Profile(place, np.nanmean(kept, axis=0), half, noise**2 / len(kept))


def _alike(values: Floats, inner: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Tell which rows across a fiber look like most of them; on others something lies, or leans against the fiber.

    Of these the mean is taken: a median place by place would be pulled off the bright and narrow rims.
    """
    apart = values[:, inner] - np.nanmedian(values[:, inner], axis=0)
    off = np.sqrt(np.nanmean(apart**2, axis=1))
    alike: npt.NDArray[np.bool_] = off <= _UNLIKE * np.median(off)
    return alike


def middle_line(trace: Trace, window: int = 15) -> Floats:
    """Smooth a trace's points by straight lines through their neighbors, (n, 2) array [pixel]."""
    weight = np.where(trace.clear, 1.0, 1e-3)
    steps = np.arange(-window, window + 1)
    kernel = 1.0 - (np.abs(steps) / (window + 1)) ** 2
    place = np.arange(len(weight), dtype=np.float64)
    sums = [np.convolve(weight * place**power, kernel)[window:-window] for power in range(3)]
    smooth = np.empty_like(trace.points)
    for axis in (0, 1):
        values = trace.points[:, axis]
        s0 = np.convolve(weight * values, kernel)[window:-window]
        s1 = np.convolve(weight * values * place, kernel)[window:-window]
        determinant = sums[0] * sums[2] - sums[1] ** 2
        slope = (sums[0] * s1 - sums[1] * s0) / np.maximum(determinant, 1e-12)
        smooth[:, axis] = s0 / sums[0] + slope * (place - sums[1] / sums[0])
    return smooth


@dataclass(frozen=True, slots=True)
class Optics:
    """How a picture shows a cylinder.

    Parameters
    ----------
    blur : float [pixel]
        Standard deviation of the beam.
    rim : float [-]
        By how much a grazing surface is brighter than a level one, as a share of the latter, where brightness goes
        with 1 / cos of the tilt; 0 or more.
    dark : float [-]
        By how much a vertical surface is darker than a level one, where brightness goes with the cosine: in light, and
        because the sides of a fiber lie deeper than its top; 0 to 1.
    """

    blur: float
    rim: float
    dark: float


@dataclass(frozen=True, slots=True)
class Fit:
    """What was fitted to a profile.

    Parameters
    ----------
    half_width : float [pixel]
    explained : float [-]
        Share of the profile's variance that the fit explains, noise aside.
    evenness : float [-]
        How far the fiber stands out of its darker side over how far out of the other; a rim does not stand out of the
        fiber it belongs to as it does of what lies beside.
    """

    half_width: float
    explained: float
    evenness: float


def optics_of(taken: Sequence[Profile]) -> Optics:
    """Give the optics that the profiles of a picture are best explained by, all together.

    Parameters
    ----------
    taken : sequence of Profile
        The best ones are enough; at least one.

    Returns
    -------
    Optics
    """

    def cost(optics: Optics) -> float:
        return float(np.mean([math.log(max(_best(profile, optics)[1], 1e-12)) for profile in taken]))

    start = min((Optics(blur, rim, dark) for blur in _BLURS for rim in _RIMS for dark in _DARKS), key=cost)

    # the blur has no sign: it is searched as its logarithm
    def of_place(at: Floats) -> float:
        return cost(_optics(at))

    place: Floats = np.array([math.log(start.blur), start.rim, start.dark])
    result = minimize(
        of_place,
        place,
        method="Nelder-Mead",
        options={"maxfev": 70, "initial_simplex": place + _FIRST_STEPS, "xatol": 0.02, "fatol": 0.003},
    )
    return _optics(result.x)


def _optics(place: Floats) -> Optics:
    log_blur, rim, dark = place
    return Optics(math.exp(min(max(log_blur, -1.2), 1.5)), min(max(rim, 0.0), 8.0), min(max(dark, 0.0), 1.0))


def fitted(profile: Profile, optics: Optics) -> Fit:
    """Fit a cylinder to a profile."""
    half, cost = _best(profile, optics)
    left = max(cost - profile.grain, 0.0) / max(float(np.var(profile.brightness)), 1e-12)
    levels, _ = nnls(_shapes(half, optics, profile.place), profile.brightness)
    rises = levels[2] - levels[:2]
    return Fit(half, 1.0 - left, float(rises.min() / max(rises.max(), 1e-12)))


def _best(profile: Profile, optics: Optics) -> tuple[float, float]:
    """Give the half width that fits best, and the mean square of what its fit leaves."""
    trials = profile.half_width * np.linspace(0.68, 1.2, 9)
    costs = [_misfit(profile, float(half), optics) for half in trials]
    best = int(np.argmin(costs))
    step = float(trials[1] - trials[0])
    result = minimize_scalar(
        lambda half: _misfit(profile, float(half), optics),
        bounds=(float(trials[best]) - step, float(trials[best]) + step),
        method="bounded",
        options={"xatol": 0.004 * profile.half_width},
    )
    return float(result.x), float(result.fun)


def _misfit(profile: Profile, half: float, optics: Optics) -> float:
    """Fit levels for a half width, none below 0, and give the mean square of what is left."""
    shapes = _shapes(half, optics, profile.place)
    _, left = nnls(shapes, profile.brightness)
    return float(left**2 / len(profile.place))


def _shapes(half: float, optics: Optics, place: Floats) -> Floats:
    """Give the blurred shapes that brightness is made of: left, right, and the fiber."""
    reach = max(float(-place[0]), float(place[-1])) + 4.0 * optics.blur
    count = int(reach / _FINE)
    fine = np.arange(-count, count + 1) * _FINE
    # each sample is the mean over its cell: a thin fiber's rim is narrower than a cell
    borders = np.clip((np.arange(-count, count + 2) - 0.5) * _FINE / half, -1.0, 1.0)
    share, plain, steep = (np.diff(each) * half / _FINE for each in _sums_across(borders))
    outside = 1.0 - share
    fiber = share + optics.rim * steep - optics.dark * (share - plain)
    raw = np.stack([outside * (fine < 0), outside * (fine >= 0), fiber])
    smooth = gaussian_filter1d(raw, optics.blur / _FINE, axis=1, mode="nearest", truncate=3.0)
    return np.stack([np.interp(place, fine, one) for one in smooth], axis=1)


def _sums_across(place: Floats) -> tuple[Floats, Floats, Floats]:
    """Give the sums from a fiber's middle line to places across it, from -1 to 1, of three shapes.

    They are 1; the cosine of the tilt; and by how much its inverse, bounded, exceeds 1, over what it does at most.
    """
    angle = np.arcsin(place)
    cosine = 0.5 * (place * np.sqrt(1.0 - place**2) + angle)
    bound = math.sqrt(1.0 - _STEEPEST**-2)
    beyond = np.maximum(np.abs(place) - bound, 0.0)
    inverse = np.sign(place) * (np.minimum(np.abs(angle), math.asin(bound)) + _STEEPEST * beyond)
    return place, cosine, (inverse - place) / (_STEEPEST - 1.0)
