# SPDX-License-Identifier: GPL-3.0-or-later

import re
from pathlib import Path

import numpy as np
import pytest

from pipeline.errors import StageError
from pipeline.export.formats.fluent import write_fluent
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.read import read_mesh
from pipeline.export.settings import ExportSettings
from pipeline.export.write import FormatsFailedError, export
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.openfoam.read import read_openfoam
from tests.openfoam import AIR, figures, foam, patches
from tests.quality.test_checkmesh import BLOCK
from tests.sample_meshes import duct


@pytest.fixture(scope="module")
def mesh() -> FaceMesh:
    return duct((5, 5, 10), (10e-6, 10e-6, 20e-6), jitter=0.2).face_mesh()


@pytest.mark.openfoam
@pytest.mark.parametrize("program", ["fluentMeshToFoam", "fluent3DMeshToFoam"])
def test_openfoam_s_converters_find_the_same_mesh(mesh: FaceMesh, program: str, tmp_path: Path) -> None:
    write_openfoam(mesh, tmp_path / "case", AIR)
    write_fluent(mesh, tmp_path / "mesh.msh")
    for file in (tmp_path / "case/constant/polyMesh").iterdir():
        file.unlink()
    foam(tmp_path / "case", program, str(tmp_path / "mesh.msh"))
    text = foam(tmp_path / "case", "checkMesh", "-allTopology")
    assert "Mesh OK." in text
    assert re.search(rf"^ +cells: +{mesh.cells}$", text, re.MULTILINE)
    assert re.search(rf"^ +faces: +{mesh.faces}$", text, re.MULTILINE)
    assert re.search(rf"^ +internal faces: +{mesh.internal}$", text, re.MULTILINE)
    assert patches(text) == {patch.name: patch.count for patch in mesh.patches}
    assert figures(text)["total_volume"] == pytest.approx(mesh.polyhedra().volumes.sum(), rel=1e-9)


def test_vtk_s_fluent_reader_finds_the_same_cells(mesh: FaceMesh, tmp_path: Path) -> None:
    import pyvista as pv

    write_fluent(mesh, tmp_path / "mesh.msh")
    found = pv.FluentReader(str(tmp_path / "mesh.msh")).read()[0]
    assert found.n_cells == mesh.cells
    sizes = np.sort(found.compute_cell_sizes()["Volume"])
    # VTK keeps points with 32 bits
    assert sizes == pytest.approx(np.sort(mesh.polyhedra().volumes), rel=1e-5)


def test_our_reader_gives_the_mesh_back_to_the_last_bit(mesh: FaceMesh, tmp_path: Path) -> None:
    write_fluent(mesh, tmp_path / "mesh.msh")
    back = read_mesh(tmp_path / "mesh.msh")
    assert np.array_equal(back.points, mesh.points)
    assert np.array_equal(back.owner, mesh.owner)
    assert np.array_equal(back.neighbour, mesh.neighbour)
    assert back.patches == mesh.patches
    # a face may start with another corner
    assert np.allclose(back.polyhedra().areas, mesh.polyhedra().areas, rtol=1e-12, atol=0)


@pytest.mark.openfoam
def test_hexahedra_and_hanging_nodes_that_openfoam_wrote_are_read(mesh: FaceMesh, tmp_path: Path) -> None:
    write_openfoam(mesh, tmp_path, AIR)
    (tmp_path / "system/blockMeshDict").write_text(BLOCK)
    foam(tmp_path, "blockMesh")
    foam(tmp_path, "foamMeshToFluent")
    theirs = read_openfoam(tmp_path)
    ours = read_mesh(next((tmp_path / "fluentInterface").glob("*.msh")))
    assert (ours.cells, ours.faces, ours.internal) == (theirs.cells, theirs.faces, theirs.internal)
    assert {p.count for p in ours.patches} == {p.count for p in theirs.patches}
    assert np.sort(ours.polyhedra().volumes) == pytest.approx(np.sort(theirs.polyhedra().volumes), rel=1e-6)


def test_cyclic_sides_are_refused_with_the_way_to_get_them(mesh: FaceMesh, tmp_path: Path) -> None:
    with pytest.raises(StageError, match="make-periodic"):
        write_fluent(mesh, tmp_path / "mesh.msh", "cyclic")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("damage", "told"),
    [
        (lambda text: text[: len(text) // 2], "does not end|no faces|says"),
        (lambda text: text.replace("(10 (1", "(2010 (1"), "binary"),
        (lambda text: text.replace("(13 (3 ", "(13 (3 f"), "says"),
        (lambda text: "(0 nothing)", "no nodes or no faces"),
        (lambda text: text.replace(" 3 3)(", " 2 3)("), "contradict"),
    ],
)  # fmt: skip
def test_a_damaged_file_says_what_is_wrong(mesh: FaceMesh, damage: object, told: str, tmp_path: Path) -> None:
    path = tmp_path / "mesh.msh"
    write_fluent(mesh, path)
    assert callable(damage)
    path.write_text(damage(path.read_text()))
    with pytest.raises(StageError, match=told):
        read_mesh(path)


@pytest.mark.openfoam
def test_a_polyhedral_mesh_survives_openfoam_s_converter(tmp_path: Path) -> None:
    write_openfoam(duct((5, 5, 10), (10e-6, 10e-6, 20e-6)).face_mesh(), tmp_path / "case", AIR)
    foam(tmp_path / "case", "polyDualMesh", "-overwrite", "75")
    cells = read_openfoam(tmp_path / "case")
    assert np.diff(cells.offsets).max() > 4
    write_fluent(cells, tmp_path / "mesh.msh")
    for file in (tmp_path / "case/constant/polyMesh").iterdir():
        file.unlink()
    foam(tmp_path / "case", "fluent3DMeshToFoam", str(tmp_path / "mesh.msh"))
    text = foam(tmp_path / "case", "checkMesh")
    assert re.search(rf"^ +cells: +{cells.cells}$", text, re.MULTILINE)
    assert re.search(rf"^ +internal faces: +{cells.internal}$", text, re.MULTILINE)
    assert patches(text) == {patch.name: patch.count for patch in cells.patches}
    assert figures(text)["total_volume"] == pytest.approx(cells.volume, rel=1e-9)


def test_formats_of_tetrahedra_only_refuse_polyhedra_and_do_not_take_others_with_them(tmp_path: Path) -> None:
    pyramid = FaceMesh(
        np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]]),
        np.array([0, 3, 2, 1, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]),
        np.array([0, 4, 7, 10, 13, 16]),
        np.zeros(5, np.int64),
        np.empty(0, np.int64),
        1,
        (Patch("inlet", 0, 5),),
    )
    with pytest.raises(FormatsFailedError, match=r"gmsh: .* holds tetrahedra only.*tetmesh\.engine") as failure:
        export(pyramid, tmp_path, ExportSettings(formats=("gmsh", "vtk", "su2")), AIR, "symmetry")
    assert failure.value.written == ("vtk",)
    assert list(failure.value.failed) == ["gmsh", "su2"]
    # nothing half written
    assert [path.name for path in tmp_path.iterdir()] == ["vtk"]
