"""Random walks with exact answers, by the same steps that particles take through a filter."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.capture.contact import met_within
from pipeline.capture.langevin import moved, step_of
from pipeline.capture.random_numbers import normal_pair, stream, uniform
from pipeline.geometry.compiled import compiled
from pipeline.nouns.arrays import Floats


@compiled
def free_flight(
    particles: int, steps: int, dt: float, relaxation: float, diffusivity: float, seed: int
) -> tuple[Floats, Floats]:
    """Let particles at thermal speed move along one axis in resting air: how far each got, and its last velocity."""
    way, speed = np.zeros(particles), np.zeros(particles)
    step = step_of(dt, relaxation, diffusivity)
    for n in range(particles):
        key = stream(seed, 0, n)
        first, _ = normal_pair(key, 0)
        velocity = math.sqrt(diffusivity / relaxation) * first
        for k in range(steps):
            one, two = normal_pair(key, 2 * k + 2)
            moved_by, velocity = moved(velocity, 0.0, 0.0, dt, relaxation, step, one, two)
            way[n] += moved_by
        speed[n] = velocity
    return way, speed


@compiled
def fall(steps: int, dt: float, relaxation: float, terminal: float) -> float:
    """Velocity of a particle that starts at rest and falls."""
    step = step_of(dt, relaxation, 0.0)
    velocity = 0.0
    for _ in range(steps):
        _, velocity = moved(velocity, terminal, 0.0, dt, relaxation, step, 0.0, 0.0)
    return velocity


@compiled
def closest_to_plane(rate: float, relaxation: float, dt: float, steps: int) -> float:
    """Least distance of a particle that follows air toward a plane at velocity -rate x, from x = 1 with the air."""
    step = step_of(dt, relaxation, 0.0)
    x, velocity, least = 1.0, -rate, 1.0
    for _ in range(steps):
        way, _ = moved(velocity, -rate * x, 0.0, dt, relaxation, step, 0.0, 0.0)
        # the mean of here and there, as in the filter
        way, velocity = moved(velocity, -rate * x, -rate * way, dt, relaxation, step, 0.0, 0.0)
        x += way
        least = min(least, x)
    return least


@compiled
def survivors(particles: int, steps: int, bridged: bool, seed: int) -> int:
    """Of walkers that start 1 from a wall, with D = .5, those that have not met it after time 1."""
    count = 0
    step = step_of(1.0 / steps, 0.0, 0.5)
    for n in range(particles):
        key = stream(seed, 0, n)
        x, alive = 1.0, True
        for k in range(steps):
            one, _ = normal_pair(key, 4 * k)
            after = x + step.position * one
            if after <= 0.0 or (bridged and met_within(x, after, step.position**2, uniform(key, 4 * k + 2))):
                alive = False
            if not alive:
                break
            x = after
        count += alive
    return count


@compiled
def inner_hits(
    particles: int, inner: float, outer: float, start: float, dimensions: int, spread: float, nearest: float,
    bridged: bool, seed: int,
) -> int:  # fmt: skip
    """Of walkers between two circles or spheres, those that meet the inner one first; steps as in the filter."""
    hits = 0
    for n in range(particles):
        key = stream(seed, 0, n)
        x, y, z = start, 0.0, 0.0
        inside, outside = start - inner, outer - start
        for k in range(1_000_000):
            room = max(min(inside, outside), nearest)
            step = step_of(0.5 * (spread * room) ** 2, 0.0, 1.0)
            one, two = normal_pair(key, 6 * k)
            x, y = x + step.position * one, y + step.position * two
            if dimensions == 3:
                three, _ = normal_pair(key, 6 * k + 2)
                z += step.position * three
            r = math.sqrt(x * x + y * y + z * z)
            before, beyond = inside, outside
            inside, outside = r - inner, outer - r
            variance = step.position * step.position
            if inside <= 0.0 or (bridged and met_within(before, inside, variance, uniform(key, 6 * k + 4))):
                hits += 1
                break
            if outside <= 0.0 or (bridged and met_within(beyond, outside, variance, uniform(key, 6 * k + 5))):
                break
    return hits


@compiled
def tube_passages(particles: int, number: float, spread: float, nearest: float, way: float, seed: int) -> int:
    """Of point particles that enter a tube with its flow, those that pass; `number` is pi D L / Q.

    Radius, length and mean velocity are 1, so D is the number itself; it acts across the tube only, as in the series.
    """
    passed = 0
    for n in range(particles):
        key = stream(seed, 0, n)
        # flux within r is r^2 (2 - r^2)
        x, y, z = math.sqrt(1.0 - math.sqrt(1.0 - uniform(key, 0))), 0.0, 0.0
        gap = 1.0 - x
        for k in range(1, 1_000_000):
            room = max(gap, nearest)
            speed = 2.0 * (1.0 - x * x - y * y)
            dt = min((spread * room) ** 2 / (2.0 * number), way / max(speed, 1e-9))
            step = step_of(dt, 0.0, number)
            one, two = normal_pair(key, 6 * k)
            x, y = x + step.position * one, y + step.position * two
            r = math.sqrt(x * x + y * y)
            before, gap = gap, 1.0 - r
            after = 2.0 * (1.0 - r * r)
            z += 0.5 * (speed + after) * dt
            if gap <= 0.0 or met_within(before, gap, step.position**2, uniform(key, 6 * k + 4)):
                break
            if z >= 1.0:
                passed += 1
                break
    return passed
