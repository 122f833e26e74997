# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest

from pipeline.geometry.box import Box
from pipeline.nouns.fibers import Mat
from pipeline.pictures.panels import contact_sheet, duct_figure, mat_figure, write_png
from pipeline.pictures.render import plan_view

MICRO = 1e-6


@pytest.fixture(name="rod")
def _rod() -> Mat:
    # one fiber of 2 um along x, in the middle of a slab of 10 x 10 x 4 um
    nodes = MICRO * np.array([[0.0, 5.0, 1.0], [10.0, 5.0, 1.0]])
    slab = Box((0.0, 0.0, 0.0), (10 * MICRO, 10 * MICRO, 4 * MICRO))
    return Mat(nodes, np.array([0, 2]), np.array([MICRO]), slab, -1, "by hand")


def covered(pixels: np.ndarray[tuple[int, ...], np.dtype[np.uint8]]) -> np.ndarray[tuple[int, ...], np.dtype[np.bool]]:
    return np.asarray((pixels < 250).any(axis=2))


def test_a_picture_from_above_is_to_scale(rod: Mat) -> None:
    image = plan_view(rod, "top", 200)
    assert image.extent == pytest.approx((0.0, 10.0, 0.0, 10.0))
    # 2 of 10 um are fiber, and a pixel more or less at each of its edges
    assert covered(image.pixels).mean() == pytest.approx(0.2, abs=2 / 200)


def test_a_picture_from_the_side_has_the_ground_below(rod: Mat) -> None:
    image = plan_view(rod, "side", 200)
    rows = covered(image.pixels).mean(axis=1)
    assert len(rows) == 80
    # the fiber fills the lower half of the slab
    assert rows[45:].min() > 0.95
    assert rows[:35].max() < 0.05


def test_figures_become_small_files(rod: Mat, tmp_path: Path) -> None:
    duct = Box((0.0, 0.0, -5 * MICRO), (10 * MICRO, 10 * MICRO, 9 * MICRO))
    figures = {
        "top": mat_figure(rod, "top", "from above", pixels=200),
        "duct": duct_figure(rod, duct, size=(200, 240)),
        "sheet": contact_sheet([rod, rod], ["a", "b"], "side", pixels=160),
    }
    for name, figure in figures.items():
        write_png(figure, tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 1000


def test_the_same_mat_gives_the_same_file(rod: Mat, tmp_path: Path) -> None:
    for name in ("first.png", "second.png"):
        write_png(mat_figure(rod, "side", pixels=160), tmp_path / name)
    assert (tmp_path / "first.png").read_bytes() == (tmp_path / "second.png").read_bytes()
