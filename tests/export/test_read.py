"""Foreign meshes: every kind of cell, and files of strangers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import os
import signal
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.errors import StageError
from pipeline.export.formats import vtk_sizes
from pipeline.export.formats.vtk import write_vtk
from pipeline.export.read import read_mesh
from pipeline.export.settings import ExportSettings, Format
from pipeline.export.write import export
from pipeline.isolated import isolated
from tests.openfoam import AIR
from tests.quality.test_kinds import beside_smaller
from tests.sample_meshes import duct
from tests.security.inputs import in_time, seeds

BLOCK_POINTS = np.array([[x, y, z] for z in (0, 1, 2.0) for y in (0, 1.0) for x in (0, 1.0)])


def hexahedron_pyramids_and_wedges(folder: Path) -> Path:
    """Write a unit cube, a cube of six pyramids on it, and two prisms beside it, as `.vtu`."""
    import pyvista as pv

    middle = len(BLOCK_POINTS)
    points = np.concatenate([BLOCK_POINTS, [[0.5, 0.5, 1.5]], BLOCK_POINTS[:, [0, 1, 2]] + [1, 0, 0]])
    lower = [0, 1, 3, 2, 4, 5, 7, 6]
    quads = [[4, 5, 7, 6], [8, 10, 11, 9], [4, 8, 9, 5], [5, 9, 11, 7], [7, 11, 10, 6], [6, 10, 8, 4]]
    right = middle + 1
    # two prisms beside the lower cube, sharing its face x = 1
    wedges = [[1, right + 1, 3, 5, right + 5, 7], [right + 1, right + 3, 3, right + 5, right + 7, 7]]
    cells = {
        pv.CellType.HEXAHEDRON: np.array([lower]),
        pv.CellType.PYRAMID: np.array([[*quad, middle] for quad in quads]),
        pv.CellType.WEDGE: np.array(wedges),
    }
    path = folder / "mixed.vtu"
    pv.UnstructuredGrid(cells, points).save(path)
    return path


def test_hexahedra_pyramids_and_prisms_fit_together(tmp_path: Path) -> None:
    mesh = read_mesh(hexahedron_pyramids_and_wedges(tmp_path))
    # the cube, six pyramids of a sixth, two prisms of a half
    assert np.sort(mesh.polyhedra().volumes) == pytest.approx([1 / 6] * 6 + [0.5] * 2 + [1.0], rel=1e-12)
    # cube and pyramid, cube and prism, prism and prism, and 12 between the pyramids
    assert mesh.internal == 1 + 1 + 1 + 12
    assert [(patch.name, patch.count) for patch in mesh.patches] == [("boundary", mesh.faces - mesh.internal)]


@pytest.mark.parametrize("flipped", [False, True])
def test_prisms_are_read_in_either_convention(flipped: bool, tmp_path: Path) -> None:
    import meshio

    points = np.array([[x, y, z] for z in (0.0, 2.0) for x, y in ((0, 0), (1, 0), (0, 1))])
    corners = [3, 4, 5, 0, 1, 2] if flipped else [0, 1, 2, 3, 4, 5]
    meshio.write(tmp_path / "one.vtk", meshio.Mesh(points, [("wedge", np.array([corners]))]))
    assert read_mesh(tmp_path / "one.vtk").polyhedra().volumes.tolist() == pytest.approx([1.0])


def test_an_inside_out_tetrahedron_stays_one_for_the_judge(tmp_path: Path) -> None:
    import meshio

    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    meshio.write(tmp_path / "one.vtk", meshio.Mesh(points, [("tetra", np.array([[0, 2, 1, 3]]))]))
    assert read_mesh(tmp_path / "one.vtk").polyhedra().volumes[0] == pytest.approx(-1 / 6)


@pytest.mark.parametrize(
    ("name", "content", "told"),
    [
        ("none.vtu", None, "no such file"),
        ("notes.txt", b"hello", "known: an OpenFOAM case's folder"),
        ("empty.vtu", b"", "cannot read"),
        ("surface.stl", b"solid", "cannot tell the mesh format"),
        ("bomb.vtu", b'<!DOCTYPE a [<!ENTITY b "' + b"b" * 10 + b'">]><VTKFile>&b;', "cannot read"),
        ("empty.msh", b"$MeshFormat\n4.1 0 8\n", "cannot read"),
    ],
)
def test_what_is_no_mesh_is_one_clear_error(name: str, content: bytes | None, told: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(StageError, match=told):
        read_mesh(tmp_path / name)


def test_a_folder_without_a_mesh_says_so(tmp_path: Path) -> None:
    with pytest.raises(StageError, match=r"cannot read the mesh in .*constant/polyMesh.*points"):
        read_mesh(tmp_path)


def test_a_surface_is_no_volume_mesh(tmp_path: Path) -> None:
    import meshio

    meshio.write(tmp_path / "flat.vtu", meshio.Mesh(np.eye(3), [("triangle", np.array([[0, 1, 2]]))]))
    with pytest.raises(StageError, match="no tetrahedron, pyramid, prism or hexahedron"):
        read_mesh(tmp_path / "flat.vtu")


FORMATS: tuple[Format, ...] = ("vtk", "fluent", "gmsh", "abaqus", "nastran", "su2", "medit")


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("files")
    export(duct((3, 3, 5)).face_mesh(), folder, ExportSettings(formats=FORMATS), AIR, "symmetry")
    return [*sorted(folder.glob("*/mesh.*[!m]")), folder / "vtk/internal.vtu"]


@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_damaged_files_of_every_format_end_in_our_error_or_a_mesh(files: list[Path], data: st.DataObject) -> None:
    path = data.draw(st.sampled_from(files))
    content = path.read_bytes()
    at = int(data.draw(st.floats(0, 1)) * len(content))
    junk = data.draw(st.one_of(st.binary(max_size=8), st.sampled_from([b"-1", b" 99999999 ", b"nan", b"(", b")"])))
    keep = data.draw(st.booleans())
    broken = path.with_name(f"broken{path.suffix}")
    broken.write_bytes(content[:at] + junk + (content[at + len(junk) :] if keep else b""))
    with contextlib.suppress(StageError):
        assert read_mesh(broken).cells > 0


@pytest.mark.parametrize("name", ["polyhedra.vtu", "newer.vtu"])
def test_a_polyhedron_among_hexahedra_is_read_from_vtu(name: str, tmp_path: Path) -> None:
    # a unit cube as such, and another on it as a polyhedron of six faces
    (tmp_path / name).write_bytes(seeds()[name])
    mesh = read_mesh(tmp_path / name)
    assert (mesh.cells, mesh.faces, mesh.internal) == (2, 11, 1)
    assert mesh.volume == pytest.approx(2.0, rel=1e-12)


def test_what_vtk_itself_writes_of_hexahedra_and_polyhedra_is_read(tmp_path: Path) -> None:
    mesh = beside_smaller()
    write_vtk(mesh, tmp_path, {})
    found = read_mesh(tmp_path / "internal.vtu")
    assert (found.cells, found.faces, found.internal) == (mesh.cells, mesh.faces, mesh.internal)
    assert found.volume == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "inp", "bdf", "msh", "su2", "mesh"])
def test_a_pipe_in_the_place_of_a_mesh_is_refused_at_once(suffix: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / f"it.{suffix}")
    with in_time(), pytest.raises(StageError, match="it is"):
        read_mesh(tmp_path / f"it.{suffix}")


def test_a_pipe_in_the_place_of_openfoams_points_is_refused_at_once(tmp_path: Path) -> None:
    place = tmp_path / "constant/polyMesh"
    place.mkdir(parents=True)
    os.mkfifo(place / "points")
    with in_time(), pytest.raises(StageError, match="pipe"):
        read_mesh(tmp_path)


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("it.inp", "*INCLUDE, INPUT=/etc/hostname"),
        ("it.inp", "*Node, input = nodes.txt"),
        ("it.inp", "*element, TYPE=C3D4, INPUT=elements.txt"),
        ("it.bdf", "BEGIN BULK\nINCLUDE '/etc/hostname'"),
        ("it.bdf", "include it.bdf"),
        ("it.vtu", '<VTKFile type="PUnstructuredGrid"><X><Piece Source="it.vtu"/></X></VTKFile>'),
        ("it.vtm", '<VTKFile type="vtkMultiBlockDataSet"/>'),
        ("it.vtu", '<!DOCTYPE a [<!ENTITY e SYSTEM "/etc/hostname">]><VTKFile type="UnstructuredGrid">&e;</VTKFile>'),
    ],
)  # fmt: skip
def test_a_mesh_file_opens_no_other_file(name: str, line: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(line + "\n")
    with pytest.raises(StageError, match=r"other file|no XML|defines entities|not a mesh"):
        read_mesh(tmp_path / name)


def test_a_file_that_unpacks_to_a_hundred_times_its_size_is_refused_before_it_is_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import meshio

    # any file may hold a quarter of a gigabyte; here a megabyte
    monkeypatch.setattr(vtk_sizes, "ALWAYS", 2**20)
    path = tmp_path / "bomb.vtu"
    # 9.6 MB of zeros in a file of a hundredth and less
    meshio.write(path, meshio.Mesh(np.zeros((400_000, 3)), [("tetra", np.array([[0, 1, 2, 3]]))]))
    assert path.stat().st_size < 96_000
    with pytest.raises(StageError, match="it says that it holds"):
        read_mesh(path)


def test_a_grid_of_a_few_bytes_and_of_more_cells_than_there_is_memory_is_refused(tmp_path: Path) -> None:
    (tmp_path / "it.vtk").write_text(
        "# vtk DataFile Version 5.1\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 9000 9000 9000\nORIGIN 0 0 0\n"
        "SPACING 1 1 1\n"
    )
    with in_time(), pytest.raises(StageError, match="needs more memory than there is"):
        read_mesh(tmp_path / "it.vtk")


def test_a_reader_that_crashes_is_one_error(tmp_path: Path) -> None:
    def crash(_: Path) -> None:
        os.kill(os.getpid(), signal.SIGSEGV)

    (tmp_path / "it").touch()
    with pytest.raises(ValueError, match="crashed its reader \\(signal 11\\)"):
        isolated(crash, tmp_path / "it")


def test_a_mistake_in_a_reader_stays_one(tmp_path: Path) -> None:
    def stumble(_: Path) -> None:
        raise AttributeError("a bug")

    (tmp_path / "it").touch()
    with pytest.raises(RuntimeError, match="AttributeError: a bug"):
        isolated(stumble, tmp_path / "it")
