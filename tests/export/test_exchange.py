"""Other tools' formats, each read back by meshio, and gmsh's by OpenFOAM too."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import meshio
import numpy as np
import pytest
from pydantic import ValidationError

from pipeline.export.read import read_mesh
from pipeline.export.settings import ExportSettings, Format
from pipeline.export.write import export
from pipeline.geometry.tets import volumes
from pipeline.nouns.mesh import FaceMesh
from tests.openfoam import AIR, figures, foam, patches
from tests.sample_meshes import duct

FILES: dict[Format, str] = {
    "gmsh": "mesh.msh", "abaqus": "mesh.inp", "nastran": "mesh.bdf", "su2": "mesh.su2", "medit": "mesh.mesh",
}  # fmt: skip


@pytest.fixture(scope="module")
def mesh() -> FaceMesh:
    return duct((4, 4, 8), (10e-6, 10e-6, 20e-6), jitter=0.2).face_mesh()


@pytest.fixture(scope="module")
def written(mesh: FaceMesh, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export")
    export(mesh, folder, ExportSettings(formats=tuple(FILES)), AIR, "symmetry")
    return folder


@pytest.mark.parametrize("kind", FILES)
def test_cells_patches_and_volume_come_back(mesh: FaceMesh, written: Path, kind: Format) -> None:
    back = read_mesh(written / kind / FILES[kind])
    assert (back.cells, back.faces, back.internal) == (mesh.cells, mesh.faces, mesh.internal)
    # nastran's fields have room for 11 digits
    digits = 1e-9 if kind == "nastran" else 1e-12
    assert np.sort(back.polyhedra().volumes) == pytest.approx(np.sort(mesh.polyhedra().volumes), rel=digits)
    counts = {patch.name: patch.count for patch in mesh.patches}
    if kind == "medit":
        # by number
        assert [patch.count for patch in back.patches] == list(counts.values())
    else:
        assert {patch.name: patch.count for patch in back.patches} == counts


@pytest.mark.parametrize("kind", FILES)
def test_meshio_finds_the_same_tetrahedra_and_triangles(mesh: FaceMesh, written: Path, kind: Format) -> None:
    found = meshio.read(written / kind / FILES[kind])
    tets = np.concatenate([block.data for block in found.cells if block.type == "tetra"])
    triangles = sum(len(block.data) for block in found.cells if block.type == "triangle")
    assert triangles == mesh.faces - mesh.internal
    assert np.sort(volumes(found.points, tets)) == pytest.approx(np.sort(mesh.polyhedra().volumes), rel=1e-9)


def test_su2_has_the_names_that_its_configuration_uses(mesh: FaceMesh, written: Path) -> None:
    text = (written / "su2/mesh.su2").read_text()
    assert [line[11:] for line in text.splitlines() if line.startswith("MARKER_TAG=")] == [
        f" {patch.name}" for patch in mesh.patches
    ]


@pytest.mark.parametrize("kind", ["nastran", "medit"])
def test_numbers_are_explained_beside_the_mesh(written: Path, kind: str) -> None:
    assert (written / kind / "patches.txt").read_text().startswith("1 fluid\n2 inlet\n3 outlet\n")


@pytest.mark.openfoam
def test_openfoam_reads_gmsh_with_the_patches_names(mesh: FaceMesh, written: Path, tmp_path: Path) -> None:
    export(mesh, tmp_path, ExportSettings(formats=("openfoam",)), AIR, "slip")
    case = tmp_path / "openfoam"
    for file in (case / "constant/polyMesh").iterdir():
        file.unlink()
    foam(case, "gmshToFoam", str(written / "gmsh/mesh.msh"))
    text = foam(case, "checkMesh", "-allTopology")
    assert patches(text) == {patch.name: patch.count for patch in mesh.patches}
    assert figures(text)["total_volume"] == pytest.approx(mesh.polyhedra().volumes.sum(), rel=1e-9)


@pytest.mark.parametrize(
    ("name", "reason"),
    [("off", "surface, not a volume"), ("xdmf", "lose the patches"), ("med", "HDF5"), ("openfaom", "openfoam")],
)
def test_a_format_that_cannot_keep_the_patches_is_refused(name: str, reason: str) -> None:
    with pytest.raises(ValidationError, match=reason):
        ExportSettings.model_validate({"formats": [name]})


def test_a_format_named_twice_is_refused() -> None:
    with pytest.raises(ValidationError, match="twice"):
        ExportSettings(formats=("vtk", "vtk"))
