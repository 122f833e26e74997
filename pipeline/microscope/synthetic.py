"""The micrograph that a scanning electron microscope would take of a mat, from above.

No electrons are followed: what is kept is what a program that measures pictures stumbles over. Fibers hide those below
them, deeper fibers are darker, tilted surfaces give more electrons (brightness as 1 / cos of the tilt, which brightens
the rims of round fibers), the beam has a width, and the detector counts with noise.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.errors import CaseError
from pipeline.geometry.compiled import compiled
from pipeline.microscope.picture import Micrograph
from pipeline.nouns.fibers import Mat

_MOST_SAMPLES = 100_000_000
_FINER = 3
"""Samples along the side of a pixel: a beam of some width sees edges as they are, not as pixels cut them."""
_STEEPEST = 0.25
"""Cosine of the tilt beyond which a rim gets no brighter: the escape of electrons is bounded."""


@dataclass(frozen=True, slots=True)
class Exposure:
    """How the picture is taken.

    Parameters
    ----------
    depth : float [m]
        Below the mat's top, brightness falls by a factor of e over this depth; above 0, inf for no shading.
    edge : float [-]
        By how much a vertical surface is brighter than a level one, as a share of the latter; 0 or more.
    blur : float [-]
        Standard deviation of the beam's width, in pixels; 0 or more.
    noise : float [-]
        Standard deviation of each pixel, as a share of the brightness of a level surface at the top; 0 or more.
    seed : int
        Of the noise.
    """

    depth: float = math.inf
    edge: float = 1.0
    blur: float = 1.0
    noise: float = 0.05
    seed: int = 0

    def __post_init__(self) -> None:
        if not self.depth > 0:
            raise CaseError(f"a depth of shading of {self.depth:g} m: it must be above 0")
        for name in ("edge", "blur", "noise"):
            if not 0 <= getattr(self, name) < math.inf:
                raise CaseError(f"{name} = {getattr(self, name):g}: it must be 0 or more")


@dataclass(frozen=True, eq=False, slots=True)
class Seen:
    """What each pixel of a picture sees.

    Parameters
    ----------
    fiber : (rows, columns) int array
        The fiber, -1 where the view goes through the mat.
    height : (rows, columns) array [m]
        Of the surface that is seen; -inf where there is none.
    level : (rows, columns) array [-]
        Cosine of the surface's tilt, 1 where it is level.
    """

    fiber: npt.NDArray[np.int64]
    height: npt.NDArray[np.float64]
    level: npt.NDArray[np.float64]


def look_down(mat: Mat, pixel: float) -> Seen:
    """Tell what each pixel of a view from above sees.

    Parameters
    ----------
    mat : Mat
        Of a periodic mat, what leaves the plan on one side enters on the other.
    pixel : float [m]

    Returns
    -------
    Seen

    Raises
    ------
    CaseError
        If the picture would have less than 2 pixels on a side, or more than 100 million in all.
    """
    return _looked(mat, pixel, 1)


def _looked(mat: Mat, pixel: float, finer: int) -> Seen:
    """Tell what is seen so many times more finely along each side of a pixel."""
    columns, rows = (round(size / pixel) for size in mat.slab.size[:2])
    most = _MOST_SAMPLES // finer**2
    if min(columns, rows) < 2 or columns * rows > most:
        raise CaseError(
            f"pixels of {pixel * 1e9:g} nm make a picture of {columns} x {rows} pixels of this mat; "
            f"it takes 2 or more on a side and at most {most:,} in all"
        )
    columns, rows, pixel = finer * columns, finer * rows, pixel / finer
    fiber = np.full((rows, columns), -1, np.int64)
    height = np.full((rows, columns), -np.inf)
    level = np.ones((rows, columns))
    start = mat.segment_starts()
    owner = mat.segment_fibers()
    shifts = [(0.0, 0.0)]
    if mat.periodic:
        shifts = [(x * mat.slab.size[0], y * mat.slab.size[1]) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    low = np.array(mat.slab.lower)
    for x, y in shifts:
        nodes = mat.nodes - low + np.array([x, y, 0.0])
        _draw(nodes[start], nodes[start + 1], mat.radius[owner], owner, pixel, fiber, height, level)
    # rows of a picture run downward, y runs upward
    return Seen(fiber[::-1].copy(), height[::-1].copy(), level[::-1].copy())


def micrograph_of(mat: Mat, pixel: float, exposure: Exposure) -> Micrograph:
    """Take a picture of a mat from above.

    Parameters
    ----------
    mat : Mat
    pixel : float [m]
    exposure : Exposure

    Returns
    -------
    Micrograph
        0 is what sends no electrons; the brightest 0.1 % of the pixels are 1.

    Raises
    ------
    CaseError
        As `look_down`, from 11 million pixels on.
    """
    # scipy takes a quarter of a second to load
    from scipy.ndimage import gaussian_filter

    # a beam without width sees points
    finer = _FINER if exposure.blur > 0 else 1
    seen = _looked(mat, pixel, finer)
    hit = seen.fiber >= 0
    top = float(seen.height[hit].max()) if hit.any() else 0.0
    steepness = (1.0 / np.maximum(seen.level, _STEEPEST) - 1.0) / (1.0 / _STEEPEST - 1.0)
    depth = np.where(hit, top - seen.height, 0.0)
    light = np.where(hit, np.exp(-depth / exposure.depth) * (1.0 + exposure.edge * steepness), 0.0)
    if finer > 1:
        light = gaussian_filter(light, exposure.blur * finer)[finer // 2 :: finer, finer // 2 :: finer]
    light = light + exposure.noise * np.random.default_rng(exposure.seed).standard_normal(light.shape)
    # a detector has a dark level, so that noise is not cut off at black
    dark = 2.0 * exposure.noise
    bright = max(float(np.quantile(light, 0.999)), 1e-9)
    return Micrograph(
        np.clip((light + dark) / (bright + dark), 0.0, 1.0).astype(np.float32), pixel, f"synthetic, of {mat.origin}"
    )


@compiled
def _draw(
    begin: npt.NDArray[np.float64],
    end: npt.NDArray[np.float64],
    radius: npt.NDArray[np.float64],
    owner: npt.NDArray[np.int64],
    pixel: float,
    fiber: npt.NDArray[np.int64],
    height: npt.NDArray[np.float64],
    level: npt.NDArray[np.float64],
) -> None:
    """Draw cylinders with round ends into the pixels, each pixel by what lies highest at its middle."""
    rows, columns = fiber.shape
    for k in range(len(begin)):
        r = radius[k]
        (x0, y0, z0), (x1, y1, z1) = begin[k], end[k]
        along_x, along_y = x1 - x0, y1 - y0
        squared = along_x * along_x + along_y * along_y
        first_row = max(0, int(np.floor((min(y0, y1) - r) / pixel)))
        last_row = min(rows, int(np.ceil((max(y0, y1) + r) / pixel)) + 1)
        first_column = max(0, int(np.floor((min(x0, x1) - r) / pixel)))
        last_column = min(columns, int(np.ceil((max(x0, x1) + r) / pixel)) + 1)
        for row in range(first_row, last_row):
            y = (row + 0.5) * pixel - y0
            for column in range(first_column, last_column):
                x = (column + 0.5) * pixel - x0
                share = 0.0
                if squared > 0.0:
                    share = min(1.0, max(0.0, (x * along_x + y * along_y) / squared))
                away = (x - share * along_x) ** 2 + (y - share * along_y) ** 2
                if away >= r * r:
                    continue
                rise = np.sqrt(r * r - away)
                z = z0 + share * (z1 - z0) + rise
                if z > height[row, column]:
                    height[row, column] = z
                    fiber[row, column] = owner[k]
                    level[row, column] = rise / r
