"""Places in the folder of a run: taken whole or not at all, by one process at a time, and never outside the folder.

The folder may come from somebody else. A link in it could lead anywhere, so no link is followed for writing: what is
written takes the link's place.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import errno
import os
import re
import shutil
import stat
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO, BinaryIO

from pipeline import machine
from pipeline.errors import StageError
from pipeline.reading import is_text
from pipeline.scratch import sweep

MANIFEST = "manifest.json"
"""File that closes a stage's folder: where it stands, the folder is whole."""

_LOCK = ".lock"
_LEFT = re.compile(r"\.(?P<stage>[\w.-]+)\.(partial|old|new)")
_PATIENCE = 4.0  # seconds that what a killed run had started may take to end
# What no change of the case can mend, only the user: the disk and its permissions.
_DISK_TROUBLE = {
    errno.ENOSPC, errno.EACCES, errno.EPERM, errno.EROFS, errno.EDQUOT, errno.ENOTDIR, errno.EFBIG, errno.EEXIST,
    errno.EISDIR, errno.ENAMETOOLONG, errno.ELOOP, errno.EBUSY,
}  # fmt: skip


def remove(path: Path) -> None:
    """Remove what stands in a place, whatever it is: a link and not what it leads to, a folder with all in it."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return
    if stat.S_ISDIR(mode):
        shutil.rmtree(path)
    else:
        path.unlink()


def write_text(path: Path, text: str) -> None:
    """Put a text in a place whole or not at all, as `placed` does."""
    with placed(path) as file:
        file.write(text.encode())


@contextlib.contextmanager
def placed(path: Path) -> Iterator[BinaryIO]:
    """Give a file to write, put in a place whole or not at all; what stood there, a link too, is replaced."""
    side = path.with_name(f".{path.name}.new")
    remove(side)
    try:
        with open(os.open(side, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666), "wb") as file:  # noqa: PTH123
            yield file
        side.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            remove(side)
        raise


def own_folder(run: Path, *names: str) -> Path:
    """Give a folder within a run's to write into; a link or a file in its place, or on the way to it, is removed."""
    place = run
    for name in names:
        place = place / name
        if place.is_symlink() or (place.exists() and not place.is_dir()):
            remove(place)
    place.mkdir(parents=True, exist_ok=True)
    return place


def own_file(path: Path) -> Path:
    """Give a file of the run to write; a link in its place is removed."""
    if path.is_symlink():
        remove(path)
    return path


def kept_folder(run: Path, stage: str) -> Path:
    """Where a stage keeps what it goes on from when it was stopped; it is gone once the stage's result stands.

    It may be there or not. One with a link anywhere in it is removed, since whatever writes there would follow it.
    """
    place = run / f".{stage}.kept"
    if place.is_symlink() or not place.is_dir() or any(path.is_symlink() for path in place.rglob("*")):
        remove(place)
    return place


@contextlib.contextmanager
def side_folder(stage: Path) -> Iterator[Path]:
    """Give an empty folder to write a stage into; it takes the stage's place only if the block succeeds.

    Raises
    ------
    StageError
        If the disk is full or may not be written.
    """
    side, old = (stage.with_name(f".{stage.name}.{word}") for word in ("partial", "old"))
    with disk_trouble_explained(stage):
        remove(side)
        side.mkdir(parents=True)
        try:
            yield side
            _put(side, stage, old)
        except BaseException:
            # an error while removing must not hide the first
            with contextlib.suppress(OSError):
                if old.exists() and not os.path.lexists(stage):
                    old.rename(stage)
                remove(side)
            raise
        remove(kept_folder(stage.parent, stage.name))


def _put(side: Path, stage: Path, old: Path) -> None:
    remove(old)
    if os.path.lexists(stage):
        stage.rename(old)
    side.rename(stage)
    remove(old)


@contextlib.contextmanager
def disk_trouble_explained(place: Path) -> Iterator[None]:
    """Turn a full disk or a missing permission into an error that says so."""
    try:
        yield
    except OSError as problem:
        if problem.errno not in _DISK_TROUBLE and not _is_gone(place, problem):
            raise
        blocked = problem.errno in (errno.EEXIST, errno.ENOTDIR)
        reason = "a file stands where a folder should" if blocked else os.strerror(problem.errno or 0).lower()
        raise StageError(
            f"cannot write {problem.filename or place}: {reason}; "
            "nothing half-written was kept; free space, or choose another place"
        ) from problem


def _is_gone(place: Path, problem: OSError) -> bool:
    """Whether nothing can be written since the place, or a folder on the way to it, is not there or was removed.

    A link to nothing is such a place. Any other file that is missing is a fault of the program's.
    """
    if problem.errno != errno.ENOENT:
        return False
    named = Path(os.fsdecode(problem.filename)) if problem.filename is not None else place
    return named == place or named in place.parents or not place.parent.is_dir()


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a run folder for this process alone, after clearing away what a killed process left.

    Raises
    ------
    StageError
        If another process is running in the folder, or the folder cannot be written.
    """
    if not is_text(str(folder.absolute())):
        raise StageError(f"{str(folder)!r} is no text in UTF-8, which VTK and the page need; choose another folder")
    try:
        if folder.exists() and not folder.is_dir():
            raise StageError(f"{folder} is a file; choose another folder with --out")
        folder.mkdir(parents=True, exist_ok=True)
        lock = _open_lock(folder / _LOCK)
    except OSError as problem:
        raise StageError(
            f"cannot write {problem.filename or folder}: {os.strerror(problem.errno or 0).lower()}; "
            "choose another folder with --out"
        ) from problem
    with lock, disk_trouble_explained(folder):
        _hold(lock, folder)
        sweep()
        _clear(folder)
        yield


def _open_lock(path: Path) -> IO[bytes]:
    flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    for _ in range(2):
        try:
            file = open(os.open(path, flags, 0o666), "r+b", buffering=0)  # noqa: PTH123, SIM115
        except OSError as problem:
            if problem.errno not in (errno.ELOOP, errno.ENXIO):
                raise
        else:
            if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                return file
            file.close()
        # a link, a pipe or the like: nobody holds a run by that
        remove(path)
    raise OSError(errno.EEXIST, os.strerror(errno.EEXIST), path)


def _hold(lock: IO[bytes], folder: Path) -> None:
    deadline = time.monotonic() + _PATIENCE
    while True:
        try:
            # the system lets go of it when the process ends, however it ends, and all that it started
            machine.lock(lock)
            return
        except BlockingIOError:
            if time.monotonic() > deadline:
                raise StageError(f"another run is writing {folder}; wait for it, or choose another --out") from None
        time.sleep(0.05)


def _clear(folder: Path) -> None:
    """Put what was whole when its process was killed into its place, and remove the rest."""
    for path in list(folder.iterdir()):
        match = _LEFT.fullmatch(path.name)
        if match is None:
            continue
        stage = folder / match["stage"]
        if path.suffix == ".partial" and (path / MANIFEST).is_file() and not path.is_symlink():
            _put(path, stage, folder / f".{stage.name}.old")
        elif path.suffix == ".old" and not os.path.lexists(stage) and not path.is_symlink():
            if not (folder / f".{stage.name}.partial" / MANIFEST).is_file():
                path.rename(stage)
        else:
            remove(path)
