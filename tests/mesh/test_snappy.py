"""snappyHexMesh as an engine: volumes with closed forms, planes to the last bit, OpenFOAM's own opinion."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import subprocess
from pathlib import Path

import numpy as np
import pytest

from pipeline.case import Case, read_case
from pipeline.errors import StageError
from pipeline.line.run import Run, run
from pipeline.mesh.engines.snappy.case import write_case
from pipeline.mesh.engines.snappy.joining import joined, without
from pipeline.mesh.engines.snappy.layout import layout
from pipeline.mesh.engines.snappy.mesh import snapped
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS, PATCHES
from pipeline.nouns.quality import QualityReport
from pipeline.openfoam.read import read_openfoam
from tests.openfoam import foam
from tests.sample_meshes import duct

SMOKE = Path(__file__).parents[2] / "cases" / "smoke.toml"
SNAPPY = TetmeshSettings(engine="snappy", edge=0.8, largest_edge=2.0)
DIAMETER, SOLIDITY = 2e-6, 0.1


def smoke_case(cores: int = 1) -> Case:
    case = read_case(SMOKE)
    settings = SNAPPY.changed(cores=cores)
    return case.model_copy(update={"tetmesh": settings})


@pytest.fixture(scope="module")
def snapped_smoke(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("snappy") / "run"
    run(smoke_case(), folder, until="export", without=frozenset({"compare"}))
    return Run(smoke_case(), folder)


@pytest.fixture(scope="module")
def straight(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """One fiber along y through the middle of its duct, up to the air's surface."""
    case = Case.model_validate(
        {
            "mat": {
                "generator": "array",
                "arrangement": "square",
                "solidity": SOLIDITY,
                "fiber_diameter": DIAMETER,
                "rows": 1,
            },
            "enclosure": {"inlet": 2 * DIAMETER, "outlet": 2 * DIAMETER},
            "surface": {"sides": 24},
            "flow": {"face_velocity": 0.025},
        }
    )
    folder = tmp_path_factory.mktemp("straight") / "run"
    run(case, folder, until="enclosure")
    return Run(case, folder)


def assert_exact_planes(mesh: FaceMesh, found: Run) -> None:
    box = found.read(FluidDomain).box
    walls = {"inlet": (2, 0), "outlet": (2, 1), "xmin": (0, 0), "xmax": (0, 1), "ymin": (1, 0), "ymax": (1, 1)}
    for name, (axis, end) in walls.items():
        faces = mesh.patch(name)
        corners = mesh.corners[mesh.offsets[faces.start] : mesh.offsets[faces.stop]]
        assert set(mesh.points[corners, axis].tolist()) == {(box.lower, box.upper)[end][axis]}, name


def area(mesh: FaceMesh, name: str) -> float:
    return float(np.linalg.norm(mesh.polyhedra().areas[mesh.patch(name)], axis=1).sum())


@pytest.mark.openfoam
def test_a_straight_fiber_keeps_its_volume_and_its_patches_their_areas(straight: Run) -> None:
    domain, radius = straight.read(FluidDomain), 0.5 * DIAMETER
    mesh, measures = snapped(domain, TetmeshSettings(engine="snappy"))
    x, y, z = domain.box.size
    exact = math.pi * radius**2 * y
    # the fit's rounds leave a few hundred-thousandths; a looser comparison in SI hid that for long
    assert x * y * z - mesh.volume == pytest.approx(exact, rel=1e-4)
    # what the fit had to make good: ten chords, as long as a cell, cut off this share of a circle
    assert -(1 - 10 / (2 * math.pi) * math.sin(2 * math.pi / 10)) < measures.raw_volume_error < 0
    for name, wanted in {"inlet": x * y, "outlet": x * y, "xmin": y * z, "xmax": y * z}.items():
        assert area(mesh, name) == pytest.approx(wanted, rel=1e-9), name
    for name in ("ymin", "ymax"):
        # the fit keeps the volume as a whole, not each section
        assert area(mesh, name) == pytest.approx(x * z - math.pi * radius**2, rel=2e-3), name
    # a polygon around the circle's area is longer than the circle by a percent at most
    assert area(mesh, FIBERS) == pytest.approx(2 * math.pi * radius * y, rel=0.02)
    assert_exact_planes(mesh, straight)


@pytest.mark.openfoam
def test_two_processes_give_the_same_air(straight: Run) -> None:
    one, _ = snapped(straight.read(FluidDomain), TetmeshSettings(engine="snappy"))
    two, _ = snapped(straight.read(FluidDomain), TetmeshSettings(engine="snappy").changed(cores=2))
    assert tuple(patch.name for patch in two.patches) == PATCHES
    assert two.volume == pytest.approx(one.volume, rel=1e-9)
    # refinement is decided alike, but points are moved in another order
    assert two.cells == pytest.approx(one.cells, rel=0.02)
    assert_exact_planes(two, straight)


@pytest.mark.openfoam
def test_the_smoke_case_passes_every_limit_and_checkmesh(snapped_smoke: Run) -> None:
    mesh, domain = snapped_smoke.read(FaceMesh), snapped_smoke.read(FluidDomain)
    assert tuple(patch.name for patch in mesh.patches) == PATCHES
    assert_exact_planes(mesh, snapped_smoke)
    solid = domain.box.volume - domain.volume
    assert mesh.volume == pytest.approx(domain.volume, abs=1e-5 * solid)
    quality = snapped_smoke.read(QualityReport)
    # a side cut in two by a fiber is concave to checkMesh -allGeometry, which stops no solver
    assert quality.verdict in ("pass", "warn"), quality.reasons
    assert all(reason.startswith(("concavity", "face tets")) for reason in quality.reasons)
    text = foam(snapped_smoke.folder / "export" / "openfoam", "checkMesh")
    assert "Mesh OK." in text


