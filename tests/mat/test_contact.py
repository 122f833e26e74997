"""Clear mats are clear, pair by pair; the paper's are not."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.geometry.triangles import Floats
from pipeline.mat.audit import audit
from pipeline.mat.deposit import Deposit, as_chord, drop
from pipeline.mat.generate import generate
from pipeline.mat.neighbors import near_fibers
from pipeline.mat.settings import Constant, LayeredSettings, Stop
from pipeline.nouns.fibers import Mat

FINE_AND_COARSE = {
    "distribution": "mixture",
    "parts": [
        {"weight": 0.75, "diameter": {"distribution": "uniform", "min": 0.2e-6, "max": 0.6e-6}},
        {"weight": 0.25, "diameter": {"distribution": "uniform", "min": 2.0e-6, "max": 3.5e-6}},
    ],
}
DIAMETERS: list[Any] = [1.4e-6, FINE_AND_COARSE, {"distribution": "lognormal", "median": 1e-6, "geometric_std": 1.8}]
ORIENTATIONS: list[Any] = [
    "isotropic",
    {"law": "aligned", "axis": 0.0},
    {"law": "aligned", "axis": 30.0},
    {"law": "von_mises", "axis": 90.0, "concentration": 50},
]


def clear_mat(seed: int) -> tuple[Mat, float]:
    """One of many kinds of mat: stiff to soft, in boxes of 2 to 60 um, of one or many diameters, wrapped or not."""
    side = (2e-6, 10e-6, 30e-6, 60e-6)[seed % 4]
    asked: dict[str, Any] = {
        "side": side,
        "fiber_diameter": DIAMETERS[seed % 3],
        "relaxation_slope": (0, 0.05, 0.15, 0.3, 0.6, 1)[seed % 6],
        "contact": "clear",
        "spacing": (0, 0.1e-6)[seed % 2],
        "seed": seed,
        "stop": Stop(count=(30, 60, 90)[seed % 3]),
    }
    if side > 10e-6 and seed // 4 % 2:
        asked |= {"periodic": True, "fiber_length": 0.5 * side, "orientation": ORIENTATIONS[seed // 8 % 4]}
    else:
        asked |= {"broken": (0, 0.5)[seed // 2 % 2], "orientation": ["perimeter", *ORIENTATIONS][seed // 8 % 5]}
    return generate(LayeredSettings.model_validate(asked)), asked["spacing"]


def test_no_two_fibers_of_a_clear_mat_are_too_close() -> None:
    # every pair, crossing or not, by its exact distance, without a tolerance
    for seed in range(120):
        mat, spacing = clear_mat(seed)
        assert audit(mat, spacing).violations == 0, seed


def test_clear_fibers_do_touch() -> None:
    # a mat that floats would be clear as well: the closest pair is as close as asked
    mat, spacing = clear_mat(2)
    assert audit(mat, spacing).least_gap == pytest.approx(spacing, abs=1e-13)


def test_the_papers_mats_interpenetrate_as_the_method_says() -> None:
    # 86 % of the fibers of Fig. 10 sit in a pair closer than 0.9 of the radii's sum
    shares = []
    for seed in range(5):
        mat = generate(
            LayeredSettings(
                side=1e-4,
                fiber_diameter=Constant(diameter=1.4e-6),
                relaxation_slope=0.15,
                stop=Stop(coverage=4),
                seed=seed,
            )
        )
        close = near_fibers(mat, 0.9 * mat.radius)
        shares.append(len(np.union1d(close.first, close.second)) / mat.fibers)
    assert np.mean(shares) == pytest.approx(0.86, abs=0.04)


def height_at(share: float, nodes: Floats, axis: np.intp) -> float:
    places = (nodes[:, axis] - nodes[0, axis]) / (nodes[-1, axis] - nodes[0, axis])
    return float(np.interp(share, places, nodes[:, 2]))


def thick(contact: str) -> Mat:
    """A mat of so many fibers that those far below are left out, and so wide that some of them still matter."""
    asked = {"side": 1e-3, "fiber_diameter": 1e-6, "relaxation_slope": 0.15, "stop": {"count": 1300}}
    return generate(LayeredSettings.model_validate(asked | {"contact": contact}))


def test_leaving_out_the_fibers_far_below_keeps_a_thick_mat_clear() -> None:
    assert audit(thick("clear")).violations == 0


def test_in_a_thick_mat_of_the_paper_no_fiber_sinks_under_one_that_it_crosses() -> None:
    mat = thick("paper")
    ends = [mat.nodes[mat.first[k] : mat.first[k + 1]] for k in range(mat.fibers)]
    least = math.inf
    for new in range(mat.fibers - 12, mat.fibers):
        for old in range(new):
            a, b = ends[new], ends[old]
            u, v, gap = a[-1, :2] - a[0, :2], b[-1, :2] - b[0, :2], b[0, :2] - a[0, :2]
            cross = u[0] * v[1] - u[1] * v[0]
            s, t = (gap[0] * v[1] - gap[1] * v[0]) / cross, (gap[0] * u[1] - gap[1] * u[0]) / cross
            if 0 < s < 1 and 0 < t < 1:
                along = np.abs(u).argmax(), np.abs(v).argmax()
                heights = [
                    np.interp(
                        share, (nodes[:, axis] - nodes[0, axis]) / (nodes[-1, axis] - nodes[0, axis]), nodes[:, 2]
                    )
                    for share, axis, nodes in ((s, along[0], a), (t, along[1], b))
                ]
                least = min(least, heights[0] - heights[1])
    # some rest on each other: the least difference is the diameter itself
    assert least == pytest.approx(1e-6, rel=1e-6)


@pytest.mark.parametrize("contact", ["paper", "clear"])
def test_an_old_fiber_at_the_bottom_still_bears_where_the_new_ones_do_not_lie(contact: Any) -> None:
    # the oldest fiber lies alone on the ground, 1500 newer ones high up on one heap beside it
    deposit = Deposit()
    for x, z in [(80.0, 0.5)] + 1500 * [(20.0, 10.0)]:
        ends = np.array([[x, 0.0], [x, 100.0]])
        deposit.add(ends, as_chord(ends), 0.5, np.array([[0.0, z], [100.0, z]]))
    nodes = drop(deposit, as_chord(np.array([[0.0, 50.0], [100.0, 50.0]])), 0.5, 1.0, contact, 0.0)
    over = 1.0 if contact == "paper" else math.sqrt(2)
    assert np.interp([20, 50, 80], nodes[:, 0], nodes[:, 1]) == pytest.approx([10 + over, 0.5, 0.5 + over])


def over_one(angle: float, slope: float, contact: Any) -> Floats:
    """A fiber laid at an angle over the middle of a fiber on the ground, both of radius 0.5 and 100 long."""
    deposit = Deposit()
    ends = np.array([[0.0, 0.0], [100.0, 0.0]])
    deposit.add(ends, as_chord(ends), 0.5, np.array([[0.0, 0.5], [100.0, 0.5]]))
    along = 50 * np.array([math.cos(angle), math.sin(angle)])
    chord = as_chord(np.array([50 - along[0], -along[1], 50 + along[0], along[1]]).reshape(2, 2))
    return drop(deposit, chord, 0.5, slope, contact, 0.0)


@pytest.mark.parametrize("angle", [math.pi / 2, 1.0, 0.6])
@pytest.mark.parametrize("slope", [0.05, 0.15, 1.0])
def test_the_apex_over_a_level_fiber_has_its_closed_height(angle: float, slope: float) -> None:
    # z_old + (r1 + r2) sqrt(1 + s^2 / sin^2 phi), in the middle; the paper's rests at z_old + r1 + r2.
    # At 0.6 the stretch within reach is 2.9 R long: not cut yet
    nodes = over_one(angle, slope, "clear")
    top = nodes[np.argmax(nodes[:, 1])]
    assert top[0] == pytest.approx(50)
    assert top[1] == pytest.approx(0.5 + math.sqrt(1 + (slope / math.sin(angle)) ** 2))
    assert over_one(angle, slope, "paper")[:, 1].max() == pytest.approx(1.5)


def test_a_fiber_beside_another_climbs_only_in_clear_mats() -> None:
    # parallel chords half a diameter apart never cross: the paper lays both on the ground
    deposit = Deposit()
    ends = np.array([[0.0, 0.0], [100.0, 0.0]])
    deposit.add(ends, as_chord(ends), 0.5, np.array([[0.0, 0.5], [100.0, 0.5]]))
    beside = as_chord(ends + np.array([0.0, 0.5]))
    assert drop(deposit, beside, 0.5, 0.15, "paper", 0.0)[:, 1].max() == 0.5
    # slope 0 would stand exactly on the circle; cut at 4 R the tents stand a little higher
    level = 0.5 + math.sqrt(1 - 0.25)
    assert drop(deposit, beside, 0.5, 0.0, "clear", 0.0)[:, 1] == pytest.approx([level, level])
    assert 1.0 < drop(deposit, beside, 0.5, 0.15, "clear", 0.0)[:, 1].min() < level + 4 * 0.15 + 0.1


@pytest.mark.parametrize("contact", ["paper", "clear"])
@given(seed=st.integers(0, 1000), shift=st.tuples(st.integers(-8, 8), st.integers(-8, 8)))
@settings(max_examples=20, deadline=None)
def test_a_pile_does_not_mind_where_it_lies(contact: Any, seed: int, shift: tuple[int, int]) -> None:
    rng = np.random.default_rng(seed)
    ends = rng.random((30, 2, 2)) * 20
    heights = []
    for moved in (ends, ends + np.array(shift)):
        deposit = Deposit()
        for pair in moved:
            chord = as_chord(pair)
            deposit.add(pair, chord, 0.5, drop(deposit, chord, 0.5, 0.15, contact, 0.1))
        heights.append(deposit.points()[:, 2].max())
    assert heights[1] == pytest.approx(heights[0], rel=1e-6)


@pytest.mark.parametrize("contact", ["paper", "clear"])
@given(power=st.integers(-10, 10), seed=st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_all_lengths_times_a_power_of_two_give_the_same_mat_to_the_bit(contact: Any, power: int, seed: int) -> None:
    # such factors round nothing; the count fixes the number of fibers
    def grown(scale: float) -> Mat:
        return generate(
            LayeredSettings(
                side=20e-6 * scale,
                fiber_diameter=Constant(diameter=1e-6 * scale),
                relaxation_slope=0.15,
                contact=contact,
                spacing=0.1e-6 * scale,
                seed=seed,
                stop=Stop(count=30),
            )
        )

    one, scaled = grown(1.0), grown(2.0**power)
    assert (scaled.nodes == one.nodes * 2.0**power).all()
    assert scaled.first.tolist() == one.first.tolist()
    assert scaled.thickness == one.thickness * 2.0**power


@given(scale=st.floats(1e-3, 1e3), seed=st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_all_lengths_times_any_factor_give_the_same_mat_to_rounding(scale: float, seed: int) -> None:
    def grown(scale: float) -> Mat:
        return generate(
            LayeredSettings.model_validate(
                {
                    "side": 20e-6 * scale,
                    "fiber_diameter": {
                        "distribution": "normal",
                        "mean": 1e-6 * scale,
                        "std": 0.2e-6 * scale,
                        "max": 2e-6 * scale,
                    },
                    "relaxation_slope": 0.15,
                    "seed": seed,
                    "stop": Stop(count=30),
                }
            )
        )

    one, scaled = grown(1.0), grown(scale)
    assert scaled.radius == pytest.approx(one.radius * scale, rel=1e-12)
    assert scaled.thickness == pytest.approx(one.thickness * scale, rel=1e-6)


def test_the_audit_tells_of_a_pair_that_is_too_close_and_how_much() -> None:
    nodes = np.array([[0, 5, 1], [10, 5, 1], [5, 0, 2.9], [5, 10, 2.9], [0, 1, 9], [10, 1, 9]], dtype=float)
    mat = Mat(nodes, np.array([0, 2, 4, 6]), np.ones(3), Box((0, 0, 0), (10, 10, 10)), -1, "test")
    found = audit(mat)
    assert (found.violations, found.fibers, found.closest) == (1, 2, (0, 1))
    assert found.deepest == pytest.approx(0.1)
    assert found.least_gap == pytest.approx(-0.1)
    assert audit(mat, spacing=4.2).violations == 2


def test_the_audit_sees_across_the_sides_of_a_periodic_mat() -> None:
    # two parallel fibers by opposite sides, 0.6 apart through the side, and one that nearly bites its own tail
    nodes = np.array([[2, 0.3, 1], [8, 0.3, 1], [2, 9.7, 1], [8, 9.7, 1], [0.2, 5, 5], [9.8, 5, 5]], dtype=float)
    first = np.array([0, 2, 4, 6])
    box = Box((0, 0, 0), (10, 10, 10))
    assert audit(Mat(nodes, first, np.full(3, 0.5), box, -1, "test")).violations == 0
    wrapped = audit(Mat(nodes, first, np.full(3, 0.5), box, -1, "test", periodic=True))
    assert wrapped.violations == 2
    assert wrapped.closest == (2, 2)
    assert wrapped.least_gap == pytest.approx(0.4 - 1.0)


def test_a_clear_periodic_fiber_that_would_meet_itself_is_refused() -> None:
    asked = LayeredSettings(
        side=10e-6,
        fiber_diameter=Constant(diameter=2e-6),
        relaxation_slope=0.15,
        contact="clear",
        periodic=True,
        fiber_length=9e-6,
        stop=Stop(count=3),
    )
    with pytest.raises(CaseError, match="its own image"):
        generate(asked)
