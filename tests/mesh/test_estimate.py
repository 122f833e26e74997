"""What meshing will take is told before it starts, and follows from the fibers' length and the edges."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pipeline.case import read_case
from pipeline.enclosure.duct import enclose
from pipeline.mat.generate import generate
from pipeline.mesh import fill as filling
from pipeline.mesh.engines.flawed import FlawedMeshError
from pipeline.mesh.engines.registry import ENGINES
from pipeline.mesh.estimate import estimate, field_cells, slenderness
from pipeline.mesh.settings import TetmeshSettings
from pipeline.surface.union import unite

CASES = Path(__file__).parents[2] / "cases"


def test_even_edges_fill_a_cylinder_with_regular_tetrahedra() -> None:
    # pi 1.36^2 of volume per diameter of length, and four fifths of it where fibers share their surroundings
    even = field_cells(TetmeshSettings(edge=0.5, growth=0.0))
    assert even == pytest.approx(0.8 * math.pi * 1.36**2 * 6 * math.sqrt(2) / 0.5**3, rel=1e-3)
    assert field_cells(TetmeshSettings(edge=0.25, growth=0.0)) == pytest.approx(8 * even)


def test_growth_spares_cells_and_the_longest_edge_bounds_that() -> None:
    counts = [field_cells(TetmeshSettings(edge=0.5, growth=growth)) for growth in (0.0, 0.5, 1.0)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] == pytest.approx(field_cells(TetmeshSettings(edge=0.5, growth=1.0, largest_edge=0.5)))


@pytest.mark.parametrize("name", ENGINES)
def test_twice_the_fibers_take_more_and_coarser_edges_less(name: str) -> None:
    settings = TetmeshSettings(engine=name)
    expected = ENGINES[name].estimate
    assert expected is not None
    one, two = expected(400.0, settings), expected(800.0, settings)
    coarse = expected(400.0, settings.changed(edge=1.0))
    assert two.cells == pytest.approx(2 * one.cells)
    assert two.seconds > one.seconds > coarse.seconds
    assert two.memory > one.memory > coarse.memory


def test_the_slenderness_of_a_mat_follows_from_its_coverage_and_from_its_walls() -> None:
    case = read_case(CASES / "smoke.toml")
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    # coverage is length times diameter over the face's area; the last fiber overshoots, walls within others are no air
    target = 0.6 * (10 / 1.4) ** 2
    assert slenderness(domain) == pytest.approx(target, rel=0.35)
    expected = estimate(case)
    assert expected is not None
    assert expected.cells == pytest.approx(target * estimate_per_length(case.tetmesh), rel=1e-9)


def estimate_per_length(settings: TetmeshSettings) -> float:
    expected = settings.mesher.estimate
    assert expected is not None
    return expected(1.0, settings).cells


def test_only_growing_the_mat_tells_what_a_target_pressure_drop_takes() -> None:
    assert estimate(read_case(CASES / "figure11_hepa.toml")) is None
    assert estimate(read_case(CASES / "verification/square.toml")) is None


def test_an_engine_that_differs_each_time_is_run_again_where_its_mesh_is_flawed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    case = read_case(CASES / "smoke.toml")
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    lattice = ENGINES["lattice"]
    runs: list[int] = []

    def sometimes(*arguments: Any) -> Any:
        runs.append(len(runs))
        if len(runs) < 3:
            raise FlawedMeshError("it lost part of xmin")
        return lattice.mesh(*arguments)

    monkeypatch.setitem(ENGINES, "lattice", replace(lattice, mesh=sometimes, tries=3))
    filling.fill(domain, case.tetmesh)
    assert runs == [0, 1, 2]
    runs.clear()
    monkeypatch.setitem(ENGINES, "lattice", replace(lattice, mesh=sometimes, tries=2))
    with pytest.raises(FlawedMeshError, match=r"lost part of xmin \(2 runs\)"):
        filling.fill(domain, case.tetmesh)


def test_a_long_mesh_is_announced_with_its_key_before_it_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    case = read_case(CASES / "smoke.toml")
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    told: list[str] = []

    def progress(what: str, done: float | None = None) -> None:
        told.append(what)

    filling.fill(domain, case.tetmesh, progress)
    assert not [what for what in told if what.startswith("note:")]
    told.clear()
    monkeypatch.setattr(filling, "_LONG", 0.0)
    filling.fill(domain, case.tetmesh, progress)
    assert told[0].startswith("note: lattice will take about")
    assert "tetmesh.edge" in told[0]
