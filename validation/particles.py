"""What particles do against exact answers: ``python -m validation.particles [RUN]`` prints the table in the docs.

RUN is a solved run of cases/verification/square.toml at solidity 0.1 without slip, for the rows of the array.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.analytics.settings import FilterSettings
from pipeline.capture.capture import Medium, filter_for, pace_of
from pipeline.capture.cells import Cells, cells_of
from pipeline.capture.concentration import concentration_penetration
from pipeline.capture.contact import FiberGrid, fiber_grid
from pipeline.capture.counting import counted
from pipeline.capture.intervals import share_interval
from pipeline.capture.langevin import Motion
from pipeline.capture.trajectories import CAPTURED, PASSED, Duct, tracked
from pipeline.line import store
from pipeline.nouns.arrays import Floats
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow_field import FlowField
from validation import closed_flows as flows
from validation.exact_capture import plates_penetration, tube_penetration
from validation.walks import closest_to_plane, fall, free_flight, inner_hits, survivors, tube_passages

PARTICLES = 100_000
_ROWS = ((1, 0.0, 0.15083), (1, 0.3, 0.08148), (10, 0.0, 0.75976), (10, 0.3, 0.67384))
"""Peclet number, particle over fiber diameter, and the exact penetration of one developed row."""


@dataclass(frozen=True, slots=True)
class Check:
    """One quantity: exact, found, and the 95 % interval of what was counted; None where nothing was counted."""

    what: str
    exact: float
    found: float
    low: float | None = None
    high: float | None = None

    def row(self) -> str:
        """Give the row of a table."""
        counted = "-" if self.low is None or self.high is None else f"{self.low:.5g} to {self.high:.5g}"
        return f"| {self.what} | {self.exact:.5g} | {self.found:.5g} | {counted} | {self.found / self.exact - 1:+.2%} |"


def share(what: str, exact: float, hits: int, trials: int) -> Check:
    """Make the check of a counted share."""
    return Check(what, exact, hits / trials, *share_interval(hits, trials))


def walks(particles: int = PARTICLES) -> Iterator[Check]:
    """Check the steps themselves."""
    way, speed = free_flight(particles, 20, 0.3, 1.0, 0.5, 1)
    spread = 1.96 * math.sqrt(2 / particles)
    for what, exact, values in (
        ("mean square displacement, 6 relaxation times", 6.0 - (1 - math.exp(-6.0)), way**2),
        ("mean square velocity over D/tau", 1.0, speed**2 / 0.5),
    ):
        mean = float(values.mean())
        yield Check(what, exact, mean, mean * (1 - spread), mean * (1 + spread))
    yield Check("settling, 2.1 relaxation times, steps of .7", 1 - math.exp(-2.1), fall(3, 0.7, 1.0, 1.0))
    high, low = 1.0, 0.0
    while high - low > 1e-3:
        middle = 0.5 * (high + low)
        low, high = (low, middle) if closest_to_plane(1.0, middle, 0.01, 20_000) < 0 else (middle, high)
    yield Check("Stokes number at which a plane is hit", 0.25, high)
    alive = math.erf(1 / math.sqrt(2))
    for steps in (10, 40, 160):
        for bridged, how in ((True, "with the bridge"), (False, "without")):
            hits = survivors(particles, steps, bridged, 1)
            yield share(f"survival before a wall, {steps} steps, {how}", alive, hits, particles)
    ring, shell = math.log(5 / 1.5) / math.log(5 / 1.1), 1.1 / 1.5 * (5 - 1.5) / (5 - 1.1)
    for what, dimensions, exact in (("annulus", 2, ring), ("sphere", 3, shell)):
        for bridged, how in ((True, "with the bridge"), (False, "without")):
            hits = inner_hits(particles, 1.1, 5.0, 1.5, dimensions, 0.3, 0.1, bridged, 2)
            yield share(f"{what}, particle of a tenth of the radius, {how}", exact, hits, particles)
    for number in (0.05, 0.2, 0.5):
        passed = tube_passages(particles, number, 0.3, 0.05, 0.05, 1)
        yield share(f"tube, pi D L / Q = {number:g}", tube_penetration(number), passed, particles)


def plates(particles: int = PARTICLES) -> Iterator[Check]:
    """Check whole ways and the concentration between plates, which are fibers of radius 5000."""
    length, diffusivity, radius = 40.0, 0.02, 5000.0
    lower, upper = np.array([-1.0, 0, 0]), np.array([1.0, 0.2, length])
    x = np.array([-1.0 - radius, 1.0 + radius])
    start = np.column_stack([x, np.full(2, 0.1), np.full(2, -10.0)])
    end = start + np.array([0.0, 0.0, length + 20.0])
    grid = fiber_grid(start, end, np.full(2, radius), np.zeros((2, 2), bool), lower, upper, 1.0)
    cells = flows.sampled(*flows.brick(lower, upper, (8, 1, 240)), flows.between_plates)
    duct = Duct(-2.0, 2.0, 0.0, 0.2, 0.0, length, False)
    starts = flows.plate_starts(particles)
    fates = tracked(starts, 0, 1, 0, Motion(0.0, 0.0, diffusivity, 0, 0, 0), duct, pace_of(1, True, 1e4), cells, grid)
    exact = plates_penetration(diffusivity * length)
    yield share("plates, D L / (h2 U) = .8, trajectories", exact, int((fates.outcome == PASSED).sum()), particles)
    found = concentration_penetration(cells, grid, 0.0, diffusivity)
    yield Check("plates, D L / (h2 U) = .8, concentration", exact, found.value)


def interception(count: int = 4000) -> Iterator[Check]:
    """Check single-fiber interception in Kuwabara's cell at solidity .1."""
    solidity = 0.1
    outer = solidity**-0.5
    points, tets = flows.half_ring(outer, 0.3, (24, 48))
    cells = flows.sampled(points, tets, flows.kuwabara(solidity), flows.on_rim(outer))
    for ratio in (0.05, 0.1, 0.2, 0.3, 0.5):
        exact = flows.kuwabara_interception(solidity, ratio)
        caught = kuwabara_caught(ratio, exact, count, outer, cells, _single_fiber(points))
        yield Check(f"Kuwabara's interception, R = {ratio:g}", exact, caught)


