"""What fuzzing found: each of these once took the machine, the time or the terminal."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import os
import re
from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import psutil
import pytest

from pipeline.analytics.options import read_options
from pipeline.analytics.settings import FilterSettings, FlowSettings
from pipeline.case import LARGEST_FILE, override, read_case, read_toml
from pipeline.cli.bundled import bundled
from pipeline.cli.printable import printable
from pipeline.errors import CaseError, StageError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.read import read_mesh
from pipeline.export.settings import ExportSettings
from pipeline.line.run import Run
from pipeline.mat import exchange
from pipeline.microscope.read import read_micrograph
from pipeline.units import parse
from tests.openfoam import AIR
from tests.sample_meshes import duct
from tests.security.inputs import in_time, seeds


def test_a_label_of_forty_digits_is_our_error(tmp_path: Path) -> None:
    write_openfoam(duct((2, 2, 3)).face_mesh(), tmp_path, AIR, settings=ExportSettings(encoding="ascii"))
    faces = tmp_path / "constant/polyMesh/faces"
    faces.write_text(faces.read_text().replace("3(", "9" * 40 + "(", 1))
    with pytest.raises(StageError, match="cannot read the mesh"):
        read_mesh(tmp_path)


@pytest.mark.parametrize("text", ["1 m^9^9^9^9", "1 m**9**9**9**9", "1 m^999999999"])
def test_a_unit_is_no_formula_that_computes_for_good(text: str) -> None:
    with in_time(), pytest.raises(ValueError, match="number with a unit"):
        parse(text, "m")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("a" + ".a" * 5000 + " = 1", "line 1, nests tables more than 20 deep"),
        ("[mat]\n'a'" + ' . "b"' * 12_000 + " = 1", "line 2, nests tables more than 20 deep"),
        ("[a" + ".a" * 40_000 + "]", "line 1, nests tables more than 20 deep"),
        ("x = {a" + ".a" * 40_000 + " = 1}", "line 1, nests tables more than 20 deep"),
        ("[mat]\nseed = 1" + "0" * 400, "integer of more than 19 digits"),
        ("[mat]\nside = -1" + "0" * 400, "integer of more than 19 digits"),
        ("[mat]\nside = [[1" + "0" * 400 + "]]", "integer of more than 19 digits"),
        ("a = " + "[" * 5000, "not valid TOML"),
        ("[mat]\nseed = " + "9" * 5000, "not valid TOML"),
        ("#" * LARGEST_FILE + "\n", "more than 100,000 bytes"),
        ("".join(f"[t{k}]\n" for k in range(3000)), "and 2981 more"),
        ("[mat]\ngenerator = '" + "x" * 50_000 + "'", r"not 'x+ \.\.\."),
    ],
)
def test_case_files_of_strangers_are_refused_in_a_few_lines(content: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(content)
    with in_time(), pytest.raises(CaseError, match=told) as caught:
        read_case(path)
    assert len(str(caught.value)) < 12_000


def test_quoted_text_is_no_name_however_many_points_it_has(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text('# 1.2.3.4.5.6\n[mat]\nfile = "' + "a.b/" * 300 + '"\n[x]\n' + "y" * 60_000 + " = 1\n")
    with in_time():
        assert read_toml(path)["mat"]["file"] == "a.b/" * 300


@pytest.mark.parametrize("kind", ["pipe", "device", "folder", "link to nothing", "link to itself", "link to a pipe"])
def test_only_a_file_is_read_as_one(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "input"
    told = {"pipe": "is a pipe", "device": "is a device", "folder": "directory|no file", "link to a pipe": "is a pipe"}
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "device":
            path.symlink_to("/dev/zero")
        case "folder":
            path.mkdir()
        case "link to nothing":
            path.symlink_to("nothing")
        case "link to itself":
            path.symlink_to(path)
        case _:
            os.mkfifo(tmp_path / "pipe")
            path.symlink_to("pipe")
    for read in (read_case, exchange.read_fibers):
        with in_time(), pytest.raises(CaseError, match=told.get(kind, "link")):
            read(path)


def test_a_path_with_a_zero_byte_is_no_path() -> None:
    with pytest.raises(CaseError, match="null byte"):
        exchange.read_fibers(Path("fibers\0.csv"))


def test_a_value_of_a_novel_is_refused_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "fibers.csv"
    path.write_text("fiber,x [um],y [um],z [um],radius [nm]\na," + "5" * 200_000 + ",5,1,500\n")
    with in_time(), pytest.raises(CaseError, match="line 2: field larger than field limit"):
        exchange.read_fibers(path)


def test_a_huge_integer_in_a_runs_case_is_our_error(tmp_path: Path) -> None:
    content = read_case(bundled()["smoke"]).content()
    for value in (10**400, -(10**400)):
        content["flow"]["temperature"] = value
        (tmp_path / "case.json").write_text(json.dumps(content))
        with pytest.raises(StageError, match="cannot read"):
            Run.opened(tmp_path)


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("flow.face_velocity=1000 m/s", "flow: face_velocity is 1000 m/s, Mach 2.9"),
        ("flow.face_velocity=1e9 m/s", "Mach 2.9e.06"),
        ("flow.temperature=1 K", "flow: temperature is 1 K: the properties of air are known from 170 to 1900 K"),
        ("flow.temperature=1e5 K", "known from 170 to 1900 K"),
        ("flow.pressure=1e12 Pa", "flow: pressure is 1e.12 Pa: air is an ideal gas up to"),
    ],
)
def test_physics_that_the_equations_do_not_hold_for_is_refused(override: str, told: str) -> None:
    with pytest.raises(CaseError, match=told):
        read_case(bundled()["smoke"], (override,))
    key, value = override.removeprefix("flow.").split("=")
    with pytest.raises(CaseError, match=told.removeprefix("flow: ")):
        read_options({"solidity": "5 %", "thickness": "1 mm", "fiber_diameter": "2 um", key: value})


def test_what_is_fine_alone_may_be_too_fast_together() -> None:
    # 100 m/s is Mach .29 at 293 K and .38 at 170 K
    medium = FilterSettings(solidity=0.05, thickness=1e-3, fiber_diameter=2e-6)
    with pytest.raises(CaseError, match=r"face_velocity is 100 m/s, Mach 0\.38"):
        read_options({"face_velocity": "100 m/s"}, medium, FlowSettings(temperature=170.0))


def test_an_override_is_as_shallow_as_a_case() -> None:
    with pytest.raises(CaseError, match=r"write table\.key=value"):
        override({}, ("a" + ".a" * 5000 + "=1",))


def test_fibers_have_a_largest_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exchange, "LARGEST_FILE", 100)
    path = tmp_path / "fibers.csv"
    path.write_text("#" * 101)
    with pytest.raises(CaseError, match="more than 100 bytes"):
        exchange.read_fibers(path)


def test_a_label_that_lies_about_the_cells_costs_no_memory(tmp_path: Path) -> None:
    write_openfoam(duct((2, 2, 3)).face_mesh(), tmp_path, AIR, settings=ExportSettings(encoding="ascii"))
    neighbour = tmp_path / "constant/polyMesh/neighbour"
    lines = neighbour.read_text().split("\n")
    lines[lines.index("(") + 1] = "2000000000"
    neighbour.write_text("\n".join(lines))
    with pytest.raises(StageError, match="2000000001 cells"):
        read_mesh(tmp_path)


def test_a_compressed_mesh_that_unpacks_to_more_than_the_memory_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "bomb.vtu"
    meshio.write(path, meshio.Mesh(np.zeros((8_000_000, 3)), [("tetra", np.array([[0, 1, 2, 3]]))]))
    # 192 MB of zeros in a file of a fiftieth of that
    assert path.stat().st_size < 4_000_000
    # the reader's libraries take memory too, when they are loaded first
    (tmp_path / "sound.vtu").write_bytes(seeds()["polyhedra.vtu"])
    read_mesh(tmp_path / "sound.vtu")
    monkeypatch.setattr(psutil, "virtual_memory", lambda: SimpleNamespace(available=20_000_000))
    with pytest.raises(StageError, match="emory"):
        read_mesh(path)


def test_a_stranger_does_not_steer_the_terminal() -> None:
    # the first would clear the screen, the second set the window's title
    assert printable("\x1b[2Jcell\x1b]0;title\x07\nnext") == "?[2Jcell?]0;title?\nnext"


def test_a_number_too_few_in_a_text_file_is_our_error(tmp_path: Path) -> None:
    path = tmp_path / "short.vtu"
    path.write_bytes(seeds()["polyhedra.vtu"].replace(b"0 0 0 ", b"0 0 ", 1))
    with pytest.raises(StageError, match="cannot read"):
        read_mesh(path)


@pytest.mark.parametrize("content", [b"II*\0", b"MM\0*", b"II+\0\x08\0", b"II*\0\x08\0\0\0"])
def test_the_head_of_a_picture_alone_is_no_picture(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "cut.tif"
    path.write_bytes(content)
    with pytest.raises(CaseError, match=r"cut\.tif is damaged, or no TIFF that can be read"):
        read_micrograph(path, 25e-9)


def test_polyhedra_without_faces_are_our_error(tmp_path: Path) -> None:
    path = tmp_path / "bare.vtu"
    whole = seeds()["polyhedra.vtu"]
    path.write_bytes(
        re.sub(rb'<DataArray type="Int64" Name="face(s|offsets)".*?</DataArray>\n', b"", whole, flags=re.DOTALL)
    )
    with pytest.raises(StageError, match=r"cannot read .*bare\.vtu: "):
        read_mesh(path)
