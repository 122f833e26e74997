"""Fibers of known width, and what lies among them, in pictures that other code drew."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.errors import CaseError
from pipeline.micrograph.measure import measure
from pipeline.microscope.picture import Micrograph
from pipeline.microscope.strip import strip_rows
from tests.micrograph.drawn import Picture, bands

SHAPE = (360, 380)
NM = 1e-9


def taken(picture: Picture) -> Micrograph:
    return Micrograph(picture.astype(np.float32), 25 * NM, "drawn")


def with_blots(picture: Picture) -> Picture:
    """Add beads, and streaks of two rows."""
    random = np.random.default_rng(5)
    y, x = np.mgrid[: picture.shape[0], : picture.shape[1]]
    for _ in range(10):
        row, column, radius = random.uniform(20, 340), random.uniform(20, 360), random.uniform(10, 20)
        picture = np.where(((y - row) / radius) ** 2 + ((x - column) / (0.8 * radius)) ** 2 < 1, 0.95, picture)
    picture = picture.copy()
    picture[[60, 61, 200], :] = np.clip(picture[[60, 61, 200], :] + 0.5, 0, 1)
    picture[290:292, 150:] = 1.0
    return picture


@pytest.mark.parametrize("blots", [False, True])
def test_bands_of_one_width_are_measured_to_a_fiftieth_whatever_lies_among_them(blots: bool) -> None:
    picture = bands(np.full(9, 11.4), SHAPE, seed=3)
    measured = measure(taken(with_blots(picture) if blots else picture))
    # the target of docs/measuring.md is 3 %; bands without any shading are the easiest case
    assert measured.median.value == pytest.approx(11.4 * 25 * NM, rel=0.02)
    assert measured.mean.value == pytest.approx(11.4 * 25 * NM, rel=0.02)
    assert measured.std.value < 0.03 * measured.mean.value
    # a crossing may part a band in two, and hide its shorter part
    assert 6 <= measured.fibers <= 15


def test_dark_fibers_before_a_bright_ground_are_the_same_fibers() -> None:
    picture = bands(np.full(4, 12.0), (180, 200), seed=1)
    bright, dark = measure(taken(picture)), measure(taken(1.0 - picture))
    assert dark.mean.value == pytest.approx(bright.mean.value, rel=0.02)
    assert any("darker" in text for text in dark.warnings)


def test_noise_alone_is_no_fiber() -> None:
    noise = np.random.default_rng(0).normal(0.4, 0.08, (150, 150)).clip(0, 1)
    with pytest.raises(CaseError, match="no fiber was found"):
        measure(taken(noise))


def test_fibers_of_too_few_pixels_are_told_with_what_would_do() -> None:
    with pytest.raises(
        CaseError, match=r"too few pixels per fiber: half of the \d+ .* 6 are needed; take it at a larger"
    ):
        measure(taken(bands(np.full(5, 4.1), (150, 160), seed=3, blur=0.8, noise=0.02)))
    with pytest.raises(CaseError, match=r"no fiber was found .* at least 4 pixels wide"):
        measure(taken(bands(np.full(4, 2.0), (120, 130), seed=1)))


def test_directions_are_from_the_right_upward() -> None:
    # all bands rise to the right by 30 degrees, which is down the rows of an array
    measured = measure(taken(bands(np.full(5, 10.0), (240, 260), seed=2, angles=np.full(5, np.radians(30)))))
    assert measured.orientation.law == "von_mises"
    assert measured.orientation.axis == pytest.approx(30, abs=2)


@pytest.mark.parametrize("upper", [False, True])
def test_the_strip_below_or_above_is_no_picture(upper: bool) -> None:
    picture = bands(np.full(6, 10.0), (300, 300), seed=4)
    strip = np.zeros((40, 300))
    strip[12:18, 30:130] = 1.0
    strip[25:32, 150:280:5] = 1.0
    whole = np.concatenate([strip, picture] if upper else [picture, strip])
    first, last = strip_rows(whole.astype(np.float32))
    assert (first, last) == ((40, 340) if upper else (0, 300))
    # and a picture without one loses no row
    assert strip_rows(picture.astype(np.float32)) == (0, 300)
