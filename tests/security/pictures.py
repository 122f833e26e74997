"""Pictures and tomograms of strangers: damaged files, numbers that are no gray values, pipes and links among slices."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import tifffile
from hypothesis import strategies as st
from PIL import Image

from pipeline.line.places import remove
from pipeline.microscope.read import read_micrograph
from pipeline.tomography.read import read_voxels
from pipeline.tomography.solid import segment
from tests.security.inputs import damaged, folder, refused_or_read

_SIZE = (72, 80)


@cache
def pictures() -> dict[str, bytes]:
    """Give valid pictures in what microscopes write, by their names."""
    gray = np.random.default_rng(0).integers(0, 255, _SIZE, np.uint8)
    place = folder() / "pictures"
    place.mkdir()
    Image.fromarray(gray).save(place / "gray.png", dpi=(1e6, 1e6))
    Image.fromarray(gray).convert("P").save(place / "palette.png")
    Image.fromarray(gray).save(place / "lzw.tif", compression="tiff_lzw")
    tifffile.imwrite(place / "big.tif", gray.astype(">u2"), byteorder=">", resolution=(1e7, 1e7))
    tifffile.imwrite(place / "float.tif", gray.astype(np.float32), description="<MetaData>", bigtiff=True)
    tifffile.imwrite(place / "color.tif", np.repeat(gray[..., None], 3, axis=2), photometric="rgb", rowsperstrip=8)
    tifffile.imwrite(place / "zlib.tif", gray, compression="zlib")
    return {path.name: path.read_bytes() for path in sorted(place.iterdir())}


def picture(draw: st.DataObject) -> None:
    name = draw.draw(st.sampled_from(sorted(pictures())))
    path = folder() / f"input-{name}"
    path.write_bytes(damaged(draw, pictures()[name]))
    window = draw.draw(st.sampled_from([None, (0, 0, 70, 70), (-1, 0, 3, 3), (0, 0, 10**30, 5)]))
    with refused_or_read():
        read_micrograph(path, 25e-9, None, window)


@cache
def tomograms() -> dict[str, bytes]:
    """Give valid tomograms of one file, by their names."""
    gray = np.random.default_rng(0).integers(0, 255, (4, 5, 6), np.uint8)
    place = folder() / "tomograms"
    place.mkdir()
    tifffile.imwrite(place / "pages.tif", gray, photometric="minisblack")
    tifffile.imwrite(place / "zlib.tif", gray.astype(np.uint16), photometric="minisblack", compression="zlib")
    np.save(place / "voxels.npy", gray.astype(np.float32))
    gray.tofile(place / "voxels.raw")
    return {path.name: path.read_bytes() for path in sorted(place.iterdir())}


def tomogram(draw: st.DataObject) -> None:
    name = draw.draw(st.sampled_from(sorted(tomograms())))
    path = folder() / f"input-{name}"
    path.write_bytes(damaged(draw, tomograms()[name]))
    with refused_or_read():
        segment(read_voxels(path, None, (6, 5, 4)))


def odd_voxels(draw: st.DataObject) -> None:
    """Give numbers that are no gray values: texts, dates, records, complex ones, none at all."""
    kinds = ["O", "U3", "S2", "M8[s]", "m8[s]", "c16", "?", "V4", "i4,f8", "f2", ">f8", "i8", "u8", "x", "", "f8,"]
    kind = draw.draw(st.sampled_from(kinds))
    shape = draw.draw(st.sampled_from([(4, 5, 6), (0, 5, 6), (4, 1, 1), (4, 5), (), (2, 2, 2, 2)]))
    if draw.draw(st.booleans()):
        path = folder() / "odd.npy"
        try:
            array = np.zeros(shape, kind)
        except TypeError:
            return
        if array.dtype.kind == "f" and array.size and draw.draw(st.booleans()):
            array.reshape(-1)[0] = draw.draw(st.sampled_from([np.nan, np.inf, 6e4]))
        np.save(path, array, allow_pickle=True)
        with refused_or_read():
            segment(read_voxels(path))
    else:
        path = folder() / "odd.raw"
        path.write_bytes(bytes(draw.draw(st.sampled_from([0, 120, 240, 480, 960, 1920]))))
        with refused_or_read():
            segment(read_voxels(path, None, (4, 5, 6), kind))


def stack(draw: st.DataObject) -> None:
    """Put something else in the place of slices of a stack."""
    place = folder() / "stack"
    remove(place)
    place.mkdir()
    for number in range(4):
        tifffile.imwrite(place / f"slice-{number}.tif", np.full((5, 6), number, np.uint8), photometric="minisblack")
    for _ in range(draw.draw(st.integers(1, 3))):
        hit = place / f"slice-{draw.draw(st.integers(0, 4))}.tif"
        before = hit.read_bytes() if hit.is_file() else b"II*\0"
        remove(hit)
        match draw.draw(st.sampled_from(["damage", "pipe", "device", "folder", "nothing", "itself", "gone", "empty"])):
            case "damage":
                hit.write_bytes(damaged(draw, before))
            case "pipe":
                os.mkfifo(hit)
            case "device":
                hit.symlink_to("/dev/zero")
            case "folder":
                hit.mkdir()
            case "nothing":
                hit.symlink_to("nothing")
            case "itself":
                hit.symlink_to(hit)
            case "empty":
                hit.write_bytes(b"")
    with refused_or_read():
        read_voxels(place)


def not_a_file(draw: st.DataObject) -> None:
    """Name something that is no file, by any suffix."""
    path: Path = folder() / f"odd{draw.draw(st.sampled_from(['.tif', '.png', '.npy', '.raw']))}"
    remove(path)
    match draw.draw(st.sampled_from(["pipe", "device", "folder", "nothing", "empty"])):
        case "pipe":
            os.mkfifo(path)
        case "device":
            path.symlink_to("/dev/zero")
        case "folder":
            path.mkdir()
        case "nothing":
            path.symlink_to("nothing")
        case _:
            path.write_bytes(b"")
    for read in (lambda: read_micrograph(path, 1e-8), lambda: read_voxels(path, None, (4, 5, 6))):
        with refused_or_read():
            read()


TARGETS: dict[str, Callable[[st.DataObject], None]] = {
    "picture (TIFF, PNG), damaged": picture,
    "tomogram (TIFF, .npy, .raw), damaged": tomogram,
    "tomogram of other numbers": odd_voxels,
    "slices of a tomogram": stack,
    "picture or tomogram that is no file": not_a_file,
}
