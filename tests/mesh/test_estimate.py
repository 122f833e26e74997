"""What meshing will take is told before it starts, and follows from the fibers' length and the edges."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pipeline import machine
from pipeline.case import read_case
from pipeline.enclosure.duct import enclose
from pipeline.errors import StageError
from pipeline.line.run import Run, dry_run, run
from pipeline.mat.generate import generate
from pipeline.mesh import fill as filling
from pipeline.mesh.engines.engine import Slenderness
from pipeline.mesh.engines.flawed import FlawedMeshError
from pipeline.mesh.engines.lattice.engine import estimate_for as lattice_memory
from pipeline.mesh.engines.lattice.lattice import lattice_mesh
from pipeline.mesh.engines.registry import ENGINES
from pipeline.mesh.estimate import estimate, field_cells, slenderness, slenderness_of_case, too_large
from pipeline.mesh.settings import TetmeshSettings
from pipeline.progress import silent
from pipeline.surface.union import unite
from tests.mesh.test_mixtures import field_case, mixture

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
    one, two = expected(Slenderness(400.0), settings), expected(Slenderness(800.0), settings)
    coarse = expected(Slenderness(400.0), settings.changed(edge=1.0))
    assert two.cells == pytest.approx(2 * one.cells)
    assert two.seconds > one.seconds > coarse.seconds
    assert two.memory > one.memory > coarse.memory


def test_the_slenderness_of_a_mat_follows_from_its_coverage_and_from_its_walls() -> None:
    case = read_case(CASES / "smoke.toml")
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    # coverage is length times diameter over the face's area; the last fiber overshoots, walls within others are no air
    target = 0.6 * (10 / 1.4) ** 2
    assert slenderness(domain).total == pytest.approx(target, rel=0.35)
    expected = estimate(case)
    assert expected is not None
    assert expected.cells == pytest.approx(target * estimate_per_length(case.tetmesh), rel=1e-9)


def estimate_per_length(settings: TetmeshSettings) -> float:
    expected = settings.mesher.estimate
    assert expected is not None
    return expected(Slenderness(1.0), settings).cells


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


@pytest.mark.parametrize("name", ENGINES)
def test_a_mesh_beyond_memory_is_refused_with_an_edge_that_fits(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    settings, slender = TetmeshSettings(engine=name, edge=0.3), Slenderness(2e4)
    expected = ENGINES[name].estimate
    assert expected is not None
    needed = expected(slender, settings)
    # 85 % of what is free may be used
    monkeypatch.setattr(machine, "free_memory", lambda: int(needed.memory * 0.7 / 0.85))
    assert too_large(needed, slender, settings, unsure=5.0) is None
    reason = too_large(needed, slender, settings)
    assert reason is not None
    assert f"{needed.cells:,.2g} cells" in reason
    assert f"{needed.memory / 2**30:.2g} GiB" in reason
    assert ("fibertwin tiles" in reason) == (name == "lattice")
    found = re.search(r"tetmesh.edge = (\S+) would fit", reason)
    assert found is not None
    fits = settings.changed(edge=float(found[1]))
    assert too_large(expected(slender, fits), slender, fits) is None
    # and no much finer one would
    finer = settings.changed(edge=float(found[1]) / 1.15)
    assert too_large(expected(slender, finer), slender, finer) is not None


def test_a_limit_too_small_for_any_mesh_is_told_as_such() -> None:
    settings = TetmeshSettings(engine="lattice", memory_limit=1e6)
    reason = too_large(lattice_memory(1e6), Slenderness(1e3), settings)
    assert reason is not None
    assert "tetmesh.memory_limit allows" in reason
    assert "no tetmesh.edge would fit" in reason


def test_a_case_that_cannot_fit_is_refused_before_its_mat_is_made(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    case = read_case(CASES / "figure10.toml")
    monkeypatch.setattr(machine, "free_memory", lambda: 2**30)
    with pytest.raises(StageError, match=r"would make about .* cells and take .* GiB, and 0.85 GiB may be used"):
        run(case, tmp_path / "run")
    assert not (tmp_path / "run").exists()
    told = next(each for each in dry_run(case, tmp_path / "run") if each.stage == "tetmesh")
    assert told.would == "skip"
    assert "tetmesh.edge = " in told.why[0]


def test_memory_that_goes_while_a_run_is_under_way_is_an_error(
    monkeypatch: pytest.MonkeyPatch, smoke: Run, tmp_path: Path
) -> None:
    shutil.copytree(smoke.folder, tmp_path / "run")
    monkeypatch.setattr(machine, "free_memory", lambda: 2**20)
    with pytest.raises(StageError, match="may be used"):
        run(smoke.case, tmp_path / "run", force=frozenset({"tetmesh"}))
    # what was there stays
    assert (tmp_path / "run/tetmesh/mesh.npz").exists()


def test_the_lattice_counts_its_cubes_before_it_fills_them(monkeypatch: pytest.MonkeyPatch) -> None:
    # half of what the mesh takes is free, by the engine's own measure: too little for an error of the estimate to hide
    domain = mixture(3, 10.0)
    settings = TetmeshSettings(engine="lattice", edge=0.6)
    made, _ = filling.fill(domain, settings)
    monkeypatch.setattr(machine, "free_memory", lambda: int(0.5 * lattice_memory(made.cells).memory / 0.85))
    with pytest.raises(StageError, match=r"the engine lattice would make about"):
        lattice_mesh(domain, settings, silent)


def test_a_mixture_takes_about_the_cells_that_are_told() -> None:
    # edges that double make three times the cells of fibers that are alike: within a factor of two
    domain = mixture(1, 20.0)
    settings = TetmeshSettings(engine="lattice", edge=0.6)
    expected = settings.mesher.estimate
    assert expected is not None
    assert 0.5 < expected(slenderness(domain), settings).cells / filling.fill(domain, settings)[0].cells < 2.0


def test_what_a_mixture_will_take_follows_from_its_diameters_alone() -> None:
    case = field_case("corner")
    told = slenderness_of_case(case)
    assert told is not None
    assert not told.alike
    # six fibers of a box, whose plan is 6 um: the sum of length over diameter scatters by the few thin ones
    domains = [
        enclose(unite(generate(case.mat.model_copy(update={"seed": seed})), case.surface), case.enclosure)
        for seed in range(4)
    ]
    assert told.total == pytest.approx(sum(slenderness(domain).total for domain in domains) / 4, rel=0.4)
