"""Gray voxels from a stack of TIFFs, a TIFF of many pages, ``.npy`` or ``.raw``, of which only the window is read."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import logging
import math
import re
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pipeline.errors import CaseError
from pipeline.line.store import DAMAGE
from pipeline.reading import open_file

LARGEST = 500_000_000
"""Voxels of a window beyond which it is refused."""
MEMORY_PER_VOXEL = 14
"""Bytes that a voxel of the window takes while the surface is made: as gray, smoothed, solid and label."""
_TIFF_SUFFIXES = (".tif", ".tiff")
_NUMBERS = "buif"  # kinds of numpy's types that are gray values
_DAMAGE = (*DAMAGE, AttributeError, SyntaxError, zlib.error)

Window = tuple[int, int, int, int, int, int]
Gray = npt.NDArray[Any]


def read_voxels(
    path: Path, window: Window | None = None, shape: tuple[int, int, int] | None = None, kind: str = "uint8"
) -> Gray:
    """Read the gray values of a tomogram.

    Parameters
    ----------
    path : Path
        A folder of TIFFs, one per slice; a TIFF of many pages; ``.npy``; or ``.raw``.
    window : (x0, y0, z0, x1, y1, z1), optional
        Voxels to read, the upper ones not included.
    shape : (x, y, z), optional
        Of a ``.raw`` file, whose x runs fastest.
    kind : str
        Numbers of a ``.raw`` file, as numpy names them: uint8, <u2, >u2, float32.

    Returns
    -------
    (x, y, z) array
        Slices are planes of z.

    Raises
    ------
    CaseError
        If the file cannot be read, a slice is missing or differs from the others, the shape does not fit the file, or
        the window is too large.
    """
    if path.is_dir():
        return _of_slices(path, window)
    if not path.is_file():
        raise CaseError(f"cannot read the tomogram {path}: there is no such file or folder")
    suffix = path.suffix.lower()
    if suffix == ".npy":
        return _of_array(_numpy(path), window, path)
    if suffix == ".raw":
        return _of_array(_raw(path, shape, kind), window, path)
    if suffix in _TIFF_SUFFIXES:
        return _of_pages(path, window)
    raise CaseError(f"{path}: a tomogram is a folder of TIFFs, or a file .tif, .npy or .raw")


def _numpy(path: Path) -> Gray:
    with _damage_told(f"{path} is damaged, or no array of numbers"):
        array: Gray = np.load(path, mmap_mode="r", allow_pickle=False)
    if array.ndim != 3:
        raise CaseError(f"{path} has {array.ndim} dimensions, and a tomogram has three")
    # as scikit-image and tifffile have it: slices first
    return array.transpose(2, 1, 0)


def _raw(path: Path, shape: tuple[int, int, int] | None, kind: str) -> Gray:
    if shape is None:
        raise CaseError(f"{path}: a .raw file does not tell its shape; give it, as --shape 512,512,300")
    try:
        number = np.dtype(kind)
    except (TypeError, ValueError, SyntaxError):
        number = np.dtype(object)
    if number.kind not in _NUMBERS:
        raise CaseError(f"--kind {kind!r}: write uint8, <u2 (little endian), >u2 (big endian) or float32")
    wanted, there = math.prod(shape) * number.itemsize, path.stat().st_size
    if wanted != there:
        raise CaseError(
            f"{path} has {there:,} bytes, and {' x '.join(map(str, shape))} voxels of {number.name} take {wanted:,}: "
            "check --shape and --kind"
        )
    mapped: Gray = np.memmap(path, number, "r", shape=shape, order="F")
    return mapped


def _of_array(array: Gray, window: Window | None, path: Path) -> Gray:
    if array.dtype.kind not in _NUMBERS:
        raise CaseError(f"{path} holds {array.dtype}, and a tomogram gray values: whole numbers, or float32")
    x0, y0, z0, x1, y1, z1 = _checked(window, array.shape, path)
    return np.ascontiguousarray(array[x0:x1, y0:y1, z0:z1])


@contextlib.contextmanager
def _damage_told(words: str) -> Iterator[None]:
    """Tell in one error what a damaged file makes of numpy and tifffile."""
    try:
        yield
    except _DAMAGE as problem:
        raise CaseError(f"{words}: {problem}") from problem


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Open a TIFF, without what tifffile logs of its damage: what it raises is told."""
    import tifffile

    logging.getLogger("tifffile").setLevel(logging.CRITICAL)
    # a pipe or a device is refused; tifffile wants the name
    open_file(path).close()
    with tifffile.TiffFile(path) as file:
        yield file


