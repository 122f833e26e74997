"""Pores of shapes whose size is known."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.tomography.pores import pores_of

UM = 1e-6


def tubes(*radii: float) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """A block with round tubes along z, side by side."""
    width = 40
    x, y = np.meshgrid(np.arange(width * len(radii)) + 0.5, np.arange(width) + 0.5, indexing="ij")
    solid = np.ones(x.shape, dtype=bool)
    for k, radius in enumerate(radii):
        # axes through the middles of voxels
        solid &= (x - (k + 0.5) * width - 0.5) ** 2 + (y - 0.5 * width - 0.5) ** 2 > radius**2
    return np.repeat(solid[:, :, None], 30, axis=2)


def test_the_widest_tube_is_the_bubble_point() -> None:
    pores = pores_of(tubes(5.0, 12.0), UM)
    # distances between voxels are known to a voxel
    assert pores.bubble_point == pytest.approx(24 * UM, abs=1.5 * UM)
    assert pores.largest == pytest.approx(24 * UM, abs=1.5 * UM)
    # the wide tube holds 144 / 169 of the air, so half of the air is reached by spheres of nearly its width
    assert pores.median == pytest.approx(24 * UM, abs=3 * UM)
    # and spheres that are wider than the narrow tube reach the wide one alone
    assert float(np.interp(14 * UM, pores.diameter, pores.share)) == pytest.approx(144 / 169, abs=0.04)


def test_a_throat_and_not_the_chamber_behind_it_is_the_bubble_point() -> None:
    solid = tubes(12.0)
    solid[:, :, 14:16] = tubes(4.0)[:, :, 14:16]
    assert pores_of(solid, UM).bubble_point == pytest.approx(8 * UM, abs=1.5 * UM)
    solid[:, :, 14] = True
    assert pores_of(solid, UM).bubble_point == 0
