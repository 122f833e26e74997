"""Every message that the troubleshooting page shows is what the program says."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
import shlex
from pathlib import Path

import meshio
import numpy as np
import pytest

from pipeline.cli.bundled import bundled
from tests.cli.conftest import Fibertwin
from tests.cli.conftest import fibertwin as fibertwin  # the fixture
from tests.security.inputs import seeds

PAGE = (Path(__file__).parents[2] / "docs/troubleshooting.md").read_text(encoding="utf-8")
SHOWN = re.findall(r"```sh\nfibertwin ([^\n]*)\n```\n\n```text\n(.*?)\n```", PAGE, re.DOTALL)


@pytest.fixture(name="folder")
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fibertwin: Fibertwin) -> Path:
    """Make the files that the page's commands name."""
    (tmp_path / "case.toml").write_bytes(bundled()["smoke"].read_bytes())
    (tmp_path / "mistakes.toml").write_text(
        '[mat]\ngenerator = "layered"\nside = 20\nfiber_diameter = "1.4 um"\nrelaxation_slope = 0.15\n'
        "relaxation_slop = 0.2\n\n[mat.stop]\ncoverage = 1\n"
    )
    (tmp_path / "own.toml").write_text('[mat]\ngenerator = "file"\nfile = "fibers.csv"\n')
    (tmp_path / "fibers.csv").write_text("fiber,x [um],y [um],z [um],radius [um]\n1,0,5,1,0.7\n1,ten,5,1,0.7\n")
    (tmp_path / "notes.txt").write_text("hello\n")
    (tmp_path / "broken.vtu").write_text("<svg/>")
    (tmp_path / "binary.cas").write_bytes(b"(3010 (1 1 8 1 3)(\x00\x01")
    (tmp_path / "empty").mkdir()
    (tmp_path / "mesh.vtu").write_bytes(seeds()["polyhedra.vtu"])
    meshio.write(tmp_path / "skin.vtu", meshio.Mesh(np.eye(3), [("triangle", np.array([[0, 1, 2]]))]))
    (tmp_path / "wrong.vtu").write_bytes(seeds()["polyhedra.vtu"].replace(b"31", b"30", 1))
    (tmp_path / "begun").mkdir()
    monkeypatch.chdir(tmp_path)
    assert fibertwin("run", "case.toml", "--until", "mat", "--out", "done", "--quiet").code == 0
    (tmp_path / "begun/case.json").write_bytes((tmp_path / "done/case.json").read_bytes())
    return tmp_path


@pytest.mark.parametrize(("command", "message"), SHOWN, ids=[command for command, _ in SHOWN])
def test_the_message_is_the_programs_own(fibertwin: Fibertwin, folder: Path, command: str, message: str) -> None:
    said = fibertwin(*shlex.split(command))
    assert said.code in (1, 2)
    assert said.err[said.err.index("error: ") :].rstrip() == message


def test_the_page_shows_messages_of_every_kind() -> None:
    assert len(SHOWN) >= 24
