"""Which fibers air meets first, and how much of the face they stand before."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.capture.first_row import first_row
from pipeline.geometry.box import Box
from pipeline.mat.array import array
from pipeline.mat.settings import ArraySettings
from pipeline.nouns.fibers import Mat


def test_the_first_row_of_arrays_and_its_projection() -> None:
    for arrangement, fibers in (("square", 1), ("hexagonal", 2)):
        settings = ArraySettings(arrangement=arrangement, solidity=0.1, fiber_diameter=1e-6, rows=3)  # type: ignore[arg-type]
        mat = array(settings)
        found = first_row(mat)
        assert found is not None
        first, area = found
        assert first.sum() == fibers
        # one fiber, or two halves in the side planes
        assert area == pytest.approx(1e-6 * mat.slab.size[1])


def test_a_mat_with_a_bend_or_a_slope_has_no_first_row() -> None:
    slab = Box((0.0, 0.0, 0.0), (10.0, 10.0, 4.0))
    for nodes in (
        np.array([[0, 5, 1], [5, 5, 2], [10, 5, 1.0]]),
        np.array([[0, 5, 1], [10, 5, 2.0]]),
    ):
        assert first_row(Mat(nodes, np.array([0, len(nodes)]), np.ones(1), slab, -1, "drawn")) is None
