"""What fuzzing found: each of these once took the machine, the time or the terminal."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import psutil
import pytest

from pipeline.case import LARGEST_FILE, override, read_case
from pipeline.cli.printable import printable
from pipeline.errors import CaseError, StageError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.read import read_mesh
from pipeline.export.settings import ExportSettings
from pipeline.mat import exchange
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
        ("a" + ".a" * 5000 + " = 1", "more than 20 deep"),
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


def test_a_file_without_an_end_is_refused() -> None:
    with in_time(), pytest.raises(CaseError, match="more than"):
        read_case(Path("/dev/zero"))


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
