"""What systems do differently. Linux is tried; of Windows only that nothing stops before it is asked for."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import psutil
import pytest

from pipeline import machine
from pipeline.machine_code import make_room

_EVERYTHING = """
import importlib, pkgutil, sys
# modules that Windows has not
for name in ("fcntl", "resource", "pwd", "grp", "termios"):
    sys.modules[name] = None
import pipeline
for module in pkgutil.walk_packages(pipeline.__path__, "pipeline."):
    if not module.name.endswith("__main__"):
        importlib.import_module(module.name)
"""


def test_everything_of_ours_is_imported_without_the_modules_that_windows_lacks() -> None:
    # libraries that need them on Linux would need them before: they are loaded first
    libraries = "import distributed, matplotlib, pyvista, meshio, pymeshlab, trimesh, foamlib, cyclopts, scipy.spatial"
    script = f"import warnings; warnings.simplefilter('ignore'); {libraries}\n{_EVERYTHING}"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_locked_file_is_locked_until_it_is_closed(tmp_path: Path) -> None:
    with (tmp_path / "lock").open("w") as first, (tmp_path / "lock").open("w") as second:
        machine.lock(first)
        with pytest.raises(BlockingIOError):
            machine.lock(second)
        first.close()
        machine.lock(second)


def test_windows_locks_a_byte_and_says_so_when_it_cannot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def locking(number: int, mode: int, size: int) -> None:
        asked.append((mode, size))
        if len(asked) > 1:
            raise OSError(13, "Permission denied")

    windows = ModuleType("msvcrt")
    windows.__dict__.update(locking=locking, LK_NBLCK=2)
    monkeypatch.setitem(sys.modules, "msvcrt", windows)
    monkeypatch.setattr(sys, "platform", "win32")
    with (tmp_path / "lock").open("w") as file:
        machine.lock(file)
        with pytest.raises(BlockingIOError):
            machine.lock(file)
    assert asked == [(2, 1)] * 2
    with machine.memory_bounded():
        pass


def test_memory_beyond_what_is_free_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    # as if the machine had 50 MB left: what a machine has is no part of the test
    monkeypatch.setattr(psutil, "virtual_memory", lambda: SimpleNamespace(available=50_000_000))
    with machine.memory_bounded(), pytest.raises(MemoryError):
        bytearray(1_000_000_000)
    assert machine.peak_memory() > 2**20


def test_numba_gets_a_private_folder_where_nothing_else_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "not/there"))
    make_room()
    assert "NUMBA_CACHE_DIR" not in os.environ
    # root may write everywhere
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    make_room()
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    assert folder.stat().st_mode & 0o777 == 0o700
    shutil.rmtree(folder)
    monkeypatch.setenv("NUMBA_CACHE_DIR", "chosen")
    make_room()
    assert os.environ["NUMBA_CACHE_DIR"] == "chosen"
