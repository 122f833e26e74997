"""The width of one fiber to a fraction of a pixel, in pictures that its own cylinder made."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import pytest

from pipeline.geometry.box import Box
from pipeline.micrograph.profile import Optics, fitted, profiles
from pipeline.micrograph.trace import Trace
from pipeline.microscope.synthetic import Exposure, micrograph_of
from pipeline.nouns.fibers import Mat

UM = 1e-6
SIDE = 120
"""Pixels on a side."""


def across(width: float, angle: float, noise: float) -> tuple[Mat, Trace, Exposure]:
    """A fiber of 1 um through the middle, and its middle line."""
    pixel = UM / width
    way = np.array([math.cos(angle), math.sin(angle)])
    ends = [0.5 * SIDE * pixel * np.ones(2) + at * way for at in (-2 * SIDE * pixel, 2 * SIDE * pixel)]
    nodes = np.array([[*end, UM] for end in ends])
    box = Box((0, 0, 0), (SIDE * pixel, SIDE * pixel, 3 * UM))
    mat = Mat(nodes, np.array([0, 2]), np.array([0.5 * UM]), box, 0, "one fiber", False)
    steps = np.arange(-0.45 * SIDE, 0.45 * SIDE, 2.0)
    # pixel centers have whole numbers, and rows run downward
    points = 0.5 * SIDE - 0.5 + steps[:, None] * np.array([way[0], -way[1]])
    clear = np.ones(len(steps), dtype=bool)
    return mat, Trace(points, np.full(len(steps), 0.5 * width), clear, np.ones(len(steps))), Exposure(noise=noise)


@pytest.mark.parametrize("width", [5.0, 6.0, 9.3])
def test_a_fiber_is_as_wide_as_it_was_made(width: float) -> None:
    for degree in (7, 33, 77, 101):
        mat, trace, exposure = across(width, math.radians(degree), noise=0.002)
        (profile,) = profiles(micrograph_of(mat, UM / width, exposure).brightness, [trace])
        # no noise and no neighbors leave what sampling does: .2 % at 5 pixels
        assert 2.0 * fitted(profile, Optics(1.0, 1.0, 0.0)).half_width == pytest.approx(width, rel=3e-3), degree


def test_noise_moves_a_width_by_little_and_to_no_side() -> None:
    widths = []
    for degree in range(5, 180, 23):
        mat, trace, exposure = across(6.0, math.radians(degree), noise=0.1)
        (profile,) = profiles(micrograph_of(mat, UM / 6.0, exposure).brightness, [trace])
        widths.append(2.0 * fitted(profile, Optics(1.0, 1.0, 0.0)).half_width)
    # what a detector gives where nothing is seen, two deviations of its noise, is not taken for the fiber's light
    assert np.mean(widths) == pytest.approx(6.0, rel=0.02)
    assert np.std(widths) < 0.02 * 6.0
