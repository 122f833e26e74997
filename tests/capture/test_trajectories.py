"""Whole ways through ducts with known flows."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.capture.capture import pace_of
from pipeline.capture.contact import fiber_grid
from pipeline.capture.intervals import share_interval
from pipeline.capture.langevin import Motion
from pipeline.capture.trajectories import CAPTURED, PASSED, TIMED_OUT, Duct, tracked
from validation.closed_flows import (
    between_plates,
    brick,
    half_ring,
    kuwabara,
    kuwabara_interception,
    on_rim,
    plate_starts,
    sampled,
)
from validation.exact_capture import plates_penetration


@pytest.mark.parametrize("ratio", [0.1, 0.3])
def test_interception_in_kuwabaras_flow_is_exact_to_half_a_percent(ratio: float) -> None:
    solidity, count = 0.1, 1000
    outer, exact = solidity**-0.5, kuwabara_interception(solidity, ratio)
    points, tets = half_ring(outer, 0.3, (16, 32))
    cells = sampled(points, tets, kuwabara(solidity), on_rim(outer))
    axis = np.array([[0.0, -5.0, 0.0]])
    grid = fiber_grid(axis, -axis, np.ones(1), np.zeros((1, 2), bool), points.min(0), points.max(0), 2.0)
    duct = Duct(0.0, 10.0, 0.0, 0.3, -10.0, outer, False)
    # the flux through the cell's rim is even over x; twice the strip that must be caught
    x = (np.arange(count) + 0.5) / count * 2 * exact
    starts = np.column_stack([x, np.full(count, 0.15), -np.sqrt(outer**2 - x**2)])
    motion = Motion(ratio, 0.0, 0.0, 0.0, 0.0, 0.0)
    fates = tracked(starts, 0, 1, 0, motion, duct, pace_of(1.0, False, 1e4), cells, grid)
    assert (fates.outcome == CAPTURED).mean() * 2 * exact == pytest.approx(exact, rel=5e-3)
    assert (fates.outcome != TIMED_OUT).all()


def test_graetz_penetration_between_plates() -> None:
    # plates are fibers of radius 5000: over the duct's width of .2 they bend by 1e-6
    length, diffusivity, count, radius = 40.0, 0.02, 4000, 5000.0
    cells = sampled(*brick(np.array([-1.0, 0, 0]), np.array([1.0, 0.2, length]), (4, 1, 40)), between_plates)
    x = np.array([-1.0 - radius, 1.0 + radius])
    start = np.column_stack([x, np.full(2, 0.1), np.full(2, -10.0)])
    end = start + np.array([0.0, 0.0, length + 20.0])
    grid = fiber_grid(
        start,
        end,
        np.full(2, radius),
        np.zeros((2, 2), bool),
        np.array([-1.0, 0, 0]),
        np.array([1.0, 0.2, length]),
        1.0,
    )
    starts = plate_starts(count)
    duct = Duct(-2.0, 2.0, 0.0, 0.2, 0.0, length, False)
    motion = Motion(0.0, 0.0, diffusivity, 0.0, 0.0, 0.0)
    fates = tracked(starts, 0, 1, 0, motion, duct, pace_of(1.0, True, 1e4), cells, grid)
    passed = int((fates.outcome == PASSED).sum())
    low, high = share_interval(passed, count)
    # Pe of 50: diffusion along the flow, which the series leaves out, is worth .1 %
    assert abs(passed / count - plates_penetration(diffusivity * length)) < 1.5 * (high - low)


def test_walls_reflect_and_wrap() -> None:
    # gravity across the flow carries a particle 1.5 widths sideways
    cells = sampled(
        *brick(np.zeros(3), np.array([1.0, 1.0, 4.0]), (1, 1, 4)), lambda p: np.tile([0.0, 0.0, 1.0], (len(p), 1))
    )
    far = np.array([[-50.0, 0.0, 0.0]])
    grid = fiber_grid(far, far + 1.0, np.ones(1), np.zeros((1, 2), bool), np.zeros(3), np.array([1.0, 1.0, 4.0]), 0.5)
    start = np.array([[0.2, 0.5, 0.0]])
    motion = Motion(0.0, 0.0, 0.0, 1.5 / 4.0, 0.0, 0.0)
    for wraps, x in ((False, 0.3), (True, 0.7)):
        duct = Duct(0.0, 1.0, 0.0, 1.0, 0.0, 4.0, wraps)
        fates = tracked(start, 0, 1, 0, motion, duct, pace_of(1.0, False, 1e3), cells, grid)
        assert fates.outcome[0] == PASSED
        # it went on beyond the outlet, to the end of its last step
        beyond = (fates.time[0] - 4.0) * 0.375
        assert fates.place[0, 0] == pytest.approx(x - beyond if not wraps else x + beyond, abs=1e-9)
