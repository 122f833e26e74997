"""Micrographs from TIFF and PNG files."""

# SPDX-License-Identifier: GPL-3.0-or-later

import warnings
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from pipeline.errors import CaseError
from pipeline.isolated import isolated
from pipeline.line.store import DAMAGE
from pipeline.microscope.picture import Micrograph
from pipeline.microscope.scale import bar_length, credible, scale_of_tiff
from pipeline.microscope.strip import strip_rows
from pipeline.reading import open_file

LARGEST = 24_000_000
"""Pixels beyond which a picture is refused: its directions take 144 bytes a pixel."""
_SMALLEST = 64
Window = tuple[int, int, int, int]
_TIFF = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")


@dataclass(frozen=True, slots=True)
class Raw:
    """A file's pixels, what it says about their length [m], and whether they are the window already."""

    pixels: npt.NDArray[np.float32]
    scale: float | None
    cut: bool = False


def read_micrograph(
    path: Path,
    pixel: float | None = None,
    bar: float | None = None,
    window: Window | None = None,
) -> Micrograph:
    """Read a picture, without the strip that the microscope writes below or above it.

    Parameters
    ----------
    path : Path
        TIFF (8, 16 and 32 bits, either byte order, the first of several pages) or PNG; colors are averaged.
    pixel : float, optional [m]
        Length of a pixel; unless given, by the bar or what the file says.
    bar : float, optional [m]
        What the bar in the picture's strip stands for.
    window : (left, top, right, bottom), optional [pixel]
        The part to look at.

    Returns
    -------
    Micrograph
        Brightness stretched from 0 to 1.

    Raises
    ------
    CaseError
        If the file cannot be read, is too small or too large, or nothing tells the length of a pixel.
    """
    try:
        # libtiff and Pillow may crash on a damaged file, and speak to the terminal
        _head(path)
        raw = isolated(partial(_read, window=window), path)
    except (ValueError, ArithmeticError, LookupError, MemoryError) as problem:
        raise CaseError(f"{path} is damaged, or no picture in TIFF or PNG: {problem}") from problem
    pixels = raw.pixels if raw.cut or window is None else _part(raw.pixels, window)
    columns = pixels.shape[1]
    if pixels.size > LARGEST:
        _refuse_size(path, pixels.size)
    low, high = float(pixels.min()), float(np.quantile(pixels, 0.999))
    if not high > low:
        raise CaseError(f"{path} shows nothing: all of its {pixels.size} pixels are alike")
    brightness = np.clip((pixels - low) / (high - low), 0.0, 1.0).astype(np.float32)
    first, last = strip_rows(brightness)
    if pixel is None and bar is not None:
        strips = [strip for strip in (brightness[last:], brightness[:first]) if len(strip)]
        lengths = [length for strip in strips if (length := bar_length(strip)) is not None]
        if not lengths:
            raise CaseError(f"--bar: {path} has no strip with a scale bar at its lower or upper edge; give --pixel")
        pixel = bar / max(lengths)
    pixel = pixel if pixel is not None else raw.scale
    if pixel is None:
        raise CaseError(
            f'{path} does not say how long a pixel is; give it, as --pixel "25 nm", or the length that its bar stands '
            'for, as --bar "10 um"'
        )
    if min(last - first, columns) < _SMALLEST:
        raise CaseError(f"{path} has {columns} x {last - first} pixels; {_SMALLEST} on a side are the least")
    return Micrograph(brightness[first:last], pixel, f"read from {path.name}")


def _refuse_size(path: Path, size: int) -> NoReturn:
    raise CaseError(
        f"{path} has {size / 1e6:.0f} million pixels, more than {LARGEST / 1e6:.0f}; look at a part of it with "
        "--window left,top,right,bottom"
    )


def _part(pixels: npt.NDArray[Any], window: Window | None) -> npt.NDArray[Any]:
    assert window is not None
    rows, columns = pixels.shape[:2]
    left, top, right, bottom = window
    if not (0 <= left < right <= columns and 0 <= top < bottom <= rows):
        raise CaseError(
            f"--window {','.join(map(str, window))}: a window is left,top,right,bottom in pixels within "
            f"{columns} x {rows}"
        )
    return np.asarray(pixels[top:bottom, left:right])


def _head(path: Path) -> bytes:
    try:
        with open_file(path) as file:
            head = file.read(8)
    except OSError as problem:
        raise CaseError(f"cannot read the picture {path}: {problem.strerror}") from problem
    if not head:
        raise CaseError(f"the picture {path} is empty")
    return head


def _read(path: Path, window: Window | None) -> Raw:
    head = _head(path)
    return _read_tiff(path, window) if head[:4] in _TIFF else _read_other(path)


def _read_tiff(path: Path, window: Window | None) -> Raw:
    import tifffile

    try:
        with tifffile.TiffFile(path) as file:
            page = file.pages[0]
            if not isinstance(page, tifffile.TiffPage):
                raise CaseError(f"{path} has no picture on its first page")
            scale = scale_of_tiff(file)
            if page.imagewidth * page.imagelength > LARGEST and window is None:
                _refuse_size(path, page.imagewidth * page.imagelength)
            if page.compression == 1 and page.imagewidth * page.imagelength > LARGEST:
                # only the window is read from the disk
                return Raw(_gray(_part(tifffile.memmap(path, page=0, mode="r"), window), path), scale, True)
            if page.compression != 1:
                # its other compressions want a library of their own, which Pillow brings
                return Raw(_read_other(path).pixels, scale)
            return Raw(_gray(page.asarray(), path), scale)
    except DAMAGE as problem:
        raise CaseError(f"{path} is damaged, or no TIFF that can be read: {problem}") from problem


def _read_other(path: Path) -> Raw:
    from PIL import Image, UnidentifiedImageError

    try:
        # Pillow warns of large pictures that may be bombs; ours are bounded below
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path) as image:
                per_inch = image.info.get("dpi")
                plain = image.mode not in ("P", "1", "LA", "PA", "CMYK", "YCbCr")
                pixels = _gray(np.asarray(image if plain else image.convert("RGB")), path)
    except (Image.DecompressionBombWarning, Image.DecompressionBombError) as problem:
        raise CaseError(f"{path} has more pixels than can be looked at; cut a part out of it") from problem
    except (UnidentifiedImageError, OSError, SyntaxError, ValueError) as problem:
        raise CaseError(f"{path} is damaged, or no picture in TIFF or PNG: {problem}") from problem
    known = isinstance(per_inch, tuple) and len(per_inch) > 0 and float(per_inch[0]) > 0
    return Raw(pixels, credible(0.0254 / float(per_inch[0])) if known and per_inch is not None else None)


def _gray(pixels: npt.NDArray[Any], path: Path) -> npt.NDArray[np.float32]:
    """Average the colors; a fourth one is transparency."""
    if pixels.ndim == 3 and pixels.shape[2] in (2, 3, 4):
        pixels = pixels[..., : 1 if pixels.shape[2] == 2 else 3].mean(axis=2)
    if pixels.ndim != 2 or pixels.size == 0:
        raise CaseError(f"{path} is no flat picture: its pixels are {' x '.join(map(str, pixels.shape))}")
    gray = pixels.astype(np.float32)
    if not np.isfinite(gray).all():
        raise CaseError(f"{path} has pixels that are no numbers")
    return gray
