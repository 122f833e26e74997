"""What is known of an error before other meshes are solved: interpolated, followed by its trend, and said."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace

import pytest

from pipeline.analytics.measured_errors import EdgeError, measured, mesh_error, needed_edge, seed_spread
from pipeline.analytics.sureness import sureness
from pipeline.nouns.flow import Solution

SOLVED = Solution(7.5, 1e-8, 1e-9, 1e-12, 0.0, 0.0, 30, True)


def rows(mesher: str = "lattice", solver: str = "openfoam", order: float = 2.0) -> list[EdgeError]:
    # the error falls with a power of the edge, cells and time rise with the third and fourth
    return [
        EdgeError(
            mesher, solver, h, 1.0, 5, -0.1 * h**order, -0.12 * h**order, -0.08 * h**order, 50 * h**-3, 0.01 * h**-4
        )
        for h in (0.4, 0.6, 1.0)
    ]


@pytest.mark.parametrize("edge", [0.4, 0.5, 0.6, 0.83, 1.0])
def test_between_measured_edges_an_error_of_second_order_is_met_exactly(edge: float) -> None:
    found = mesh_error("lattice", "openfoam", edge, known=rows())
    assert found is not None
    assert found.mean == pytest.approx(-0.1 * edge**2, rel=1e-12)
    assert found.low <= found.mean <= found.high


def test_another_growth_is_another_mesh() -> None:
    assert mesh_error("lattice", "openfoam", 0.5, 0.4, rows()) is None


def test_meshes_that_are_graded_with_their_edge_are_followed_where_they_were_measured() -> None:
    # with a growth in the edge's proportion the error falls four times as quickly
    graded = [replace(each, growth=each.edge / 0.6, mean=each.mean * each.edge**2) for each in rows()]
    need = needed_edge("lattice", "openfoam", 0.001, [*(each for each in rows() if each.edge != 0.6), *graded])
    assert need is not None
    assert 0.1 * need.edge**4 == pytest.approx(0.001, rel=1e-6)
    assert need.growth == pytest.approx(need.edge / 0.6)


def test_an_error_that_does_not_fall_with_the_edge_needs_no_edge() -> None:
    assert needed_edge("lattice", "openfoam", 0.01, rows(order=0.5)) is None


def test_no_edge_is_asked_for_that_is_coarser_than_what_was_measured() -> None:
    # 20 % would be met at an edge of 1.4; one that hardly falls is met by what was measured, or by nothing
    for order in (2.0, 0.5):
        need = needed_edge("lattice", "openfoam", 0.2, rows(order=order))
        assert need is not None
        assert (need.edge, need.measured) == (1.0, True)


@pytest.mark.parametrize(("mesher", "edge"), [("lattice", 0.39), ("lattice", 1.01), ("tetwild", 0.6)])
def test_outside_what_was_measured_nothing_is_said(mesher: str, edge: float) -> None:
    assert mesh_error(mesher, "openfoam", edge, known=rows()) is None
    if mesher == "tetwild":
        assert needed_edge(mesher, "openfoam", 0.01, rows()) is None


@pytest.mark.parametrize("order", [1.5, 2.0, 3.0])
def test_the_edge_that_an_error_needs_follows_the_power_law(order: float) -> None:
    for error in (0.05, 0.001):
        need = needed_edge("lattice", "openfoam", error, rows(order=order))
        assert need is not None
        assert 0.1 * need.edge**order == pytest.approx(error, rel=1e-9)
        assert need.cells == pytest.approx(50 * need.edge**-3, rel=1e-9)
        assert need.measured == (0.4 <= need.edge <= 1.0)


def test_seeds_average_with_the_root_of_the_plan() -> None:
    known = measured().seeds
    assert seed_spread(known.area) == pytest.approx(known.deviation)
    four = seed_spread(4.0 * known.area)
    assert four == pytest.approx(0.5 * known.deviation)
    assert seed_spread(0.4 * known.area) is None
    assert seed_spread(11.0 * known.area) is None


def test_an_edge_that_one_mat_was_measured_at_has_no_interval() -> None:
    alone = EdgeError("tetwild", "stokes", 1.0, 1.0, 1, 0.03, 0.03, 0.03, 100.0, 0.2)
    several = replace(alone, edge=0.5, mats=5, low=0.02)
    assert mesh_error("tetwild", "stokes", 0.75, known=[alone, several]) is None
    assert mesh_error("tetwild", "stokes", 0.75, known=[replace(alone, mats=2), several]) is not None


def test_the_shipped_figures_hold_the_default_mesh_of_both_solvers_and_are_plausible() -> None:
    for solver in ("stokes", "openfoam"):
        found = mesh_error("tetwild", solver, 0.6)
        assert found is not None
        assert found.low <= found.mean <= found.high
        # a mesh of three edges to a diameter or less is neither exact nor off by a third
        assert 1e-4 < abs(found.mean) < 0.3
        assert found.mats >= 1
    finer = needed_edge("tetwild", "openfoam", 0.01)
    coarser = needed_edge("tetwild", "openfoam", 0.05)
    assert finer is not None
    assert coarser is not None
    assert finer.edge < coarser.edge
    assert finer.cells > coarser.cells


def test_one_sentence_says_what_mesh_wall_and_seed_change() -> None:
    known = replace(
        SOLVED, mesh_error=(0.013, 0.008, 0.02), fiber_wall="slip", pressure_drop_slip=7.5, pressure_drop_no_slip=8.25,
        seed_spread=0.15,
    )  # fmt: skip
    text = sureness(known)
    assert text == (
        "7.5 Pa; this mesh +1.3 % (+0.8 to +2.0 %, measured on other mats), no slip would be +10 %, "
        "another seed ±15 % (one standard deviation)"
    )
    without = replace(known, pressure_drop=8.25, fiber_wall="no_slip")
    assert "slip would be -9 %" in sureness(without)
    assert "no slip" not in sureness(without)


def test_what_was_not_measured_is_said_too() -> None:
    text = sureness(SOLVED)
    assert "this mesh not measured (fibertwin converge does)" in text
    assert "seed" not in text
