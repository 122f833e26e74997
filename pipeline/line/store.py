"""Nouns on disk: arrays as `.npz`, the rest as JSON, written so that their bytes depend on their content alone.

Reading takes no file at its word: sizes, types and shapes are held against what is there before room is made for them.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import hashlib
import json
import math
import os
import struct
import tokenize
import typing
import zipfile
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from pipeline.errors import StageError
from pipeline.line.places import write_text
from pipeline.reading import open_file, read_bytes

T = TypeVar("T")
CASE = "case.json"
"""File of a run's folder that holds its case, every setting in SI."""

LARGEST_INTEGER = 2**63 - 1
_LARGEST_JSON = 500_000_000  # bytes; the measures of a million fibers take a fifth of that
_LONGEST_REASON = 2000  # characters of what a library says about a damaged file
DAMAGE = (
    ArithmeticError, EOFError, LookupError, MemoryError, OSError, RuntimeError, TypeError, ValueError, struct.error,
    tokenize.TokenError, zipfile.BadZipFile,
)  # fmt: skip
"""What numpy, zipfile, json, pydantic and the nouns raise at content that is not what `save` or `write_json` wrote."""


def digest(content: object) -> str:
    """SHA-256 of a JSON-able thing, independent of the order of its keys."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with open_file(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_json(path: Path, content: object) -> None:
    """Write JSON that people can read, whole or not at all; numbers keep every digit."""
    write_text(path, json.dumps(content, indent=2, allow_nan=False, default=_plain) + "\n")


def _plain(thing: object) -> object:
    if dataclasses.is_dataclass(thing) and not isinstance(thing, type):
        return {item.name: getattr(thing, item.name) for item in dataclasses.fields(thing)}
    if isinstance(thing, np.ndarray):
        return thing.tolist()
    if isinstance(thing, np.generic):
        return thing.item()
    raise TypeError(f"{type(thing).__name__} is not JSON")


def read_json(path: Path) -> Any:
    """Read JSON that a stage wrote; what none writes is refused as damage is: infinity, integers beyond 64 bits.

    Raises
    ------
    OSError, ValueError, RecursionError
        If the file is not there, is a link, or is damaged.
    """
    return _json(read_bytes(path, _LARGEST_JSON, links=False))


def _json(content: str | bytes) -> Any:
    return json.loads(content, parse_constant=_refused, parse_float=_finite, parse_int=_bounded)


def _refused(text: str) -> float:
    raise ValueError(f"{text} is no number")


def _finite(text: str) -> float:
    value = float(text)
    return value if math.isfinite(value) else _refused(text)


def _bounded(text: str) -> int:
    value = int(text)
    if abs(value) > LARGEST_INTEGER:
        raise ValueError(f"an integer of {len(text)} digits has more than 64 bits")
    return value


def load_json(kind: type[T], path: Path) -> T:
    """Read a dataclass of `pipeline.nouns` that `write_json` wrote.

    Raises
    ------
    StageError
        If the file is not there or holds something else.
    """
    from pydantic import TypeAdapter

    try:
        read_json(path)
        # nouns are read strictly, or the text "NaN" would be a number; a case has texts with units
        content = read_bytes(path, _LARGEST_JSON, links=False)
        return TypeAdapter(kind).validate_json(content, strict=dataclasses.is_dataclass(kind))
    except DAMAGE as problem:
        raise _unreadable(path, problem) from problem


def _unreadable(path: Path, problem: Exception) -> StageError:
    reason = problem.strerror if isinstance(problem, OSError) and problem.strerror else str(problem)
    if len(reason) > _LONGEST_REASON:
        reason = f"{reason[:_LONGEST_REASON]} ..."
    advice = f"run the stage again with --force {path.parent.name}" if path.name != CASE else "make the run again"
    return StageError(f"cannot read {path}: {reason or type(problem).__name__}; {advice}")


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
            rest[item.name] = value
    np.savez(path, **arrays, rest=np.array(json.dumps(rest, sort_keys=True, default=_plain)))


def _holds_arrays(kind: object) -> bool:
    """Whether this is a dataclass of arrays only."""
    return dataclasses.is_dataclass(kind) and all(_is_array(item.type) for item in dataclasses.fields(kind))


def _is_array(kind: object) -> bool:
    return typing.get_origin(kind) is np.ndarray


def load(kind: type[T], path: Path) -> T:
    """Read what `save` wrote; the thing checks itself again.

    Raises
    ------
    StageError
        If the file is not there or is damaged.
    """
    try:
        found = read_arrays(path)
        rest = _json(str(found.pop("rest")))
        return _made(kind, found, rest)
    except DAMAGE as problem:
        raise _unreadable(path, problem) from problem


def _made(kind: type[T], found: dict[str, Any], rest: dict[str, Any]) -> T:
    from pydantic import TypeAdapter

    types = typing.get_type_hints(kind)
    values: dict[str, Any] = {}
    for item in dataclasses.fields(kind):  # type: ignore[arg-type]
        expected = types[item.name]
        if _is_array(expected):
            values[item.name] = _of_type(found.pop(item.name), expected, item.name)
        elif _holds_arrays(expected):
            parts = {
                part.name: _of_type(found.pop(f"{item.name}.{part.name}"), part.type, item.name)
                for part in dataclasses.fields(expected)
            }
            values[item.name] = expected(**parts)
        else:
            values[item.name] = TypeAdapter(expected).validate_json(json.dumps(rest.pop(item.name)), strict=True)
    if found or rest:
        raise ValueError(f"it holds {', '.join([*found, *rest])} too")
    return kind(**values)


def _of_type(array: npt.NDArray[Any], expected: Any, name: str) -> npt.NDArray[Any]:
    kind = np.dtype(typing.get_args(typing.get_args(expected)[1])[0])
    if array.dtype != kind:
        raise ValueError(f"{name} holds {array.dtype}, not {kind}")
    return array


def read_arrays(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Read the arrays of an `.npz` that numpy wrote uncompressed, and no more than the file has bytes.

    numpy's own reader makes room for what a header says before it looks whether that is there.

    Raises
    ------
    OSError, ValueError, RuntimeError, zipfile.BadZipFile and others
        If the file is not there, is a link, or is damaged.
    """
    with open_file(path, links=False) as raw, zipfile.ZipFile(raw) as archive:
        entries = archive.infolist()
        if sum(entry.file_size for entry in entries) > os.fstat(raw.fileno()).st_size:
            raise ValueError("it claims to hold more than the file has")
        return {entry.filename.removesuffix(".npy"): _read_array(archive, entry) for entry in entries}


def _read_array(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> npt.NDArray[Any]:
    with archive.open(entry) as file:
        version = np.lib.format.read_magic(file)
        reader = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }[version]
        shape, by_columns, kind = reader(file)
        if kind.hasobject:
            raise ValueError(f"{entry.filename} holds objects of Python, which are never read")
        # to the end, where the archive's own sum over the content is checked
        content = file.read()
    if min(shape, default=0) < 0 or math.prod(shape) * kind.itemsize != len(content):
        raise ValueError(f"{entry.filename} is not as long as its header says")
    return np.frombuffer(content, kind).reshape(shape, order="F" if by_columns else "C")
