# SPDX-License-Identifier: GPL-3.0-or-later

import re
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from pipeline.errors import StageError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.settings import ExportSettings, Format
from pipeline.export.write import export
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.openfoam.foam_file import Encoding
from pipeline.openfoam.read import read_openfoam
from tests.openfoam import AIR, figures, foam, patches
from tests.sample_meshes import TetMesh, duct


@pytest.fixture(scope="module")
def mesh() -> FaceMesh:
    return duct((5, 5, 10), (10e-6, 10e-6, 20e-6), jitter=0.2).face_mesh()


def assert_same(one: FaceMesh, other: FaceMesh) -> None:
    for name in ("points", "corners", "offsets", "owner", "neighbour"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    assert one.patches == other.patches
    assert one.cells == other.cells


@pytest.mark.parametrize("encoding", ["binary", "ascii"])
def test_the_mesh_comes_back_to_the_last_bit(mesh: FaceMesh, encoding: Encoding, tmp_path: Path) -> None:
    write_openfoam(mesh, tmp_path, AIR, settings=ExportSettings(encoding=encoding))
    assert_same(read_openfoam(tmp_path), mesh)


@pytest.mark.parametrize("encoding", ["binary", "ascii"])
def test_foamlib_reads_the_same_mesh(mesh: FaceMesh, encoding: Encoding, tmp_path: Path) -> None:
    from foamlib import FoamFile

    write_openfoam(mesh, tmp_path, AIR, settings=ExportSettings(encoding=encoding))
    folder = tmp_path / "constant/polyMesh"
    assert np.array_equal(np.asarray(FoamFile(folder / "points")[()]), mesh.points)
    assert np.array_equal(np.asarray(FoamFile(folder / "owner")[()]), mesh.owner)


@pytest.mark.openfoam
@pytest.mark.parametrize("encoding", ["binary", "ascii"])
def test_checkmesh_counts_what_was_written(mesh: FaceMesh, encoding: Encoding, tmp_path: Path) -> None:
    write_openfoam(mesh, tmp_path, AIR, settings=ExportSettings(encoding=encoding))
    text = foam(tmp_path, "checkMesh", "-allTopology")
    assert "Mesh OK." in text
    for name, count in (("points", len(mesh.points)), ("faces", mesh.faces), ("cells", mesh.cells)):
        assert re.search(rf"^ +{name}: +{count}$", text, re.MULTILINE), name
    assert patches(text) == {patch.name: patch.count for patch in mesh.patches}
    assert figures(text)["total_volume"] == pytest.approx(mesh.polyhedra().volumes.sum(), rel=1e-9)


@pytest.mark.openfoam
@pytest.mark.parametrize("sides", ["symmetry", "slip"])
def test_allrun_solves_the_case_and_conserves_mass(mesh: FaceMesh, sides: str, tmp_path: Path) -> None:
    write_openfoam(mesh, tmp_path, AIR, sides)
    told = foam(tmp_path, "./Allrun")
    values = {
        name: float((tmp_path / f"postProcessing/{name}/0/surfaceFieldValue.dat").read_text().split()[-1])
        for name in ("inletPressure", "inletFlow", "outletFlow")
    }
    flow = 0.025 * 1e-10
    assert -values["inletFlow"] == pytest.approx(flow, rel=1e-9)
    assert values["outletFlow"] == pytest.approx(flow, rel=1e-5)
    assert values["inletPressure"] > 0
    # OpenFOAM's pressure is over the density: the script says so, and tells pascals
    assert f"pressure drop: {AIR.density * values['inletPressure']:.5g} Pa" in told
    foam(tmp_path, "./Allclean")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["0", "Allclean", "Allrun", "case.foam", "constant", "system"]


def boundary_types(case: Path) -> dict[str, str]:
    text = (case / "constant/polyMesh/boundary").read_text()
    return dict(re.findall(r"^ {4}(\w+)\n +\{\n +type (\w+);", text, re.MULTILINE))


def test_a_side_that_is_no_exact_plane_is_not_called_one(tmp_path: Path) -> None:
    # simpleFoam stops at a symmetryPlane whose faces tilt by more than 3e-8
    tets = duct((4, 4, 8))
    points = tets.points.copy()
    on_xmin = np.flatnonzero((points[:, 0] == 0) & (points[:, 1] == 0.5))
    points[on_xmin[:1], 0] = 1e-9
    bent = TetMesh(points, tets.tets, tets.faces, tets.patch, tets.patches, tets.slab).face_mesh()
    write_openfoam(bent, tmp_path, AIR)
    types = boundary_types(tmp_path)
    assert types["xmin"] == "symmetry"
    assert types["xmax"] == types["ymin"] == types["ymax"] == "symmetryPlane"
    assert types["fibers"] == "wall"
    assert types["inlet"] == types["outlet"] == "patch"


def test_a_duct_without_an_inlet_is_refused(mesh: FaceMesh, tmp_path: Path) -> None:
    closed = tuple(
        Patch("fibers", mesh.internal, mesh.faces - mesh.internal) if k == 0 else Patch(name, mesh.faces, 0)
        for k, name in enumerate(("fibers", "inlet", "outlet"))
    )
    blocked = FaceMesh(mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, mesh.cells, closed)
    with pytest.raises(StageError, match="no face in patch inlet and outlet"):
        write_openfoam(blocked, tmp_path / "case", AIR)
    assert not (tmp_path / "case").exists()


def test_writing_twice_gives_the_same_bytes(mesh: FaceMesh, tmp_path: Path) -> None:
    # no dates, no machine's names: results are compared by their content
    for name in ("one", "two"):
        write_openfoam(mesh, tmp_path / name, AIR)
    files = sorted(p.relative_to(tmp_path / "one") for p in (tmp_path / "one").rglob("*") if p.is_file())
    assert len(files) == len(sorted((tmp_path / "two").rglob("*"))) - 4  # less its folders
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes(), file


@pytest.mark.parametrize(
    ("kind", "encoding"),
    [("openfoam", "binary"), ("openfoam", "ascii"), ("fluent", "ascii"), ("su2", "ascii"), ("vtk", "binary")],
)
def test_writing_takes_less_than_four_times_the_mesh_s_memory(kind: Format, encoding: Encoding, tmp_path: Path) -> None:
    mesh = duct((13, 13, 26), hole=False).face_mesh()
    own = sum(getattr(mesh, name).nbytes for name in ("points", "corners", "offsets", "owner", "neighbour"))
    settings = ExportSettings(formats=(kind,), encoding=encoding)
    # once before, so that loading libraries does not count
    export(mesh, tmp_path, settings, AIR, "symmetry")
    tracemalloc.start()
    export(mesh, tmp_path, settings, AIR, "symmetry")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 4 * own
