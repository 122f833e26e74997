"""FTetWild as an engine: every limit kept, walls within the envelope, and no fiber lost among thicker ones."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest

from pipeline.case import read_case
from pipeline.enclosure.duct import enclose
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.geometry.box import Box
from pipeline.geometry.triangles import area_vectors
from pipeline.mat.generate import generate
from pipeline.mesh.engines.ftetwild.engine import TETWILD, TetwildSettings
from pipeline.mesh.estimate import slenderness
from pipeline.mesh.fill import fill
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.quality.judge import judge
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite
from validation.lattices import fibers, lattice_case

SMOKE = Path(__file__).parents[2] / "cases/smoke.toml"
UM = 1e-6


def crossing(thick: float, thin: float) -> FluidDomain:
    """A thick fiber along x and a thin one along y that passes above it, in a box of four thick diameters."""
    side = 4 * thick
    nodes = np.array([[0, 0.5 * side, 0.5 * thick], [side, 0.5 * side, 0.5 * thick],
                      [0.5 * side, 0, thick + thin], [0.5 * side, side, thick + thin]])  # fmt: skip
    slab = Box((0.0, 0.0, 0.0), (side, side, 2 * thick))
    mat = Mat(nodes, np.array([0, 2, 4]), 0.5 * np.array([thick, thin]), slab, -1, "two fibers that cross")
    return enclose(unite(mat, SurfaceSettings()), EnclosureSettings(inlet=2 * thick, outlet=2 * thick))


def test_the_smoke_case_keeps_every_limit_and_its_walls_the_envelope() -> None:
    case = read_case(SMOKE)
    assert case.mat.generator == "layered"
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    settings = TetmeshSettings(engine="tetwild", edge=0.8, largest_edge=2.0)
    mesh, measures = fill(domain, settings)
    # what was expected before it began: within a factor of two for so small a mat, whose plenums are a third of it
    assert TETWILD.estimate is not None
    assert 0.5 < TETWILD.estimate(slenderness(domain), settings).cells / mesh.cells < 2.0
    assert judge(mesh).verdict == "pass"
    # each fiber gets its own radius back; what is left is where fibers meet
    assert abs(measures.volume_error) < 0.01
    assert measures.fidelity is not None
    # a polygon of ten corners with the circle's volume strays by 0.015 diameters itself
    assert measures.fidelity.typical_deviation < settings.own(TetwildSettings).envelope + 0.015


@pytest.mark.parametrize("ratio", [8.0])
def test_no_fiber_is_lost_among_thicker_ones(ratio: float) -> None:
    domain = crossing(1.0 * UM, 1.0 * UM / ratio)
    mesh, measures = fill(domain, TetmeshSettings(engine="tetwild", edge=0.8))
    assert measures.fidelity is not None
    # a fiber that has lost its walls would have none to stand off
    walls = mesh.triangles()[mesh.patch("fibers")]
    height = mesh.points[walls].mean(axis=1)[:, 2]
    assert (height > 1.01 * UM).sum() > 100
    assert np.abs(measures.fidelity.radius_error).max() < 0.05
    assert judge(mesh).verdict == "pass"


@pytest.mark.parametrize("solidity", [0.05])
def test_edges_of_the_duct_stay_sharp_and_no_wall_stands_in_the_air(tmp_path: Path, solidity: float) -> None:
    # coarse cells beside thin fibers: fTetWild cut the duct's edges off within its envelope, every time, and repairing
    # gave cells with a vertex on a fiber to it, however far they reached into the air
    file = tmp_path / "fibers.csv"
    file.write_text(fibers("cubic", solidity), encoding="ascii")
    case = lattice_case("cubic", solidity, 0.4, "tetwild", file)
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    mesh, measures = fill(domain, case.tetmesh)
    assert measures.fidelity is not None
    # a chord of .4 diameters stands .04 off a circle
    assert measures.fidelity.largest_deviation < 0.1
    # no fiber reaches the inlet and the outlet: they are whole
    for end in ("inlet", "outlet"):
        area = np.linalg.norm(area_vectors(mesh.points, mesh.triangles()[mesh.patch(end)]), axis=1).sum()
        assert area == pytest.approx(np.prod(np.subtract(domain.box.upper, domain.box.lower)[:2]), rel=1e-9)