@pytest.mark.openfoam
def test_the_case_beside_the_mesh_meshes_itself_again(snapped_smoke: Run) -> None:
    case = snapped_smoke.folder / "tetmesh" / "snappy"
    assert not (case / "constant/polyMesh").exists()
    subprocess.run(["bash", "-n", "submit.slurm"], cwd=case, check=True)
    text = foam(case, "./Allmesh", "1")
    assert "warning" not in text
    again = read_openfoam(case)
    # in meters, before cells are joined: the smoke case loses a handful of them
    assert 0 <= again.cells - snapped_smoke.read(FaceMesh).cells < 50
    assert again.volume == pytest.approx(snapped_smoke.read(FluidDomain).volume, rel=0.005)
    assert tuple(patch.name for patch in again.patches) == PATCHES


@pytest.mark.openfoam
def test_a_mesh_that_takes_too_long_is_ended_with_advice(straight: Run) -> None:
    settings = TetmeshSettings(engine="snappy", edge=0.1).changed(time_limit=0.5)
    with pytest.raises(StageError, match=r"limit, while .*raise tetmesh\.snappy\.time_limit"):
        snapped(straight.read(FluidDomain), settings)


def test_without_openfoam_the_run_ends_before_it_starts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(StageError, match=r"snappyHexMesh.* not found on the PATH; .*apt-get install openfoam"):
        run(smoke_case(), tmp_path / "run")
    assert not (tmp_path / "run").exists()
    with pytest.raises(StageError, match="decomposePar, mpirun and reconstructParMesh not found"):
        run(smoke_case(cores=2), tmp_path / "run")


def test_blocks_are_as_large_as_the_tetrahedra_asked_for() -> None:
    lower, upper = np.zeros(3), np.array([12.0, 12.0, 24.0])
    found = layout(lower, upper, np.array([[6.0, 6.0, 12.0]]), TetmeshSettings(engine="snappy", growth=0.4))
    # edge 0.6 -> cubes of 0.3; the largest edge, 3.0, allows two halvings: 1.2 -> 0.6 -> 0.3
    assert (found.counts, found.level, found.buffer) == ((10, 10, 20), 2, 5)
    even = layout(lower, upper, np.array([[6.0, 6.0, 12.0]]), TetmeshSettings(engine="snappy", growth=0.0))
    assert (even.counts, even.level) == ((40, 40, 80), 0)


@pytest.mark.openfoam
def test_a_fiber_that_fits_between_the_blocks_centers_is_found(straight: Run, tmp_path: Path) -> None:
    # two blocks of 1.4 diameters beside each other, and the fiber along their common edge: snappyHexMesh looks for the
    # surface on the lines between centers, none of which meets it
    settings = TetmeshSettings(engine="snappy")
    start = write_case(straight.read(FluidDomain), settings, tmp_path)
    assert min(straight.read(FluidDomain).box.size[:2]) / start.counts[0] > DIAMETER
    mesh, _ = snapped(straight.read(FluidDomain), settings, folder=tmp_path)
    assert area(mesh, FIBERS) > 0


def test_the_point_in_the_air_keeps_clear_of_the_fibers_and_of_cell_faces() -> None:
    # a fiber that reaches into the plenum over half of the plan
    fibers = np.stack(np.meshgrid(np.linspace(0, 6, 61), np.linspace(0, 12, 121), [0.5]), axis=-1).reshape(-1, 3)
    found = layout(np.zeros(3), np.full(3, 12.0), fibers, TetmeshSettings(engine="snappy"))
    place = np.array(found.inside)
    assert place[0] > 6.0
    for halvings in range(found.level + 2):
        share = place / (1.2 / 2**halvings) % 1.0
        assert (np.abs(share - np.rint(share)) > 0.02).all()


def test_joined_cells_keep_the_air_and_stay_closed() -> None:
    mesh = duct((4, 4, 6)).face_mesh()
    # each of some cells into a neighbor that stays
    into = np.arange(mesh.cells)
    pairs = [(b, a) for a, b in zip(mesh.owner[: mesh.internal], mesh.neighbour, strict=True) if a % 7 == 0 and b % 7]
    into[[b for b, _ in pairs]] = [a for _, a in pairs]
    found, number = joined(mesh, into)
    before, after = mesh.polyhedra(), found.polyhedra()
    assert found.cells == mesh.cells - len({b for b, _ in pairs})
    np.testing.assert_allclose(np.bincount(number, before.volumes), after.volumes, rtol=1e-12)
    assert [patch.count for patch in found.patches] == [patch.count for patch in mesh.patches]
    np.testing.assert_allclose(closure(found), 0.0, atol=1e-14)


def test_cells_left_out_become_fiber() -> None:
    mesh = duct((4, 4, 6)).face_mesh()
    dropped = np.zeros(mesh.cells, dtype=bool)
    dropped[mesh.owner[mesh.patch(FIBERS)][:10]] = True
    found = without(mesh, dropped, FIBERS)
    assert found.volume == pytest.approx(mesh.volume - mesh.polyhedra().volumes[dropped].sum(), rel=1e-12)
    np.testing.assert_allclose(closure(found), 0.0, atol=1e-14)
    order = found.owner[: found.internal] * found.cells + found.neighbour
    assert (np.diff(order) > 0).all()


def closure(mesh: FaceMesh) -> np.ndarray:
    """Sum of the area vectors of each cell."""
    areas = mesh.polyhedra().areas
    sums = np.zeros((mesh.cells, 3))
    np.add.at(sums, mesh.owner, areas)
    np.subtract.at(sums, mesh.neighbour, areas[: mesh.internal])
    return sums
