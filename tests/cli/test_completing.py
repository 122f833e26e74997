"""What the tabulator key offers, by the script that bash itself runs."""

# SPDX-License-Identifier: GPL-3.0-or-later

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pipeline.cli.app import app
from pipeline.cli.bundled import bundled
from pipeline.export.formats.registry import WRITTEN
from pipeline.line.run import STAGES
from pipeline.report.views.scenes import SCENES

BASH = shutil.which("bash")
_TAB = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_fibertwin
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture(scope="module")
def scripts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scripts")
    (folder / "complete.bash").write_text(app.generate_completion(prog_name="fibertwin", shell="bash"))
    program = folder / "fibertwin"
    root = Path(__file__).parents[2]
    program.write_text(f'#!/bin/sh\nPYTHONPATH="{root}" exec "{sys.executable}" -m pipeline.cli "$@"\n')
    program.chmod(0o755)
    return folder


def offered(scripts: Path, folder: Path, *words: str) -> list[str]:
    """Press the tabulator key after these words, in a folder."""
    assert BASH is not None
    command = [BASH, "-c", _TAB, "bash", str(scripts / "complete.bash"), str(scripts / "fibertwin"), *words]
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    assert answer.stderr == ""
    return answer.stdout.split()


@pytest.mark.skipif(BASH is None, reason="bash is not on the PATH")
def test_cases_stages_formats_and_views_are_offered_by_name(scripts: Path, tmp_path: Path) -> None:
    assert set(bundled()) <= set(offered(scripts, tmp_path, "run", ""))
    assert offered(scripts, tmp_path, "run", "smo") == ["smoke"]
    assert offered(scripts, tmp_path, "run", "smoke", "--until", "") == list(STAGES)
    assert offered(scripts, tmp_path, "export", "a", "--format", "") == list(WRITTEN)
    assert offered(scripts, tmp_path, "view", "a", "--scene", "flow") == [name for name in SCENES if name[:4] == "flow"]


@pytest.mark.skipif(BASH is None, reason="bash is not on the PATH")
def test_case_files_and_folders_are_offered_beside_them_and_nothing_else(scripts: Path, tmp_path: Path) -> None:
    (tmp_path / "runs/first").mkdir(parents=True)
    (tmp_path / "mine.toml").write_text("")
    (tmp_path / "notes.txt").write_text("")
    (tmp_path / ".hidden").mkdir()
    assert set(offered(scripts, tmp_path, "run", "")) == {*bundled(), "mine.toml", "runs/"}
    assert offered(scripts, tmp_path, "report", "runs/") == ["runs/first/"]
    # the second run too
    assert offered(scripts, tmp_path, "report", "runs/first", "runs/f") == ["runs/first/"]
    assert offered(scripts, tmp_path, "predict", "--from", "ru") == ["runs/"]
