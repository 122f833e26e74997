"""The steps of a particle against Langevin's, Ornstein and Uhlenbeck's and Peters and Barenbrug's exact answers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import pytest

from pipeline.capture.intervals import share_interval
from validation.walks import closest_to_plane, fall, free_flight, inner_hits, survivors, tube_passages

# six standard deviations: a correct program fails once in a billion
_SIGMAS = 6.0


@pytest.mark.parametrize("dt", [0.05, 1.0, 20.0])
def test_mean_square_displacement_and_thermal_speed_hold_for_steps_of_any_length(dt: float) -> None:
    particles, steps, relaxation, diffusivity = 20_000, 4, 1.0, 0.5
    way, speed = free_flight(particles, steps, dt, relaxation, diffusivity, 3)
    time = steps * dt
    exact = 2 * diffusivity * (time - relaxation * -math.expm1(-time / relaxation))
    # a mean of squares of normal numbers scatters by sqrt(2/n)
    allowed = _SIGMAS * math.sqrt(2 / particles)
    assert (way**2).mean() == pytest.approx(exact, rel=allowed)
    assert (speed**2).mean() == pytest.approx(diffusivity / relaxation, rel=allowed)


def test_a_falling_particle_gains_speed_as_stokes_drag_lets_it_whatever_the_steps() -> None:
    assert fall(3, 0.7, 1.0, 0.2) == pytest.approx(0.2 * (1 - math.exp(-2.1)), rel=1e-12)
    assert fall(300, 0.007, 1.0, 0.2) == pytest.approx(0.2 * (1 - math.exp(-2.1)), rel=1e-12)


def test_inertia_carries_a_particle_onto_a_plane_only_above_a_quarter() -> None:
    # x'' tau + x' + k x = 0 is overdamped up to k tau = 1/4
    assert closest_to_plane(1.0, 0.24, 0.01, 3000) > 0
    assert closest_to_plane(1.0, 0.26, 0.01, 3000) < 0


def test_the_bridge_finds_contact_within_a_step_and_its_lack_costs_the_root_of_the_step() -> None:
    walkers, exact = 40_000, math.erf(1 / math.sqrt(2))
    scatter = math.sqrt(exact * (1 - exact) / walkers)
    for steps in (2, 10, 40):
        assert survivors(walkers, steps, True, 5) / walkers == pytest.approx(exact, abs=_SIGMAS * scatter)
    excess = [survivors(walkers, steps, False, 5) / walkers - exact for steps in (10, 160)]
    # sixteen times the steps, a quarter of the error; 4 +- 1.5 by scatter
    assert 2.5 < excess[0] / excess[1] < 6.5


@pytest.mark.parametrize(
    ("dimensions", "exact"),
    [(2, math.log(5 / 1.5) / math.log(5 / 1.1)), (3, 1.1 / 1.5 * (5 - 1.5) / (5 - 1.1))],
)
def test_a_particle_of_finite_size_meets_a_fiber_or_a_sphere_as_often_as_it_must(dimensions: int, exact: float) -> None:
    # radius 1, particles of radius .1 that start at 1.5, absorbed at 5: log and inverse potentials
    walkers = 20_000
    scatter = math.sqrt(exact * (1 - exact) / walkers)
    hits = inner_hits(walkers, 1.1, 5.0, 1.5, dimensions, 0.5, 0.1, True, 2)
    assert hits / walkers == pytest.approx(exact, abs=_SIGMAS * scatter)
    late = inner_hits(walkers, 1.1, 5.0, 1.5, dimensions, 0.5, 0.1, False, 2)
    assert late < hits


def test_graetz_penetration_of_a_tube() -> None:
    number, particles = 0.2, 20_000
    exact = 0.81905 * math.exp(-3.6568 * number) + 0.09753 * math.exp(-22.305 * number)
    passed = tube_passages(particles, number, 0.3, 0.05, 0.05, 1)
    low, high = share_interval(passed, particles)
    # three times the 95 % interval
    assert abs(passed / particles - exact) < 1.5 * (high - low)
