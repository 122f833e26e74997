"""Streaks go, and fibers that run along the rows stay."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.micrograph.clean import without_streaks
from tests.micrograph.drawn import bands


@pytest.mark.parametrize("blur", [1.0, 2.0])
@pytest.mark.parametrize("width", [5.0, 6.0, 11.0])
def test_fibers_along_the_rows_are_no_streaks(width: float, blur: float) -> None:
    # from along the rows to where no streak would be looked for
    angles = np.radians([0.0, 0.4, 1.0, 2.0, 4.0, -1.5])
    for seed in range(3):
        picture = bands(np.full(6, width), (240, 300), seed, blur, 0.04, angles).astype(np.float32)
        cleaned, share = without_streaks(picture)
        assert share == 0.0, seed
        assert cleaned is picture


@pytest.mark.parametrize("rows", [1, 2, 3, 4])
def test_streaks_of_one_to_four_rows_go(rows: int) -> None:
    picture = bands(np.full(6, 10.0), (240, 300), 1, 1.0, 0.04).astype(np.float32)
    streaked = picture.copy()
    streaked[100 : 100 + rows, 80:] += 0.4
    cleaned, share = without_streaks(streaked)
    # a streak ends where a row does, or within half of what is averaged along it
    assert share == pytest.approx(rows * 220 / picture.size, rel=0.25)
    left = np.abs(cleaned - picture)[100 : 100 + rows, 80:].mean()
    # a median of nine rows stands in its place: noise of .04, and what a fiber's edge moves by in as many rows
    assert left < 0.1
