"""The picture of a mat shows its fibers as wide as they are, where they are."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.microscope.synthetic import Exposure, look_down, micrograph_of
from pipeline.nouns.fibers import Mat

UM = 1e-6


def crossed(periodic: bool = False) -> Mat:
    """A fiber along x at y = 3 um, and a thinner one along y at x = 8 um that lies on it."""
    nodes = np.array([[0, 3, 1], [20, 3, 1], [8, 0, 2.5], [8, 10, 2.5]]) * UM
    return Mat(
        nodes,
        np.array([0, 2, 4]),
        np.array([1.0, 0.5]) * UM,
        Box((0, 0, 0), (20 * UM, 10 * UM, 3 * UM)),
        0,
        "two",
        periodic,
    )


def test_a_fiber_covers_as_many_pixels_as_it_is_wide_and_hides_what_lies_below() -> None:
    seen = look_down(crossed(), 0.05 * UM)
    assert seen.fiber.shape == (200, 400)
    # away from the crossing: 2 um and 1 um in pixels of 50 nm
    assert (seen.fiber[:, 20] == 0).sum() == 40
    assert (seen.fiber[20] == 1).sum() == 20
    # y = 3 um is 140 rows below the upper edge, where the thin one lies on top
    assert seen.fiber[140, 160] == 1
    assert seen.height[140, 159] == pytest.approx(3 * UM, rel=1e-3)


def test_deeper_is_darker_rims_are_brighter_and_nothing_is_dark() -> None:
    picture = micrograph_of(crossed(), 0.05 * UM, Exposure(depth=UM, edge=1.0, blur=0, noise=0)).brightness
    deep, high = picture[140, 20], picture[20, 160]
    # the tops lie 1 um apart, over which brightness falls by e
    assert deep / high == pytest.approx(np.exp(-1.0), rel=1e-2)
    assert picture[122, 20] > 1.2 * deep * np.exp(-0.9)
    assert picture[10, 20] == 0


def test_what_leaves_a_periodic_mat_enters_on_the_other_side() -> None:
    mat = crossed(periodic=True)
    moved = Mat(mat.nodes + np.array([0, 6.5 * UM, 0]), mat.first, mat.radius, mat.slab, 0, "moved", True)
    # the fiber along x now lies on the upper side: half of it shows above, half below
    seen = look_down(moved, 0.05 * UM).fiber[:, 20]
    assert (seen == 0).sum() == 40
    assert seen[0] == 0
    assert seen[-1] == 0


def test_too_many_pixels_are_refused() -> None:
    with pytest.raises(CaseError, match="pixels"):
        look_down(crossed(), 1e-10)
