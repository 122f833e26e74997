"""Fibers that run into themselves are united with themselves: the volume that random points see, and no cut left."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from pathlib import Path

import numpy as np
import pytest

from pipeline.geometry.crossings import crossing_pairs, self_intersections
from pipeline.mat.exchange import read_fibers
from pipeline.nouns.arrays import Floats
from pipeline.surface.measures import measure_surface
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import fiber_bodies, unite

from .mats import RADIUS, mat_of
from .tangles import KINDS, tangle

ROUND = SurfaceSettings(joint="sphere", caps="hemisphere", sides=24, smallest_edge=0)


def seen(line: Floats, radius: float, flat: bool, rng: np.random.Generator) -> tuple[float, float]:
    """Volume that random points find within a radius of a center line, and its standard error; without end balls."""
    count = 60_000
    low, high = line.min(axis=0) - radius, line.max(axis=0) + radius
    points = low + (high - low) * rng.random((count, 3))
    inside = np.zeros(count, dtype=bool)
    for k in range(len(line) - 1):
        step = line[k + 1] - line[k]
        share = (points - line[k]) @ step / (step @ step)
        within = np.linalg.norm(points - line[k] - np.clip(share, 0, 1)[:, None] * step, axis=1) < radius
        if flat:
            within &= (share >= 0) | (k > 0)
            within &= (share <= 1) | (k < len(line) - 2)
        inside |= within
    part = inside.mean()
    box = float(np.prod(high - low))
    return box * part, box * math.sqrt(part * (1 - part) / count)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_a_fiber_that_runs_into_itself_has_the_volume_that_points_see(kind: str, seed: int) -> None:
    rng = np.random.default_rng([seed, list(KINDS).index(kind)])
    line = tangle(kind, rng)
    mat = mat_of([(x, y, z) for x, y, z in line])
    # where a miter closes wide bends it is the capsules' union too, but for a few thousandths
    flat = kind in ("coil", "knot", "hairpin")
    volume, error = seen(line * 1e-6, RADIUS, flat, rng)
    surface = unite(mat, SurfaceSettings(sides=24, smallest_edge=0) if flat else ROUND)
    # 24 corners: balls whose corners lie .4 % outside
    assert surface.volume == pytest.approx(volume, rel=0.015, abs=4 * error)
    assert len(self_intersections(surface.points, surface.triangles)) == 0


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(4, 9))
def test_no_part_of_such_a_fiber_cuts_itself(kind: str, seed: int) -> None:
    line = tangle(kind, np.random.default_rng([seed, list(KINDS).index(kind)]))
    mat = mat_of([(x, y, z) for x, y, z in line])
    bodies, _, _ = fiber_bodies(mat, SurfaceSettings())
    assert [len(crossing_pairs(*body)) for body in bodies] == [0] * len(bodies)
    surface = unite(mat, SurfaceSettings())
    assert len(self_intersections(surface.points, surface.triangles)) == 0


def test_the_coil_from_the_field(tmp_path: Path) -> None:
    # two turns of 6 um, .4 um apart: random points see 79.2 um3 with balls on both ends, 78.8 +- .1 without
    angle = np.linspace(0, 4 * np.pi, 49)
    rows = [f"f0,{10 + 6 * np.cos(a):f},{10 + 6 * np.sin(a):f},{2.5 + 0.8 * a / (4 * np.pi):f},0.7" for a in angle]
    head = "# plan: 20 um x 20 um\n# thickness: 6 um\nfiber,x [um],y [um],z [um],radius [um]\n"
    (tmp_path / "coil.csv").write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
    mat = read_fibers(tmp_path / "coil.csv")
    surface = unite(mat, SurfaceSettings())
    measures = measure_surface(mat, surface, SurfaceSettings())
    assert measures.volume == pytest.approx(78.8e-18, rel=0.005)
    assert measures.self_intersections == 0
    # what the second turn shares with the first is told
    cylinder = math.pi * RADIUS**2 * float(mat.segment_lengths().sum())
    assert measures.overlap_volume == pytest.approx(cylinder - measures.volume, rel=0.01)


def test_legs_that_meet_soon_after_a_bend_are_parted_by_their_cut() -> None:
    # the way between the legs is shorter than half a turn about the tube: only their triangles tell that they cross
    mat = mat_of([(1, 5, 5), (8, 5, 5), (8.33, 6.87, 5), (1, 4.6, 5)])
    bodies, _, _ = fiber_bodies(mat, SurfaceSettings())
    assert len(bodies) == 2
    assert [len(crossing_pairs(*body)) for body in bodies] == [0, 0]


def test_a_straight_or_gently_bent_fiber_stays_one_tube() -> None:
    angle = np.linspace(0, np.pi, 40)
    arc = [(5 + 3 * math.cos(a), 1 + 3 * math.sin(a), 5.0) for a in angle]
    assert len(fiber_bodies(mat_of([(0, 5, 5), (10, 5, 5)], arc), SurfaceSettings())[0]) == 2
