"""Folders beside the run for what a program works with: this process's own, and gone when it ends, however it ends.

A killed process leaves its folder; the next one that makes a folder here sweeps it, and knows by a lock that its owner
is dead. Only folders of the same user are swept.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import os
import re
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from pipeline import machine

_OWNER = ".owner"  # locked by the process that the folder belongs to, and by the guardians of what it started
_NEW = ".owner.new"
_OURS = re.compile(r"fibertwin-(mesh|pictures|pdf|snappy|solver|numba|doctor)-\w+")
# seconds after which a folder without an owner was left by a process that was killed while making it
_MAKING = 60.0


@contextlib.contextmanager
def scratch_folder(purpose: str) -> Iterator[Path]:
    """Give an empty folder for as long as the block runs.

    Parameters
    ----------
    purpose : str
        Part of its name.
    """
    prefix = f"fibertwin-{purpose}-"
    if not _OURS.fullmatch(f"{prefix}1"):
        raise ValueError(f"a folder for {purpose} would not be swept: name it in _OURS")
    sweep()
    folder = Path(tempfile.mkdtemp(prefix=prefix))
    try:
        with _owned(folder):
            yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def _owned(folder: Path) -> Iterator[None]:
    if sys.platform == "win32":
        # an open file cannot be renamed, nor its folder removed by another
        yield
        return
    with (folder / _NEW).open("w") as file:
        # locked before it has its name, or a sweep could come in between
        machine.lock(file)
        (folder / _NEW).rename(folder / _OWNER)
        yield


def sweep() -> None:
    """Remove the folders whose owners are dead."""
    if sys.platform == "win32":
        return
    with contextlib.suppress(OSError), os.scandir(tempfile.gettempdir()) as entries:
        for entry in entries:
            if _OURS.fullmatch(entry.name) and _is_dead(Path(entry.path)):
                shutil.rmtree(entry.path, ignore_errors=True)


def _is_dead(folder: Path) -> bool:
    try:
        found = folder.lstat()
        if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():
            return False
        if not (folder / _OWNER).exists():
            return time.time() - found.st_mtime > _MAKING
        # a stranger could have put a link or a pipe here only into a folder of this user
        with open(os.open(folder / _OWNER, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK), "r+b", buffering=0) as file:  # noqa: PTH123
            machine.lock(file)
            return True
    except OSError:
        return False
