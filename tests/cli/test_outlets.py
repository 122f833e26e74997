# SPDX-License-Identifier: GPL-3.0-or-later

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.processes.marks import Marked

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="/dev and sh")

FIBERTWIN = f"{sys.executable} -m pipeline.cli"


def in_shell(line: str, folder: Path, **around: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        ["bash", "-c", line], cwd=folder, env={**os.environ, **around}, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    "words",
    ["run smoke --until mat --out run", "run smoke --until mat --out run --json", "cases", "--help"],
)
def test_a_reader_that_leaves_early_ends_nothing_and_sees_no_traceback(words: str, tmp_path: Path) -> None:
    # `true` reads nothing at all: the first word already has no reader
    done = in_shell(f"set -o pipefail; {FIBERTWIN} {words} 2>errors | true; echo $?", tmp_path)
    assert done.stdout == "0\n", (tmp_path / "errors").read_text()
    assert (tmp_path / "errors").read_text() in ("", "  mat: reused 100%\n") or "json" in words
    assert "Traceback" not in (tmp_path / "errors").read_text()
    if words.startswith("run"):
        assert (tmp_path / "run/mat/manifest.json").exists()


def test_nobody_needs_to_listen_to_errors_either(tmp_path: Path) -> None:
    assert in_shell(f"{FIBERTWIN} run no-such-case 2>&1 >out | true; echo ${{PIPESTATUS[0]}}", tmp_path).stdout == "2\n"
    closed = in_shell(f"{FIBERTWIN} schema >&- 2>&- <&-; echo $?", tmp_path)
    assert (closed.stdout, closed.stderr) == ("0\n", "")


def test_a_full_disk_behind_the_output_is_one_error(tmp_path: Path) -> None:
    done = in_shell(f"{FIBERTWIN} cases > /dev/full", tmp_path)
    assert done.returncode == 1
    assert done.stderr == "error: cannot write to standard output: no space left on device\n"


def test_an_encoding_that_lacks_letters_gets_others(tmp_path: Path) -> None:
    # tables have lines and units that ASCII lacks
    for words in ("predict smoke", "cases"):
        done = in_shell(f"{FIBERTWIN} {words}", tmp_path, PYTHONIOENCODING="ascii")
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.isascii()
    # and a name that is no text at all
    done = in_shell(f"{FIBERTWIN} run $'caf\\xe9.toml'", tmp_path, PYTHONIOENCODING="ascii")
    assert done.returncode == 2
    assert done.stderr.startswith("error: 'caf\\udce9.toml' is no text in UTF-8")


def test_a_test_keeps_its_own_output(tmp_path: Path) -> None:
    marked = Marked(tmp_path / "tmp")
    script = (
        "import io, sys; sys.stdout = io.StringIO(); from pipeline.cli.outlets import steady; steady()\n"
        "assert isinstance(sys.stdout, io.StringIO)"
    )
    subprocess.run([sys.executable, "-c", script], env=marked.environment, check=True)


@pytest.mark.parametrize("place", ["--out $'caf\\xe9/run'", "current folder"])
def test_a_name_that_is_no_text_is_refused_before_anything_is_made(place: str, tmp_path: Path) -> None:
    words = f"run smoke --until mat {place if place != 'current folder' else ''}"
    go = "mkdir $'caf\\xe9'; cd $'caf\\xe9'; " if place == "current folder" else ""
    done = in_shell(f"{go}{FIBERTWIN} {words}", tmp_path)
    assert done.returncode == 2
    assert "is no text in UTF-8" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.rglob("mat"))


def test_a_current_folder_that_is_gone_is_one_error(tmp_path: Path) -> None:
    done = in_shell(f"mkdir gone; cd gone; rmdir ../gone; {FIBERTWIN} cases", tmp_path)
    assert (done.returncode, done.stderr) == (2, "error: the current folder has been removed; change to another\n")
