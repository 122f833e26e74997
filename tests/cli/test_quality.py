"""`fibertwin quality` on meshes from other tools, and on what is no mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from pipeline.cli.judging import EXIT_CODES
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.settings import ExportSettings
from pipeline.export.write import export
from pipeline.geometry.box import Box
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import PATCHES
from tests.cli.conftest import Fibertwin
from tests.openfoam import AIR, foam
from tests.quality.test_checkmesh import BLOCK, SNAPPY
from tests.sample_meshes import TetMesh, boundary_of, duct

SIZE = (10e-6, 10e-6, 20e-6)


def good_mesh() -> FaceMesh:
    """Split each cube of a duct at its center and its faces' centers, so that no cell has two boundary faces."""
    cells = (4, 4, 8)
    spacing = np.array(SIZE) / cells
    corner = np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), axis=-1).reshape(-1, 1, 1, 3)
    tets = []
    for axis, side in itertools.product(range(3), (0.0, 1.0)):
        u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
        ring = [side * np.eye(3)[axis] + a * u + b * v for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        middle = sum(ring) / 4
        for k in range(4):
            tet = np.array([ring[k], ring[(k + 1) % 4], middle, np.full(3, 0.5)])
            tets.append(tet if np.linalg.det(tet[1:] - tet[0]) > 0 else tet[[1, 0, 2, 3]])
    # half spacings are whole numbers, so equal points are equal
    doubled = (2 * (corner + np.array(tets))).astype(np.int64).reshape(-1, 3)
    points, index = np.unique(doubled, axis=0, return_inverse=True)
    return named(0.5 * points * spacing, index.reshape(-1, 4)).face_mesh()


def named(points: Floats, tets: Ints) -> TetMesh:
    faces = boundary_of(tets)
    patch = np.zeros(len(faces), np.int64)
    for name, axis, value in (
        ("inlet", 2, 0.0), ("outlet", 2, SIZE[2]), ("xmin", 0, 0.0), ("xmax", 0, SIZE[0]),
        ("ymin", 1, 0.0), ("ymax", 1, SIZE[1]),
    ):  # fmt: skip
        patch[np.isclose(points[faces][:, :, axis], value, rtol=0, atol=1e-12).all(axis=1)] = PATCHES.index(name)
    return TetMesh(points, tets, faces, patch, PATCHES[:-1], Box((0.0, 0.0, 0.0), SIZE))


def bad_mesh() -> FaceMesh:
    # points moved by a quarter of their spacing: every cell still has a volume, but some are slivers
    return duct((4, 4, 8), SIZE, hole=False, jitter=0.28).face_mesh()


@pytest.mark.parametrize("kind", ["openfoam", "vtk", "fluent", "gmsh", "su2"])
def test_a_good_mesh_of_any_format_passes_with_exit_code_0(fibertwin: Fibertwin, kind: str, tmp_path: Path) -> None:
    export(good_mesh(), tmp_path, ExportSettings(formats=(kind,)), AIR, "symmetry")
    place = tmp_path / kind
    if kind != "openfoam":
        place = next(path for path in sorted(place.iterdir()) if path.suffix in (".vtu", ".msh", ".su2"))
    said = fibertwin("quality", place)
    # 24 tetrahedra in each of 4 x 4 x 8 cubes
    assert "3,072 cells" in said.out
    assert "every limit holds" in said.out
    assert said.code == 0


def test_limits_that_fall_short_have_their_own_exit_codes_and_reasons(fibertwin: Fibertwin, tmp_path: Path) -> None:
    write_openfoam(bad_mesh(), tmp_path, AIR)
    said = fibertwin("quality", tmp_path)
    assert said.code == EXIT_CODES["warn"] == 3
    assert "\n- " in said.out
    assert fibertwin("quality", tmp_path, "--fail-on", "fail", "--quiet").code == 0


def test_what_no_solver_takes_is_exit_code_4_whatever_one_fails_on(fibertwin: Fibertwin, tmp_path: Path) -> None:
    mesh = good_mesh()
    # one inner point pulled through its cells
    points = mesh.points.copy()
    inner = np.setdiff1d(np.arange(len(points)), mesh.corners[mesh.offsets[mesh.internal] :])
    points[inner[0]] += 5e-6
    write_openfoam(dataclasses.replace(mesh, points=points), tmp_path, AIR)
    for severity in ("warn", "fail"):
        assert fibertwin("quality", tmp_path, "--fail-on", severity).code == EXIT_CODES["fail"] == 4


def test_json_names_the_worst_cells_and_where_they_are(fibertwin: Fibertwin, tmp_path: Path) -> None:
    write_openfoam(bad_mesh(), tmp_path, AIR)
    said = fibertwin("quality", tmp_path, "--json")
    metric = json.loads(said.out)["metrics"]["non_orthogonality"]
    _, angle, place = metric["worst"][0]
    assert angle == metric["max"]
    assert (np.array(place) > 0).all()
    assert (np.array(place) < SIZE).all()
    # progress goes to the other stream, and JSON wants none
    assert said.err == ""


def test_quiet_leaves_the_exit_code_to_tell(fibertwin: Fibertwin, tmp_path: Path) -> None:
    write_openfoam(bad_mesh(), tmp_path, AIR)
    said = fibertwin("quality", tmp_path, "--quiet")
    assert (said.code, said.out, said.err) == (3, "", "")


def test_limits_come_from_a_case_file(fibertwin: Fibertwin, tmp_path: Path) -> None:
    write_openfoam(good_mesh(), tmp_path / "mesh", AIR)
    strict = tmp_path / "strict.toml"
    fibertwin("init", strict)
    strict.write_text(strict.read_text().replace("#skewness = 4", "skewness = 0.2"))
    # the triangles on the sides have a skewness of a quarter
    assert fibertwin("quality", tmp_path / "mesh").code == 0
    said = fibertwin("quality", tmp_path / "mesh", "--limits", strict)
    assert said.code == 4
    assert "< 0.2" in said.out


def test_volumes_are_shown_in_units_of_the_cells_size(fibertwin: Fibertwin, tmp_path: Path) -> None:
    write_openfoam(good_mesh(), tmp_path, AIR)
    # a cube of 2.5 um in 24 tetrahedra: 0.651 um3 each
    row = next(line for line in fibertwin("quality", tmp_path).out.splitlines() if line.startswith("volume [um3]"))
    assert row.split()[2:4] == ["0.651", "0.651"]


@pytest.mark.openfoam
def test_hexahedra_and_hanging_nodes_and_duals_of_openfoams_meshers(fibertwin: Fibertwin, tmp_path: Path) -> None:
    write_openfoam(duct((5, 5, 10), SIZE, jitter=0.2).face_mesh(), tmp_path, AIR)
    foam(tmp_path, "polyDualMesh", "-overwrite", "75")
    assert "cells" in fibertwin("quality", tmp_path).out
    (tmp_path / "system/blockMeshDict").write_text(BLOCK)
    (tmp_path / "system/snappyHexMeshDict").write_text(SNAPPY)
    foam(tmp_path, "blockMesh")
    said = fibertwin("quality", tmp_path)
    assert "1,024 cells" in said.out
    assert said.code == 0
    foam(tmp_path, "snappyHexMesh", "-overwrite")
    said = fibertwin("quality", tmp_path)
    # a side that is cut in two beside smaller cells is concave to checkMesh -allGeometry, and to no solver
    assert said.code == 3
    assert [line.split(":")[0] for line in said.out.splitlines() if line.startswith("- ")] == ["- concavity"]
    assert "1,024 cells" not in said.out


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("none.vtu", None),
        ("notes.txt", b"hello"),
        ("empty.msh", b""),
        ("binary.cas", b"(0 grid)\n(3010 (1 1 8 1 3)(\x00\x01"),
        ("cut.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n"),
        ("foreign.vtu", b"<?xml version='1.0'?><svg/>"),
    ],
)
def test_what_is_no_mesh_is_one_line_and_exit_code_1(
    fibertwin: Fibertwin, name: str, content: bytes | None, tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    said = fibertwin("quality", tmp_path / name, "--json")
    assert said.code == 1
    assert said.out == ""
    assert said.err.startswith("error: ")
    assert said.err.count("\n") == 1
    assert name in said.err
