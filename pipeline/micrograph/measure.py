"""What a micrograph says about the fibers in it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.errors import CaseError
from pipeline.micrograph.clean import without_streaks
from pipeline.micrograph.fibers import FiberSeen, Sight, fibers_of
from pipeline.micrograph.laws import DiameterLaw, OrientationLaw, diameter_laws, orientation_law
from pipeline.microscope.picture import Micrograph

Floats = npt.NDArray[np.float64]

RESOLVED = 6.0
"""Diameter in pixels from which on a fiber is measured within a few percent."""
_DRAWS = 400


@dataclass(frozen=True, slots=True)
class Interval:
    """A value and where it lies with 95 % confidence, by drawing the fibers again [m]."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """What was measured in a micrograph.

    Parameters
    ----------
    diameter, length, angle : (fibers,) arrays [m, m, rad]
        Of each fiber: its diameter, the length over which it is seen, its direction from the picture's x-axis upward.
    lines : tuple of (n, 2) arrays [pixel]
        Middle lines, column and row; `owner` tells each one's fiber.
    owner : (lines,) int array
    mean, std, median : Interval [m]
        Over the fibers, each counted once.
    length_mean, length_std : float [m]
        Each fiber weighted by the length over which it is seen.
    laws : tuple of DiameterLaw
        The best first.
    orientation : OrientationLaw
    coverage : float [-]
        Share of the picture that the measured fibers, those of the top layers, cover.
    ends : float [-]
        Share of the fibers' ends that lie in the picture, neither hidden nor beyond its edge.
    blur : float [pixel]
        Of the picture.
    streaks : float [-]
        Share of the picture that was streaks.
    warnings : tuple of str
    """

    diameter: Floats
    length: Floats
    angle: Floats
    lines: tuple[Floats, ...]
    owner: npt.NDArray[np.int64]
    mean: Interval
    std: Interval
    median: Interval
    length_mean: float
    length_std: float
    laws: tuple[DiameterLaw, ...]
    orientation: OrientationLaw
    coverage: float
    ends: float
    blur: float
    streaks: float
    warnings: tuple[str, ...]

    @property
    def fibers(self) -> int:
        """Number of fibers."""
        return len(self.diameter)


def measure(picture: Micrograph) -> Measured:
    """Measure the fibers of a micrograph: their diameters, directions, coverage and ends.

    Parameters
    ----------
    picture : Micrograph
        Fibers bright before a darker ground; where none are, dark ones before a brighter ground are looked for.

    Returns
    -------
    Measured
        The same for the same picture.

    Raises
    ------
    CaseError
        If there is no fiber, or fibers have too few pixels.
    """
    brightness, streaks = without_streaks(picture.brightness)
    sight = fibers_of(brightness)
    turned = None if sight is not None and len(sight.fibers) > 1 else fibers_of(1.0 - brightness)
    warnings = []
    if turned is not None and (sight is None or len(turned.fibers) > len(sight.fibers)):
        sight, brightness = turned, 1.0 - brightness
        warnings.append("the fibers are darker than what lies below them")
    if sight is None:
        raise CaseError(
            f"no fiber was found in the picture {picture.origin}: a fiber is a band of even width, at least 4 pixels "
            "wide and three times as long, whose edges stand out of the noise; take it at a larger magnification"
        )
    width = np.array([fiber.diameter for fiber in sight.fibers])
    thin = int((width < RESOLVED).sum())
    if np.median(width) < 4.5:
        raise CaseError(
            f"too few pixels per fiber: half of the {len(width)} fibers of the picture {picture.origin} are thinner "
            f"than {np.median(width):.1f} pixels, and {RESOLVED:g} are needed; take it at a larger magnification"
        )
    if thin:
        warnings.append(
            f"{thin} of {len(width)} fibers are thinner than {RESOLVED:g} pixels: their diameters are uncertain by "
            "10 % and more"
        )
    if len(width) < 30:
        warnings.append(f"only {len(width)} fibers: the spread of diameters is uncertain; measure more pictures")
    return _measured(picture, brightness, sight, streaks, warnings)


def _measured(
    picture: Micrograph, brightness: npt.NDArray[np.float32], sight: Sight, streaks: float, warnings: Sequence[str]
) -> Measured:
    fibers = sight.fibers
    diameter = picture.pixel * np.array([fiber.diameter for fiber in fibers])
    length = picture.pixel * np.array([fiber.seen for fiber in fibers])
    angle = np.array([fiber.angle for fiber in fibers])
    draws = np.random.default_rng(0).integers(0, len(diameter), (_DRAWS, len(diameter)))
    mean = float(np.average(diameter, weights=length))
    return Measured(
        diameter=diameter,
        length=length,
        angle=angle,
        lines=tuple(line for fiber in fibers for line in fiber.lines),
        owner=np.repeat(np.arange(len(fibers)), [len(fiber.lines) for fiber in fibers]),
        mean=_interval(float(diameter.mean()), diameter[draws].mean(axis=1)),
        std=_interval(float(diameter.std()), diameter[draws].std(axis=1)),
        median=_interval(float(np.median(diameter)), np.median(diameter[draws], axis=1)),
        length_mean=mean,
        length_std=float(np.sqrt(np.average((diameter - mean) ** 2, weights=length))),
        laws=tuple(diameter_laws(diameter)),
        orientation=orientation_law(angle, length),
        coverage=_coverage(brightness.shape, fibers),
        ends=_ends(brightness, fibers),
        blur=sight.optics.blur,
        streaks=streaks,
        warnings=tuple(warnings),
    )


def _interval(value: float, drawn: Floats) -> Interval:
    low, high = np.quantile(drawn, [0.025, 0.975])
    return Interval(value, float(low), float(high))


def _coverage(shape: tuple[int, ...], fibers: Sequence[FiberSeen]) -> float:
    from skimage.draw import polygon

    covered = np.zeros(shape, dtype=bool)
    for fiber in fibers:
        for line in fiber.lines:
            along = np.gradient(line, axis=0)
            normal = np.column_stack([-along[:, 1], along[:, 0]])
            normal *= 0.5 * fiber.diameter / np.maximum(np.linalg.norm(normal, axis=1), 1e-9)[:, None]
            outline = np.concatenate([line + normal, (line - normal)[::-1]])
            covered[polygon(outline[:, 1], outline[:, 0], shape)] = True
    return float(covered.mean())


def _ends(brightness: npt.NDArray[np.float32], fibers: Sequence[FiberSeen]) -> float:
    """Count the ends beyond which the picture is dark; where it is bright, something lies on the fiber."""
    from scipy.ndimage import map_coordinates

    rows, columns = brightness.shape
    inside, all_ends = 0, 0
    for fiber in fibers:
        points = np.concatenate(fiber.lines)
        way = points[-1] - points[0]
        way /= max(float(np.linalg.norm(way)), 1e-9)
        order = np.argsort(points @ way)
        level = float(np.median(map_coordinates(brightness, points.T[::-1], order=1, mode="nearest")))
        for end, out in ((points[order[-1]], way), (points[order[0]], -way)):
            steps = fiber.diameter * np.linspace(0.75, 1.75, 9)
            beyond = end + steps[:, None] * out
            all_ends += 1
            if (beyond < 1).any() or (beyond[:, 0] > columns - 2).any() or (beyond[:, 1] > rows - 2).any():
                continue
            ahead = float(np.median(map_coordinates(brightness, beyond.T[::-1], order=1, mode="nearest")))
            inside += ahead < 0.6 * level
    return inside / all_ends