def _gray(page: Any, path: Path) -> Gray:
    """Read a page, unless it claims to be larger than any slice may be: a compressed one may say anything."""
    if math.prod(page.shape) > LARGEST:
        raise CaseError(f"{path} claims a slice of {' x '.join(map(str, page.shape[::-1]))} pixels")
    pixels: Gray = page.asarray()
    return pixels


def _of_pages(path: Path, window: Window | None) -> Gray:
    with _damage_told(f"{path} is damaged, or no TIFF that can be read"), _opened(path) as file:
        pages = file.pages
        first = pages[0]
        size = (int(first.shape[1]), int(first.shape[0]), len(pages))
        x0, y0, z0, x1, y1, z1 = _checked(window, size, path)
        return _stacked(lambda z: _gray(pages[z], path)[y0:y1, x0:x1], range(z0, z1), path)


def _of_slices(folder: Path, window: Window | None) -> Gray:
    numbered = sorted(
        (int(numbers[-1]), file)
        for file in folder.iterdir()
        if file.suffix.lower() in _TIFF_SUFFIXES and (numbers := re.findall(r"\d+", file.stem))
    )
    if not numbered:
        raise CaseError(f"{folder} holds no TIFF whose name ends in a number")
    there = [number for number, _ in numbered]
    missing = sorted(set(range(there[0], there[-1] + 1)) - set(there))
    if missing:
        raise CaseError(
            f"{folder} lacks {len(missing)} of its slices {there[0]} to {there[-1]}, first {missing[0]}: "
            "a gap would make the mat thinner"
        )
    if len(set(there)) < len(there):
        raise CaseError(f"{folder} has two files for one slice; keep one stack in the folder")
    files = [file for _, file in numbered]

    def slice_of(z: int) -> Gray:
        with _opened(files[z]) as file:
            return _gray(file.pages[0], files[z])

    with _damage_told(f"a slice of {folder} is damaged, or no TIFF that can be read"):
        with _opened(files[0]) as file:
            first = file.pages[0]
            size = (int(first.shape[1]), int(first.shape[0]), len(files))
        x0, y0, z0, x1, y1, z1 = _checked(window, size, folder)
        return _stacked(lambda z: slice_of(z)[y0:y1, x0:x1], range(z0, z1), folder)


def _stacked(slice_of: Callable[[int], Gray], numbers: range, path: Path) -> Gray:
    first = slice_of(numbers[0])
    if first.ndim != 2 or first.dtype.kind not in _NUMBERS:
        raise CaseError(f"{path}: slice {numbers[0]} has colors; a tomogram has one gray value per voxel")
    whole = np.empty((first.shape[1], first.shape[0], len(numbers)), first.dtype)
    for k, number in enumerate(numbers):
        one = slice_of(number)
        if one.shape != first.shape or one.dtype != first.dtype:
            raise CaseError(
                f"{path}: slice {number} has {one.shape[::-1]} pixels of {one.dtype}, the ones before "
                f"{first.shape[::-1]} of {first.dtype}"
            )
        whole[:, :, k] = one.T
    return whole


def _checked(window: Window | None, size: tuple[int, ...], path: Path) -> Window:
    x0, y0, z0, x1, y1, z1 = window or (0, 0, 0, *size[:3])
    for low, high, end, name in ((x0, x1, size[0], "x"), (y0, y1, size[1], "y"), (z0, z1, size[2], "z")):
        if not 0 <= low < high <= end:
            raise CaseError(
                f"--window: {low} to {high} along {name} is no part of {path}, which has "
                f"{size[0]} x {size[1]} x {size[2]} voxels; write x0,y0,z0,x1,y1,z1"
            )
    voxels = (x1 - x0) * (y1 - y0) * (z1 - z0)
    if voxels > LARGEST:
        raise CaseError(
            f"{path}: {voxels / 1e6:.0f} million voxels would take {voxels * MEMORY_PER_VOXEL / 2**30:.0f} GiB; "
            f"take a part of at most {LARGEST / 1e6:.0f} million with --window x0,y0,z0,x1,y1,z1"
        )
    return x0, y0, z0, x1, y1, z1
