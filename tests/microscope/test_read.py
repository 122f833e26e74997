"""Pictures as microscopes write them."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from PIL import Image

from pipeline.errors import CaseError
from pipeline.microscope.read import read_micrograph
from tests.micrograph.drawn import as_bytes, bands

PICTURE = bands(np.full(5, 10.0), (120, 140), seed=1)
BYTES = as_bytes(PICTURE)


def test_every_kind_of_file_gives_the_same_picture(tmp_path: Path) -> None:
    wide = BYTES.astype(np.uint16) * 257
    files: dict[str, Any] = {
        "eight.tif": lambda path: tifffile.imwrite(path, BYTES),
        "sixteen.tif": lambda path: tifffile.imwrite(path, wide),
        "big_endian.tif": lambda path: tifffile.imwrite(path, wide, byteorder=">"),
        "pages.tif": lambda path: tifffile.imwrite(path, np.stack([BYTES, 255 - BYTES]), photometric="minisblack"),
        "color.tif": lambda path: tifffile.imwrite(path, np.repeat(BYTES[..., None], 3, axis=2), photometric="rgb"),
        "floats.tif": lambda path: tifffile.imwrite(path, BYTES.astype(np.float32)),
        "packed.tif": lambda path: Image.fromarray(BYTES).save(path, compression="tiff_lzw"),
        "gray.png": lambda path: Image.fromarray(BYTES).save(path),
        "color.png": lambda path: Image.fromarray(BYTES).convert("RGBA").save(path),
    }
    for name, write in files.items():
        write(tmp_path / name)
    pictures = {name: read_micrograph(tmp_path / name, 1e-8).brightness for name in files}
    for name, picture in pictures.items():
        # stretched from the darkest pixel to the brightest but a thousandth: the kind of number cancels
        np.testing.assert_allclose(picture, pictures["gray.png"], atol=1e-5, err_msg=name)


def test_the_scale_is_read_where_a_microscope_wrote_it(tmp_path: Path) -> None:
    ome = '<OME><Pixels PhysicalSizeX="25" PhysicalSizeXUnit="nm"/></OME>'
    tifffile.imwrite(tmp_path / "ome.tif", BYTES, description=ome)
    tifffile.imwrite(tmp_path / "imagej.tif", BYTES, imagej=True, resolution=(40, 40), metadata={"unit": "um"})
    # 400,000 pixels per centimeter
    tifffile.imwrite(tmp_path / "resolution.tif", BYTES, resolution=(400_000, 400_000), resolutionunit=3)
    for name in ("ome.tif", "imagej.tif", "resolution.tif"):
        assert read_micrograph(tmp_path / name).pixel == pytest.approx(25e-9), name
    # what is said on the command line counts more than what the file says
    assert read_micrograph(tmp_path / "ome.tif", 30e-9).pixel == 30e-9


def test_the_bar_tells_the_scale(tmp_path: Path) -> None:
    strip = np.zeros((20, 140), np.uint8)
    strip[8:11, 20:70] = 255
    Image.fromarray(np.concatenate([BYTES, strip])).save(tmp_path / "bar.png")
    # the bar has 50 pixels
    assert read_micrograph(tmp_path / "bar.png", bar=2e-6).pixel == pytest.approx(40e-9)


def test_bad_files_are_told_in_one_sentence(tmp_path: Path) -> None:
    def refused(content: bytes | np.ndarray[Any, Any], message: str, **options: Any) -> None:
        path = tmp_path / "picture.png"
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            Image.fromarray(content).save(path)
        with pytest.raises(CaseError, match=message) as trouble:
            read_micrograph(path, **options)
        assert "\n" not in str(trouble.value)

    good = tmp_path / "good.png"
    Image.fromarray(BYTES).save(good)
    refused(BYTES, "does not say how long a pixel is")
    # 72 dots per inch are no microscope's
    Image.fromarray(BYTES).save(tmp_path / "printer.png", dpi=(72, 72))
    with pytest.raises(CaseError, match="how long a pixel is"):
        read_micrograph(tmp_path / "printer.png")
    refused(b"", "is empty")
    refused(b"not a picture at all", "no picture", pixel=1e-8)
    refused(good.read_bytes()[:400], "damaged", pixel=1e-8)
    refused(b"II*\0" + bytes(40), "damaged|no TIFF|no picture", pixel=1e-8)
    refused(np.full((100, 100), 7, np.uint8), "shows nothing", pixel=1e-8)
    refused(BYTES[:30], "on a side are the least", pixel=1e-8)
    refused(BYTES, "no strip with a scale bar", bar=1e-6)
    refused(BYTES, "a window is", pixel=1e-8, window=(0, 0, 500, 100))
    with pytest.raises(CaseError, match="cannot read"):
        read_micrograph(tmp_path / "nowhere.png", 1e-8)
