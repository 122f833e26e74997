# SPDX-License-Identifier: GPL-3.0-or-later

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from pipeline import scratch
from pipeline.machine_code import make_room
from pipeline.scratch import scratch_folder, sweep

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="nothing is swept there")


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    place = tmp_path / "tmp"
    place.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    return place


def killed(place: Path, script: str) -> None:
    """Run a program that is killed while it has a folder."""
    program = f"import os, signal; from pipeline import scratch\n{script}"
    done = subprocess.run(
        [sys.executable, "-c", program], env={**os.environ, "TMPDIR": str(place)}, capture_output=True, check=False
    )
    assert done.returncode == -9, done.stderr


def test_a_folder_is_private_and_gone_after_its_block(place: Path) -> None:
    with scratch_folder("mesh") as folder:
        assert folder.parent == place
        assert folder.stat().st_mode & 0o777 == 0o700
    with pytest.raises(KeyboardInterrupt), scratch_folder("mesh") as folder:
        raise KeyboardInterrupt
    assert list(place.iterdir()) == []


def test_what_a_killed_process_left_is_swept_and_what_lives_is_not(place: Path) -> None:
    killed(place, "with scratch.scratch_folder('mesh') as folder: os.kill(os.getpid(), signal.SIGKILL)")
    assert len(list(place.iterdir())) == 1
    with scratch_folder("snappy") as mine, scratch_folder("pictures") as second:
        assert sorted(place.iterdir()) == sorted([mine, second])
        subprocess.run(
            [sys.executable, "-c", "from pipeline.scratch import sweep; sweep()"],
            env={**os.environ, "TMPDIR": str(place)}, check=True,
        )  # fmt: skip
        assert sorted(place.iterdir()) == sorted([mine, second])


def test_what_was_killed_while_it_made_a_folder_is_swept_later(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    halfway = "scratch._owned = lambda folder: os.kill(os.getpid(), signal.SIGKILL)"
    killed(place, f"{halfway}\nscratch.scratch_folder('mesh').__enter__()")
    sweep()
    # it may belong to a process that is just making it
    assert len(list(place.iterdir())) == 1
    monkeypatch.setattr(scratch, "_MAKING", -1.0)
    sweep()
    assert list(place.iterdir()) == []


def test_only_our_own_folders_are_swept_and_no_link_is_followed(place: Path, tmp_path: Path) -> None:
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / ".owner").write_text("")
    (precious / "thesis").write_text("three years")
    (place / "fibertwin-mesh-link").symlink_to(precious)
    (place / "fibertwin-mesh-file").write_text("")
    (place / "somebody-elses").mkdir()
    (place / "somebody-elses/.owner").write_text("")
    linked = place / "fibertwin-mesh-linked"
    linked.mkdir()
    (linked / ".owner").symlink_to(precious / ".owner")
    dead = place / "fibertwin-mesh-dead"
    dead.mkdir()
    (dead / ".owner").write_text("")
    (dead / "inner").symlink_to(precious)
    sweep()
    assert sorted(path.name for path in place.iterdir()) == [
        "fibertwin-mesh-file", "fibertwin-mesh-link", "fibertwin-mesh-linked", "somebody-elses",
    ]  # fmt: skip
    assert (precious / "thesis").read_text() == "three years"


def test_each_purpose_is_one_that_is_swept(place: Path) -> None:
    with pytest.raises(ValueError, match="would not be swept"), scratch_folder("unheard-of"):
        pass


def test_what_numba_compiled_for_one_process_stays_as_long_as_it_lives(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    # root may write everywhere
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    make_room()
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    monkeypatch.setattr(scratch, "_MAKING", -1.0)
    subprocess.run(
        [sys.executable, "-c", "from pipeline import scratch; scratch._MAKING = -1.0; scratch.sweep()"],
        env={**os.environ, "TMPDIR": str(place), "NUMBA_CACHE_DIR": "elsewhere"}, check=True,
    )  # fmt: skip
    assert folder.is_dir()
    monkeypatch.setenv("NUMBA_CACHE_DIR", "chosen")
