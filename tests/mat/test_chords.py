"""Chords and directions against the exact statistics of their laws."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import Any

import numpy as np
import pytest
from scipy import stats

from pipeline.geometry.triangles import Floats
from pipeline.mat.chords import draw_angles, draw_chords
from pipeline.mat.settings import Aligned, DrawnSettings, Isotropic, MachineDirection, Stop, VonMises


def chords(count: int, seed: int = 1, **changes: Any) -> Floats:
    """Chords of a unit square."""
    asked = {"side": 1.0, "fiber_diameter": 0.001, "stop": Stop(count=1)}
    settings = DrawnSettings.model_validate(asked | changes)
    return draw_chords(settings, np.full(count, 0.001), np.random.default_rng(seed))


def lengths(ends: Floats) -> Floats:
    found: Floats = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return found


def edges(points: Floats) -> Floats:
    """Which edge each point lies on: 0 left, 1 top, 2 right, 3 bottom."""
    x, y = points.T
    assert (np.isin(x, [0, 1]) | np.isin(y, [0, 1])).all()
    return np.select([x == 0, y == 1, x == 1, y == 0], [0.0, 1.0, 2.0, 3.0])


def test_perimeter_chords_have_their_exact_statistics() -> None:
    n = 200_000
    ends = chords(n)
    apart = (edges(ends[:, 1]) - edges(ends[:, 0])) % 4
    length = lengths(ends)
    assert (apart != 0).all()
    # adjacent edges with probability 2/3: standard error sqrt(2/9/n)
    assert (apart != 2).mean() == pytest.approx(2 / 3, abs=4 * math.sqrt(2 / 9 / n))
    assert length[apart != 2].mean() == pytest.approx((math.sqrt(2) + math.asinh(1)) / 3, abs=0.003)
    assert length[apart == 2].mean() == pytest.approx(1.076636, abs=0.001)
    assert length.mean() == pytest.approx(0.869009, abs=0.003)
    assert (length**2).mean() == pytest.approx(5 / 6, abs=0.004)


def test_two_perimeter_chords_cross_in_17_of_36_cases() -> None:
    n = 100_000
    a, b = chords(n, 1), chords(n, 2)

    def sides(line: Floats, points: Floats) -> Floats:
        along, to = line[:, 1] - line[:, 0], points - line[:, 0]
        turn: Floats = np.sign(along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0])
        return turn

    cross = (sides(a, b[:, 0]) != sides(a, b[:, 1])) & (sides(b, a[:, 0]) != sides(b, a[:, 1]))
    assert cross.mean() == pytest.approx(17 / 36, abs=4 * 0.5 / math.sqrt(n))


def density(ends: Floats) -> Floats:
    """Length of fiber in each of 5 x 5 fields of the unit square, wrapped into it, over the mean."""
    at = (np.arange(50) + 0.5) / 50
    points = (ends[:, None, 0] + at[:, None] * (ends[:, None, 1] - ends[:, None, 0])) % 1.0
    weight = np.repeat(lengths(ends), 50)
    counts, _, _ = np.histogram2d(
        points[..., 0].ravel(), points[..., 1].ravel(), bins=5, range=[[0, 1], [0, 1]], weights=weight
    )
    relative: Floats = counts / counts.mean()
    return relative


LAWS: list[Any] = [
    "isotropic",
    {"law": "von_mises", "axis": 20.0, "concentration": 3},
    {"law": "machine_direction", "axis": 0.0, "ratio": 4},
]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("periodic", [False, True])
def test_chords_of_a_law_of_directions_cover_the_plan_evenly(law: Any, periodic: bool) -> None:
    # 200 mats of 400 fibers; a chord leaves 0.15 sides in every fourth field it might: the standard error is 0.8 %
    spread = density(chords(80_000, orientation=law, periodic=periodic))
    assert spread == pytest.approx(np.ones((5, 5)), abs=0.035)


def test_the_papers_chords_crowd_the_frame_as_the_method_says() -> None:
    # the center is about 12 % thinner
    assert density(chords(60_000))[2, 2] == pytest.approx(0.88, abs=0.03)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("periodic", [False, True])
def test_the_length_of_fiber_per_direction_follows_the_law(law: Any, periodic: bool) -> None:
    ends = chords(100_000, orientation=law, periodic=periodic)
    along = ends[:, 1] - ends[:, 0]
    double = 2 * np.arctan2(along[:, 1], along[:, 0])
    weight = lengths(ends)
    mean = complex((weight * np.exp(1j * double)).sum() / weight.sum())
    # first moment of the doubled angle: 0; Bessel ratio of the von Mises law; (k - 1)/(k + 1) of a stretch k = sqrt(4)
    expected = {
        "isotropic": 0.0,
        "von_mises": stats.vonmises(3).expect(np.cos) * np.exp(2j * math.radians(20)),
        "machine_direction": 1 / 3,
    }[law if isinstance(law, str) else law["law"]]
    assert abs(mean - expected) < 4 / math.sqrt(100_000)


def test_directions_follow_their_densities() -> None:
    rng = np.random.default_rng(3)
    n = 20_000
    flat = draw_angles(Isotropic(), n, rng) / math.pi
    assert stats.kstest(flat, "uniform").pvalue > 1e-3
    turned = 2 * (draw_angles(VonMises(axis=30.0, concentration=2.0), n, rng) - math.radians(30))
    assert stats.kstest(turned, stats.vonmises(2.0).cdf).pvalue > 1e-3
    # machine direction: the share within angle a of the axis is (2/pi) atan(sqrt(ratio) tan a)
    biased = np.abs(np.arctan(np.tan(draw_angles(MachineDirection(ratio=9.0), n, rng))))
    assert stats.kstest(biased, lambda a: 2 / math.pi * np.arctan(3 * np.tan(a))).pvalue > 1e-3
    assert draw_angles(Aligned(axis=90.0), 2, rng).tolist() == [math.pi / 2] * 2


@pytest.mark.parametrize("law", [*LAWS, {"law": "aligned", "axis": 0.0}, {"law": "aligned", "axis": 90.0}])
def test_chords_end_exactly_on_two_different_edges(law: Any) -> None:
    ends = chords(5000, orientation=law)
    assert (edges(ends[:, 0]) != edges(ends[:, 1])).all()
    assert (lengths(ends) > 0).all()


def test_half_of_the_fibers_are_broken_where_half_are_asked_for() -> None:
    n = 20_000
    whole, half = chords(n), chords(n, broken=0.5)
    shorter = lengths(half) < lengths(whole)
    assert shorter.mean() == pytest.approx(0.5, abs=4 * 0.5 / math.sqrt(n))
    assert (half[:, 0] == whole[:, 0]).all()
    # a uniform part of the chord stays, and no less than a diameter
    part = (lengths(half) / lengths(whole))[shorter & (lengths(whole) > 0.1)]
    assert part.mean() == pytest.approx(0.5, abs=0.02)
    assert lengths(half)[shorter].min() >= 0.001 * (1 - 1e-9)


def test_the_fibers_of_a_periodic_mat_have_the_length_asked_for() -> None:
    ends = chords(1000, periodic=True, fiber_length=0.6)
    assert lengths(ends) == pytest.approx(0.6)
    middle = ends.mean(axis=1)
    assert ((middle >= 0) & (middle <= 1)).all()
