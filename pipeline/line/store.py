"""Stage results on disk: saved whole or not at all, and reused while what made them is unchanged.

A stage's folder holds its files and `manifest.json`, which says what made them. A stage writes into a side folder
that is renamed when it is complete, so a killed run leaves finished stages only.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import dataclasses
import errno
import hashlib
import json
import os
import shutil
import typing
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from pipeline import machine
from pipeline.errors import StageError
from pipeline.geometry.box import Box

T = TypeVar("T")
MANIFEST = "manifest.json"
_PARTS = ("files", "records")
# What no change of the case can mend, only the user: the disk and its permissions.
_DISK_TROUBLE = {
    errno.ENOSPC, errno.EACCES, errno.EPERM, errno.EROFS, errno.EDQUOT, errno.ENOTDIR, errno.EFBIG, errno.EEXIST,
    errno.EISDIR, errno.ENAMETOOLONG,
}  # fmt: skip


def digest(content: object) -> str:
    """SHA-256 of a JSON-able thing, independent of the order of its keys."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_json(path: Path, content: object) -> None:
    """Write JSON that people can read; numbers keep every digit."""
    path.write_text(json.dumps(content, indent=2, allow_nan=False, default=_plain) + "\n", encoding="utf-8")


def _plain(thing: object) -> object:
    if dataclasses.is_dataclass(thing) and not isinstance(thing, type):
        return {item.name: getattr(thing, item.name) for item in dataclasses.fields(thing)}
    if isinstance(thing, np.ndarray):
        return thing.tolist()
    if isinstance(thing, np.generic):
        return thing.item()
    raise TypeError(f"{type(thing).__name__} is not JSON")


def read_json(path: Path) -> Any:
    """Read JSON that a stage wrote."""
    return json.loads(path.read_text(encoding="utf-8"))


def load_json(kind: type[T], path: Path) -> T:
    """Read a dataclass of `pipeline.nouns` that `write_json` wrote.

    Raises
    ------
    StageError
        If the file is not there or holds something else.
    """
    from pydantic import TypeAdapter, ValidationError

    try:
        return TypeAdapter(kind).validate_json(path.read_bytes())
    except (OSError, ValidationError) as problem:
        advice = f"run the stage again with --force {path.parent.name}"
        raise StageError(f"cannot read {path}: {problem}; {advice}") from problem


def save(thing: object, path: Path) -> None:
    """Write a dataclass of `pipeline.nouns` as `.npz`: arrays as arrays, the rest as one JSON text.

    The bytes depend on the content alone.
    """
    arrays: dict[str, Any] = {}
    rest: dict[str, object] = {}
    for item in dataclasses.fields(thing):  # type: ignore[arg-type]
        value = getattr(thing, item.name)
        if isinstance(value, np.ndarray):
            arrays[item.name] = value
        elif _holds_arrays(type(value)):
            arrays |= {f"{item.name}.{part.name}": getattr(value, part.name) for part in dataclasses.fields(value)}
        else:
            rest[item.name] = {"lower": value.lower, "upper": value.upper} if isinstance(value, Box) else value
    np.savez(path, **arrays, rest=np.array(json.dumps(rest, sort_keys=True, default=_plain)))


def _holds_arrays(kind: object) -> bool:
    """Whether this is a dataclass of arrays only."""
    return dataclasses.is_dataclass(kind) and all(
        typing.get_origin(item.type) is np.ndarray for item in dataclasses.fields(kind)
    )


def load(kind: type[T], path: Path) -> T:
    """Read what `save` wrote; the thing checks itself again.

    Raises
    ------
    StageError
        If the file is not there or is damaged.
    """
    try:
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            values: dict[str, Any] = {name: file[name] for name in file.files if name != "rest"}
            values |= json.loads(str(file["rest"]))
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as problem:
        advice = f"run the stage again with --force {path.parent.name}"
        raise StageError(f"cannot read {path}: {problem}; {advice}") from problem
    for item in dataclasses.fields(kind):  # type: ignore[arg-type]
        if _holds_arrays(item.type):
            prefix = f"{item.name}."
            parts = {name.removeprefix(prefix): values.pop(name) for name in list(values) if name.startswith(prefix)}
            values[item.name] = item.type(**parts)  # type: ignore[operator]
        elif item.type in (Box, "Box"):
            corners = values[item.name]
            values[item.name] = Box(tuple(corners["lower"]), tuple(corners["upper"]))
        elif isinstance(values.get(item.name), list):
            entry = typing.get_args(item.type)[0]
            values[item.name] = tuple(entry(**each) if isinstance(each, dict) else each for each in values[item.name])
    return kind(**values)


