"""Thin fibers among thick ones stay where they are: axes and radii looked up in the finished mesh by VTK."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import pyvista

from pipeline.case import Case, read_case, validate
from pipeline.enclosure.duct import enclose
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.mat.generate import generate
from pipeline.mesh.fill import fill
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.wall_error import fidelity
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh import FaceMesh
from pipeline.quality.judge import judge
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite

SIDE, THICK = 4e-6, 1.5e-6


def mixture(seed: int, ratio: float) -> FluidDomain:
    """Two thick fibers and four from thick to thin, straight across a plan at random."""
    rng = np.random.default_rng(seed)
    diameter = THICK / np.array([1.0, 1.0, *ratio ** rng.random(3), ratio])
    nodes = []
    for k in range(len(diameter)):
        along, side = (0, 1) if rng.random() < 0.5 else (1, 0)
        height = (0.9 + k * 0.4 + 0.6 * rng.random()) * 1e-6
        ends = np.empty((2, 3))
        ends[:, along], ends[:, side], ends[:, 2] = (0.0, SIDE), SIDE * (0.15 + 0.7 * rng.random(2)), height
        nodes.append(ends)
    slab = Box((0.0, 0.0, 0.0), (SIDE, SIDE, 4e-6))
    mat = Mat(np.concatenate(nodes), 2 * np.arange(len(diameter) + 1), diameter / 2, slab, seed, "by hand")
    return enclose(unite(mat, SurfaceSettings()), EnclosureSettings(inlet=2e-6, outlet=2e-6))


def in_air(mesh: FaceMesh, places: Floats) -> npt.NDArray[np.bool_]:
    """Which places lie in a cell of the mesh, by VTK."""
    tets = mesh.tets()
    # VTK's tolerances are absolute
    grid = pyvista.UnstructuredGrid({pyvista.CellType.TETRA: tets}, mesh.points * 1e6)
    return np.asarray(grid.find_containing_cell(places * 1e6)) >= 0


def probes(domain: FluidDomain, off: float) -> tuple[Floats, Ints]:
    """Places around each fiber's axis, so many radii off it, where no other fiber is near; and the fiber of each."""
    rng = np.random.default_rng(0)
    start, end, fiber = domain.pieces.start, domain.pieces.end, domain.pieces.fiber
    places, owners = [], []
    for k in range(len(domain.pieces)):
        line = end[k] - start[k]
        radius = domain.radius[fiber[k]]
        count = 200
        aside = np.cross(line, rng.standard_normal((count, 3)))
        aside *= off * radius / np.linalg.norm(aside, axis=1, keepdims=True)
        found = start[k] + rng.random((count, 1)) * line + aside
        inside = ((found > np.array(domain.box.lower) + radius) & (found < np.array(domain.box.upper) - radius)).all(1)
        clear = np.ones(count, bool)
        for other in range(len(domain.pieces)):
            if fiber[other] != fiber[k]:
                run = end[other] - start[other]
                share = np.clip((found - start[other]) @ run / (run @ run), 0.0, 1.0)
                away = np.linalg.norm(found - start[other] - share[:, None] * run, axis=1)
                clear &= away > domain.radius[fiber[other]] + 2.0 * radius
        places.append(found[inside & clear])
        owners.append(np.full((inside & clear).sum(), fiber[k]))
    return np.concatenate(places), np.concatenate(owners)


@pytest.mark.parametrize(("seed", "ratio"), [(1, 20.0), (3, 10.0), (5, 3.0)])
def test_every_fiber_of_a_mixture_is_in_the_mesh_with_its_own_radius(seed: int, ratio: float) -> None:
    domain = mixture(seed, ratio)
    mesh, measures = fill(domain, TetmeshSettings(engine="lattice", edge=0.6))
    report = judge(mesh)
    assert report.verdict == "pass", report.reasons
    axis, _ = probes(domain, 0.0)
    assert len(axis) > 80
    assert not in_air(mesh, axis).any()
    # chords of 0.6 diameters have a sagitta of 0.09 of them, a third of a radius; edges across are longer still
    for off, air in ((0.55, False), (1.4, True)):
        places, fiber = probes(domain, off)
        found = in_air(mesh, places) == air
        for k in np.unique(fiber):
            assert found[fiber == k].mean() > 0.97, (k, off)
    assert measures.fidelity is not None
    assert all(walls.in_air == 0.0 for walls in measures.fidelity.fibers)


