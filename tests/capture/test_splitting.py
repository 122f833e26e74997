"""Penetrations too small to count, against Graetz' series and against counting."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.analytics.settings import FlowSettings
from pipeline.capture.capture import capture, pace_of
from pipeline.capture.contact import fiber_grid
from pipeline.capture.counting import Filter
from pipeline.capture.langevin import Motion
from pipeline.capture.settings import CaptureSettings
from pipeline.capture.splitting import split_penetration
from pipeline.capture.trajectories import Duct
from tests.capture.media import RADIUS, straight_fibers
from validation.closed_flows import between_plates, brick, sampled
from validation.exact_capture import plates_penetration


def test_a_penetration_of_one_in_two_thousand_is_found_by_layers_of_a_thousand_particles() -> None:
    length, diffusivity, radius = 40.0, 0.1, 5000.0
    lower, upper = np.array([-1.0, 0, 0]), np.array([1.0, 0.2, length])
    x = np.array([-1.0 - radius, 1.0 + radius])
    start = np.column_stack([x, np.full(2, 0.1), np.full(2, -10.0)])
    end = start + np.array([0.0, 0.0, length + 20.0])
    grid = fiber_grid(start, end, np.full(2, radius), np.zeros((2, 2), bool), lower, upper, 1.0)
    cells = sampled(*brick(lower, upper, (8, 1, 40)), between_plates)
    filter = Filter(Duct(-1.0, 1.0, 0.0, 0.2, 0.0, length, False), cells, grid, 1.5)
    planes = np.linspace(length / 6, length, 6)
    motion = Motion(0.0, 0.0, diffusivity, 0.0, 0.0, 0.0)
    found = split_penetration(filter, motion, pace_of(1.0, True, 1e4), 1, 1000, planes)
    assert found is not None
    # at a Peclet number of 10, diffusion along the flow lets a depth of 7.5 fall by 1.9 %: exp(.14)
    exact = plates_penetration(diffusivity * length) * np.exp(0.14)
    # twice the 95 % interval
    assert abs(np.log(found.penetration / exact)) < np.log(found.high / found.low)
    assert found.layers == 6


def test_where_enough_particles_pass_they_are_counted_and_where_few_do_layers_agree() -> None:
    air = FlowSettings(face_velocity=0.05)
    settings = CaptureSettings(particle_diameters=(20e-9,), particles=800, mechanisms=("diffusion", "interception"))
    many, _ = capture(straight_fibers(), settings, air)
    assert many.rare_penetration == (None,)
    # a fiber in every place leaves gaps of .1 um: little passes
    close = straight_fibers(x=tuple(np.arange(0.75e-6, 6e-6, 2.1 * RADIUS)))
    few, _ = capture(close, settings.model_copy(update={"particles": 700}), air)
    rare = few.rare_penetration[0]
    if rare is not None:
        assert few.passed[0] < 50
        assert rare.low < max(few.passed[0], 4) / few.released[0] * 2.5
    assert few.passed[0] < many.passed[0]