def read_manifest(stage: Path) -> dict[str, Any] | None:
    """Give what made a stage; None where its manifest is missing, damaged, or of a program that wrote others."""
    try:
        manifest: dict[str, Any] = read_json(stage / MANIFEST)
        whole = all(isinstance(manifest[part], dict) for part in _PARTS) and isinstance(manifest["key"], str)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return manifest if whole else None


def damaged(stage: Path, manifest: dict[str, Any]) -> list[str]:
    """Name the files of a stage's result that are not as it left them."""
    return [name for name, content in manifest["files"].items() if _digest_or_none(stage / name) != content]


def _digest_or_none(path: Path) -> str | None:
    try:
        return file_digest(path) if path.is_file() else None
    except OSError:
        return None


def finished(stage: Path, key: str) -> dict[str, Any] | None:
    """Give the manifest of a stage if it was made by just this `key` and all its files are as it left them."""
    manifest = read_manifest(stage)
    if manifest is None or manifest["key"] != key or damaged(stage, manifest):
        return None
    return manifest


@contextlib.contextmanager
def side_folder(stage: Path) -> Iterator[Path]:
    """Give an empty folder to write a stage into; it takes the stage's place only if the block succeeds.

    Raises
    ------
    StageError
        If the disk is full or may not be written.
    """
    side = stage.with_name(f".{stage.name}.partial")
    old = stage.with_name(f".{stage.name}.old")
    with disk_trouble_explained(stage):
        shutil.rmtree(side, ignore_errors=True)
        side.mkdir(parents=True)
        try:
            yield side
            shutil.rmtree(old, ignore_errors=True)
            if stage.exists():
                stage.rename(old)
            side.rename(stage)
        except BaseException:
            shutil.rmtree(side, ignore_errors=True)
            raise
        shutil.rmtree(old, ignore_errors=True)


@contextlib.contextmanager
def disk_trouble_explained(place: Path) -> Iterator[None]:
    """Turn a full disk or a missing permission into an error that says so."""
    try:
        yield
    except OSError as problem:
        if problem.errno not in _DISK_TROUBLE:
            raise
        blocked = problem.errno in (errno.EEXIST, errno.ENOTDIR)
        reason = "a file stands where a folder should" if blocked else os.strerror(problem.errno or 0).lower()
        raise StageError(
            f"cannot write {problem.filename or place}: {reason}; "
            "nothing half-written was kept; free space, or choose another place"
        ) from problem


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a run folder for this process alone.

    Raises
    ------
    StageError
        If another process is running in the folder, or the folder cannot be written.
    """
    try:
        if folder.exists() and not folder.is_dir():
            raise StageError(f"{folder} is a file; choose another folder with --out")
        folder.mkdir(parents=True, exist_ok=True)
        lock = (folder / ".lock").open("w")
    except OSError as problem:
        raise StageError(
            f"cannot write {problem.filename or folder}: {os.strerror(problem.errno or 0).lower()}; "
            "choose another folder with --out"
        ) from problem
    with lock, disk_trouble_explained(folder):
        try:
            # the system lets go of it when the process ends, however it ends
            machine.lock(lock)
        except BlockingIOError:
            raise StageError(f"another run is writing {folder}; wait for it, or choose another --out") from None
        yield


def write_manifest(stage: Path, content: dict[str, Any], records: tuple[str, ...] = ()) -> None:
    """Close a stage's side folder with what made it and the digest of each of its files.

    Parameters
    ----------
    stage : Path
    content : dict
    records : tuple of str
        Patterns of the files that are no part of the result.
    """
    paths = sorted(path.relative_to(stage) for path in stage.rglob("*") if path.is_file())
    digests = {path.as_posix(): file_digest(stage / path) for path in paths}
    kept = {name for name, path in zip(digests, paths, strict=True) if any(path.match(each) for each in records)}
    files = {name: digest for name, digest in digests.items() if name not in kept}
    written = {name: digest for name, digest in digests.items() if name in kept}
    write_json(stage / MANIFEST, {**content, "files": files, "records": written})