def test_a_fiber_that_a_mesh_lost_is_named_with_what_is_missing() -> None:
    # the mesh of all fibers but the thinnest, held against all of them
    domain = mixture(1, 20.0)
    whole = domain.pieces
    thinnest = len(domain.radius) - 1
    nodes = np.stack([whole.start, whole.end], axis=1)[whole.fiber != thinnest].reshape(-1, 3)
    slab = domain.slab
    mat = Mat(nodes, 2 * np.arange(thinnest + 1), domain.radius[:-1], slab, -1, "by hand")
    less = enclose(unite(mat, SurfaceSettings()), EnclosureSettings(inlet=2e-6, outlet=2e-6))
    mesh, _ = fill(less, TetmeshSettings(engine="lattice", edge=0.6))
    faults = fidelity(mesh, domain).faults(0.5)
    assert len(faults) == 1
    assert faults[0].startswith("fiber 5 of 6 (d 0.075 um): ")
    assert faults[0].endswith("% of its axis lies in the air of the mesh")
    share = fidelity(mesh, domain).fibers[thinnest].in_air
    axis, fiber = probes(domain, 0.0)
    assert share == pytest.approx(in_air(mesh, axis[fiber == thinnest]).mean(), abs=0.1)


def field_case(name: str) -> Case:
    """The mixture of the paper's Fig. 3c, or a part of it."""
    parts = [
        {"weight": 0.75, "diameter": {"distribution": "uniform", "min": "200 nm", "max": "600 nm"}},
        {"weight": 0.25, "diameter": {"distribution": "uniform", "min": "2.0 um", "max": "3.5 um"}},
    ]
    mat = {"generator": "box", "seed": 3, "fiber_diameter": {"distribution": "mixture", "parts": parts}}
    sizes: dict[str, dict[str, object]] = {
        "corner": {"side": "6 um", "thickness": "5 um", "stop": {"count": 6}},
        "whole": {"side": "100 um", "thickness": "20 um", "broken": 0.5, "stop": {"solidity": 0.05}},
    }
    # 18 million cells; at the default edge there are 27
    edge = {"corner": 0.6, "whole": 0.8}[name]
    return validate(
        {"mat": {**mat, **sizes[name]}, "enclosure": {"inlet": "3 um", "outlet": "3 um"},
         "tetmesh": {"engine": "lattice", "edge": edge}}, name,
    )  # fmt: skip


@pytest.mark.parametrize("name", ["corner", pytest.param("whole", marks=pytest.mark.slow)])
def test_the_mixture_of_figure_3c_keeps_every_fiber(name: str) -> None:
    case = field_case(name)
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    mesh, measures = fill(domain, case.tetmesh)
    report = judge(mesh)
    assert report.verdict == "pass", report.reasons
    assert measures.fidelity is not None
    assert max(walls.in_air for walls in measures.fidelity.fibers) == 0.0
    # 1.0e-2: the mean stand-off of a fiber's walls that fitting leaves, and the air between fibers that is bridged
    assert np.median(np.abs(measures.fidelity.radius_error)) < 0.01


@pytest.mark.parametrize("edge", [0.8, 20.0])
def test_a_fiber_shorter_than_thick_is_meshed_or_refused_in_words(edge: float, tmp_path: Path) -> None:
    (tmp_path / "short.csv").write_text(
        "# plan: 6 um x 6 um\n# thickness: 6 um\nfiber,x [um],y [um],z [um],radius [um]\na,3,3,3,0.7\na,3.2,3,3,0.7\n"
    )
    (tmp_path / "case.toml").write_text(
        '[mat]\ngenerator = "file"\nfile = "short.csv"\n[enclosure]\ninlet = "4 um"\noutlet = "4 um"\n'
        f'[tetmesh]\nengine = "lattice"\nedge = {edge}\n'
    )
    case = read_case(tmp_path / "case.toml")
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    if edge > 1.0:
        with pytest.raises(StageError, match="fiber 0 of 1"):
            fill(domain, case.tetmesh)
    else:
        _, measures = fill(domain, case.tetmesh)
        assert measures.fidelity is not None
        assert measures.fidelity.fibers[0].typical_deviation < 0.1
