"""The manifest that closes a stage's folder: what made the result, and the digest of each of its files."""

# SPDX-License-Identifier: GPL-3.0-or-later

import hashlib
from pathlib import Path, PurePosixPath
from typing import Any

from pipeline.line.places import MANIFEST
from pipeline.line.store import LARGEST_INTEGER, file_digest, read_json, write_json
from pipeline.reading import open_file


def read_manifest(stage: Path) -> dict[str, Any] | None:
    """Give what made a stage; None where its manifest is missing, damaged, or of a program that wrote others."""
    found = _read(stage)
    return found if found is not None and _is_of_stage(found) else None


def finished(folder: Path, key: str) -> dict[str, Any] | None:
    """Give the manifest of a folder if it was closed with just this `key` and all its files are as they were."""
    found = _read(folder)
    return found if found is not None and found["key"] == key and not damaged(folder, found) else None


def _read(folder: Path) -> dict[str, Any] | None:
    if folder.is_symlink():
        return None
    try:
        found = read_json(folder / MANIFEST)
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(found, dict) or not isinstance(found.get("key"), str):
        return None
    whole = all(
        _is_table_of_texts(found.get(part)) and all(_is_within(name) for name in found[part])
        for part in ("files", "records")
    )
    return found if whole else None


def _is_of_stage(found: dict[str, Any]) -> bool:
    counts, why = found.get("counts"), found.get("why")
    return (
        isinstance(found.get("stage"), str)
        and isinstance(found.get("parameters"), dict)
        and all(_is_table_of_texts(found.get(name)) for name in ("sources", "inputs", "code", "libraries"))
        and all(_is_number(found.get(name)) and found[name] >= 0 for name in ("seconds", "peak_memory"))
        and isinstance(why, list)
        and all(isinstance(reason, str) for reason in why)
        and isinstance(counts, dict)
        and all(_is_count(value) for value in counts.values())
    )


def _is_table_of_texts(found: Any) -> bool:
    return isinstance(found, dict) and all(isinstance(value, str) for value in found.values())


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST_INTEGER


def _is_count(value: Any) -> bool:
    if isinstance(value, list):
        return all(isinstance(part, str) or _is_number(part) for part in value)
    return value is None or isinstance(value, str | bool) or _is_number(value)


def _is_within(name: str) -> bool:
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts and "\0" not in name


def damaged(stage: Path, manifest: dict[str, Any]) -> list[str]:
    """Name the files of a stage's result that are not as it left them."""
    return [name for name, content in manifest["files"].items() if _digest_or_none(stage / name) != content]


def _digest_or_none(path: Path) -> str | None:
    try:
        # a link leads out of the result
        with open_file(path, links=False) as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return None


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