def _single_fiber(points: Floats) -> FiberGrid:
    axis = np.array([[0.0, -5.0, 0.0]])
    return fiber_grid(axis, -axis, np.ones(1), np.zeros((1, 2), bool), points.min(0), points.max(0), 2.0)


def kuwabara_caught(ratio: float, exact: float, count: int, outer: float, cells: Cells, grid: FiberGrid) -> float:
    """Single-fiber efficiency of interception, from starts on the cell's rim."""
    # the flux through the cell's rim is even over x; twice the strip that must be caught
    x = (np.arange(count) + 0.5) / count * 2 * exact
    starts = np.column_stack([x, np.full(count, 0.15), -np.sqrt(outer**2 - x**2)])
    duct = Duct(0.0, 10.0, 0.0, 0.3, -10.0, outer, False)
    fates = tracked(starts, 0, 1, 0, Motion(ratio, 0, 0, 0, 0, 0), duct, pace_of(1.0, False, 1e4), cells, grid)
    return float((fates.outcome == CAPTURED).mean() * 2 * exact)


def square(folder: Path, particles: int = PARTICLES) -> Iterator[Check]:
    """Check the rows of a solved square array at solidity .1."""
    field, mat = store.load(FlowField, folder / "solve/flow.npz"), store.load(Mat, folder / "mat/mat.npz")
    domain = store.load(FluidDomain, folder / "enclosure/domain.npz")
    cells = cells_of(field.cells, field.positions, field.velocity)
    model = FilterSettings(solidity=0.1, thickness=mat.thickness, fiber_diameter=2.0 * float(mat.radius[0]))
    medium = Medium(mat, domain.pieces, domain.box, False, cells, 1.0, "stokes", model)
    thick, pitch = 2.0 * float(mat.radius[0]), mat.slab.size[0]
    at_inlet = np.abs(field.positions[:, 2] - domain.box.lower[2]) < 1e-9 * thick
    speed = float(field.velocity[at_inlet, 2].mean())
    rows = np.argsort(mat.nodes[mat.first[:-1], 2])
    crossing = 100.0 * domain.box.size[2] / speed
    for number, ratio, exact in ((math.inf, 0.3, 0.148098), *_ROWS):
        filter, fiber = filter_for(medium, ratio * thick)
        diffusivity = speed * thick / number
        motion = Motion(0.5 * ratio * thick, 0.0, diffusivity, 0.0, 0.0, 0.0)
        *_, fates = counted(filter, motion, pace_of(0.5 * thick, diffusivity > 0, crossing), 1, 0, particles, None)
        stuck = [int((fiber[fates.piece[fates.outcome == CAPTURED]] == row).sum()) for row in rows]
        if diffusivity == 0.0:
            per_area = pitch / thick
            low, high = share_interval(stuck[0], particles)
            found = stuck[0] / particles * per_area
            what = f"square array, interception of the first row, R = {ratio:g}"
            yield Check(what, exact, found, low * per_area, high * per_area)
        else:
            come = particles - stuck[0]
            what = f"square array, penetration of row 2, Pe = {number}, R = {ratio:g}"
            yield share(what, exact, come - stuck[1], come)


def table(checks: Iterator[Check]) -> Iterator[str]:
    """Lay the checks out as a table in Markdown."""
    yield "| quantity | exact | found | 95 % interval | difference |"
    yield "|---|---|---|---|---|"
    for check in checks:
        yield check.row()


if __name__ == "__main__":

    def every() -> Iterator[Check]:
        """Give all checks, the array's where there is a run."""
        yield from walks()
        yield from plates()
        yield from interception()
        for folder in sys.argv[1:]:
            yield from square(Path(folder))

    for line in table(every()):
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
