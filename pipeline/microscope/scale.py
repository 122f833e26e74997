"""How long a pixel is, by what a picture's file says about itself or by the bar in the picture."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from typing import Any

import numpy as np
import numpy.typing as npt

_COARSEST = 10e-6
"""A resolution beyond this many meters per pixel is a printer's: 72 dots per inch are written into every picture."""
_PER_UNIT = {
    "nm": 1e-9,
    "um": 1e-6,
    "µm": 1e-6,
    "μm": 1e-6,
    "micron": 1e-6,
    "microns": 1e-6,
    "mm": 1e-3,
    "cm": 1e-2,
    "m": 1.0,
}
_PER_RESOLUTION_UNIT = {2: 0.0254, 3: 0.01}


def scale_of_tiff(file: Any) -> float | None:
    """Give the length of a pixel [m] from a TIFF's metadata, None where it has none.

    Parameters
    ----------
    file : tifffile.TiffFile
        FEI and Thermo Fisher, Zeiss, ImageJ and OME are read, and the plain resolution where it is a microscope's.
    """
    fei = file.fei_metadata or {}
    for section in ("Scan", "EScan", "IScan"):
        width = fei.get(section, {}).get("PixelWidth") if isinstance(fei.get(section), dict) else None
        if isinstance(width, (int, float)) and width > 0:
            return float(width)
    for key in ("ap_image_pixel_size", "ap_pixel_size"):
        entry = (file.sem_metadata or {}).get(key)
        if isinstance(entry, tuple) and len(entry) == 3 and _is_length(entry[1]) and entry[2] in _PER_UNIT:
            return float(entry[1]) * _PER_UNIT[entry[2]]
    page = file.pages[0]
    text = page.description or ""
    if (match := re.search(r'PhysicalSizeX="([0-9.eE+-]+)"', text)) is not None:
        unit = re.search(r'PhysicalSizeXUnit="([^"]+)"', text)
        factor = _PER_UNIT.get(unit[1] if unit is not None else "um")
        return float(match[1]) * factor if factor is not None else None
    per_unit = _resolution(page)
    if file.is_imagej and per_unit:
        name = str((file.imagej_metadata or {}).get("unit", "")).replace("\\u00B5", "µ")
        if name in _PER_UNIT:
            return _PER_UNIT[name] / per_unit
    code = page.tags.get("ResolutionUnit")
    if per_unit and code is not None and int(code.value) in _PER_RESOLUTION_UNIT:
        return credible(_PER_RESOLUTION_UNIT[int(code.value)] / per_unit)
    return None


def credible(pixel: float) -> float | None:
    """Give the length of a pixel [m] if a microscope may have written it, None if it is a printer's.

    Examples
    --------
    >>> credible(25e-9), credible(0.0254 / 72)
    (2.5e-08, None)
    """
    return pixel if 0 < pixel < _COARSEST else None


def _resolution(page: Any) -> float | None:
    tag = page.tags.get("XResolution")
    if tag is None:
        return None
    over, under = tag.value if isinstance(tag.value, tuple) else (tag.value, 1)
    return float(over) / float(under) if over and under else None


def _is_length(value: Any) -> bool:
    return isinstance(value, (int, float)) and value > 0


def bar_length(strip: npt.NDArray[np.float32]) -> int | None:
    """Give the length of the scale bar in an info strip, in pixels, None where there is none.

    Parameters
    ----------
    strip : (rows, columns) array [-]
        The bar is its longest even run of pixels in a row that differ from the ground; frames from side to side and
        lines of one color with the ground are none.
    """
    ground = float(np.median(strip))
    columns = strip.shape[1]
    longest = 0
    for row in np.abs(strip - ground) > 0.3:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(np.int8)))
        runs = edges[1::2] - edges[::2]
        runs = runs[runs < 0.9 * columns]
        if len(runs):
            longest = max(longest, int(runs.max()))
    # letters are shorter
    return longest if longest >= max(20, 0.03 * columns) else None
