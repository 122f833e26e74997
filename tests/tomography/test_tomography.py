"""Tomograms of mats that we know: the same solid comes back, from every kind of file."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import json
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile

from pipeline.case import read_case
from pipeline.cli.app import main
from pipeline.errors import CaseError
from pipeline.geometry.triangles import enclosed_volume, unmatched_edges
from pipeline.tomography.contour import surface_of
from pipeline.tomography.read import read_voxels
from pipeline.tomography.solid import Solid, segment

UM = 1e-6


def crossed(voxels: int) -> Solid:
    """Two crossing fibers of 1 um in a window of 5 x 5 x 3 um, at so many voxels per diameter."""
    x, y, z = (np.arange(n * voxels)[:] + 0.5 for n in (5, 5, 3))
    x, y, z = np.meshgrid(x / voxels, y / voxels, z / voxels, indexing="ij")
    return ((y - 2.2) ** 2 + (z - 1.0) ** 2 < 0.25) | ((x - 0.3 * y - 1.7) ** 2 / 1.09 + (z - 1.7) ** 2 < 0.25)


def gray_of(solid: Solid, noise: float = 12.0) -> np.ndarray[Any, np.dtype[np.uint8]]:
    random = np.random.default_rng(0)
    return (60 + 110 * solid + noise * random.standard_normal(solid.shape)).clip(0, 255).astype(np.uint8)


@pytest.mark.parametrize("voxels", [8, 14])
def test_the_surface_has_the_volume_and_the_area_of_the_fibers(voxels: int) -> None:
    solid = crossed(voxels)
    found = segment(gray_of(solid), smallest=20)
    # the classes lie nine deviations apart: hardly a voxel is told wrong
    assert np.mean(found.solid != solid) < 1e-3
    points, triangles = surface_of(found.solid, UM / voxels)
    assert unmatched_edges(triangles) == 0
    volume = enclosed_volume(points, triangles)
    assert volume == pytest.approx(solid.sum() * (UM / voxels) ** 3, rel=2e-3)
    # the window's sides are flat
    assert points.min() == 0
    assert (points.max(axis=0)[:2] == 5 * UM).all()


def test_islands_and_pores_below_a_size_are_left_out() -> None:
    solid = crossed(10)
    gray = gray_of(solid, noise=0)
    gray[2:4, 2:4, 25:27] = 250
    gray[22, 22, 10] = 60
    found = segment(gray, smallest=30)
    assert (found.islands, found.pores) == (8, 1)
    assert (found.solid == solid).all()


def test_every_kind_of_file_gives_the_same_voxels(tmp_path: Path) -> None:
    gray = gray_of(crossed(6))
    slices = gray.transpose(2, 1, 0)
    folder = tmp_path / "stack"
    folder.mkdir()
    for k, one in enumerate(slices):
        tifffile.imwrite(folder / f"slice_{k:03d}.tif", one)
    tifffile.imwrite(tmp_path / "pages.tif", slices, photometric="minisblack")
    np.save(tmp_path / "whole.npy", slices)
    slices.tofile(tmp_path / "whole.raw")
    for name in ("stack", "pages.tif", "whole.npy", "whole.raw"):
        shape = gray.shape if name.endswith("raw") else None
        np.testing.assert_array_equal(read_voxels(tmp_path / name, shape=shape), gray, err_msg=name)
        part = read_voxels(tmp_path / name, (1, 2, 3, 9, 12, 10), shape)
        np.testing.assert_array_equal(part, gray[1:9, 2:12, 3:10], err_msg=name)
    slices.astype(">u2").tofile(tmp_path / "big.raw")
    np.testing.assert_array_equal(read_voxels(tmp_path / "big.raw", None, gray.shape, ">u2"), gray)


def test_bad_tomograms_are_told_in_one_sentence(tmp_path: Path) -> None:
    gray = gray_of(crossed(4))
    folder = tmp_path / "stack"
    folder.mkdir()
    for k, one in enumerate(gray.transpose(2, 1, 0)):
        tifffile.imwrite(folder / f"{k}.tif", one)
    (folder / "5.tif").unlink()
    with pytest.raises(CaseError, match="lacks 1 of its slices 0 to 11, first 5"):
        read_voxels(folder)
    tifffile.imwrite(folder / "5.tif", gray[:5, :5, 0])
    with pytest.raises(CaseError, match="slice 5 has"):
        read_voxels(folder)
    (tmp_path / "a.raw").write_bytes(bytes(1000))
    with pytest.raises(CaseError, match="does not tell its shape"):
        read_voxels(tmp_path / "a.raw")
    with pytest.raises(CaseError, match=r"1,000 bytes.*take 990"):
        read_voxels(tmp_path / "a.raw", shape=(9, 10, 11))
    np.save(tmp_path / "flat.npy", gray[0])
    with pytest.raises(CaseError, match="2 dimensions"):
        read_voxels(tmp_path / "flat.npy")
    np.save(tmp_path / "b.npy", gray)
    with pytest.raises(CaseError, match="is no part of"):
        read_voxels(tmp_path / "b.npy", (0, 0, 0, 99, 5, 5))
    with pytest.raises(CaseError, match="no such file"):
        read_voxels(tmp_path / "nowhere.npy")
    with pytest.raises(CaseError, match="are alike"):
        segment(np.full((9, 9, 9), 3))
    with pytest.raises(CaseError, match="give another --threshold"):
        segment(gray, threshold=1)
    with pytest.raises(CaseError, match="voxels thick"):
        surface_of(crossed(2), UM)


def test_of_ten_gigabytes_only_the_window_is_read(tmp_path: Path) -> None:
    # sparse: the disk holds what was written alone
    path, shape = tmp_path / "large.raw", (2500, 2000, 1000)
    part = gray_of(crossed(4))
    with path.open("wb") as file:
        file.truncate(2 * shape[0] * shape[1] * shape[2])
        for z in range(part.shape[2]):
            for y in range(part.shape[1]):
                file.seek(2 * (((900 + z) * shape[1] + 1500 + y) * shape[0] + 2000))
                file.write(part[:, y, z].astype("<u2").tobytes())
    window = (2000, 1500, 900, *(low + size for low, size in zip((2000, 1500, 900), part.shape, strict=True)))
    tracemalloc.start()
    try:
        found = read_voxels(path, (*window[:3], *window[3:]), shape, "<u2")
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    np.testing.assert_array_equal(found, part)
    assert peak < 20 * found.nbytes
    # the whole is refused before it is read, with what it would take
    with pytest.raises(CaseError, match=r"5000 million voxels would take \d+ GiB; .*--window"):
        read_voxels(path, None, shape, "<u2")


@pytest.mark.parametrize("mode", ["L", "I;16", "I;16B", "F"])
def test_pages_that_pillow_writes_are_read(mode: str, tmp_path: Path) -> None:
    from PIL import Image

    kind = {"L": "u1", "I;16": "<u2", "I;16B": ">u2", "F": "<f4"}[mode]
    gray = gray_of(crossed(4)).astype(kind)
    pages = [
        Image.frombytes(mode, (gray.shape[0], gray.shape[1]), np.ascontiguousarray(gray[:, :, z].T).tobytes())
        for z in range(gray.shape[2])
    ]
    pages[0].save(tmp_path / "a.tif", save_all=True, append_images=pages[1:])
    np.testing.assert_array_equal(read_voxels(tmp_path / "a.tif"), gray)


def test_a_stack_becomes_a_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    np.save("whole.npy", gray_of(crossed(8)).transpose(2, 1, 0))
    words = ["tomography", "whole.npy", "--voxel", "125 nm", "--json", "--case", "a.toml"]
    monkeypatch.setattr("sys.argv", ["fibertwin", *words])
    with contextlib.suppress(SystemExit):
        main()
    told = json.loads(capsys.readouterr().out)
    assert told["solidity"]["surface"] == pytest.approx(told["solidity"]["voxels"], rel=2e-3)
    # cylinders of 1 um: 4 V / S; where they cross, more of the surface is hidden than of the volume
    assert told["mean_diameter"] == pytest.approx(UM, rel=0.07)
    case = read_case(Path("a.toml"))
    assert case.mat.generator == "surface"
