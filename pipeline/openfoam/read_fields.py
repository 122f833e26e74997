"""Reads solved fields of an OpenFOAM case: one value per cell, or one per face."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from pathlib import Path

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats
from pipeline.nouns.mesh import FaceMesh
from pipeline.openfoam.read import LARGEST_FILE
from pipeline.reading import read_bytes

_LIST = rb"nonuniform\s+List<\w+>\s*(?P<count>\d{1,12})\s*"
_INTERNAL = re.compile(rb"\binternalField\s+(?:" + _LIST + rb"|uniform\s+(?P<even>[^;]+);)")
_VALUE = re.compile(rb"\bvalue\s+(?:" + _LIST + rb"|uniform\s+(?P<even>[^;]+);)|\}")
_SEEN = 4000  # bytes within which a patch says its value


def latest_time(case: Path) -> Path:
    """Give the folder of the last time that a case was solved for.

    Raises
    ------
    StageError
        If there is none.
    """
    times = [folder for folder in case.iterdir() if re.fullmatch(r"\d+(\.\d+)?", folder.name) and folder.name != "0"]
    if not times:
        raise StageError(f"{case} holds no solution; solve it again with --force solve")
    return max(times, key=lambda folder: float(folder.name))


def read_cells(path: Path, cells: int, components: int) -> Floats:
    """Read a value per cell, (cells, components) array.

    Raises
    ------
    StageError
        If the file is not there, damaged, or of another mesh.
    """
    return _Field(path).internal(cells, components)


def read_faces(path: Path, mesh: FaceMesh) -> Floats:
    """Read one number per face, boundary included, (faces,) array; a patch without values has 0.

    Raises
    ------
    StageError
        As `read_cells`.
    """
    field = _Field(path)
    parts = [field.internal(len(mesh.neighbour), 1)]
    parts += [field.patch(patch.name, patch.count) for patch in mesh.patches]
    return np.concatenate(parts)[:, 0]


class _Field:
    """One file, read from its start to its end."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.content = read_bytes(path, LARGEST_FILE)
        except OSError as problem:
            raise StageError(f"cannot read {path}: {problem.strerror}; solve it again with --force solve") from problem
        self.binary = bool(re.search(rb"\bformat\s+binary\s*;", self.content[:2000]))
        self.at = 0

    def internal(self, count: int, components: int) -> Floats:
        return self._values(_INTERNAL.search(self.content), count, components)

    def patch(self, name: str, count: int) -> Floats:
        start = re.compile(rb"\b" + re.escape(name.encode()) + rb"\s*\{").search(self.content, self.at)
        if start is None:
            raise self._damaged(f"it lacks the patch {name}")
        found = _VALUE.search(self.content, start.end(), start.end() + _SEEN)
        if found is not None and found[0] == b"}":
            return np.zeros((count, 1))
        return self._values(found, count, 1)

    def _values(self, found: "re.Match[bytes] | None", count: int, components: int) -> Floats:
        if found is None:
            raise self._damaged("it has no values")
        self.at = found.end()
        if found["even"] is not None:
            even = np.array(found["even"].translate(None, b"()").split(), np.float64)
            return np.tile(even, (count, 1))
        if int(found["count"]) != count:
            raise self._damaged(f"it has {int(found['count'])} values where the mesh has {count}")
        if not count:
            return np.empty((0, components))
        size = count * components
        if self.binary:
            values = np.frombuffer(self.content[self.at + 1 : self.at + 1 + 8 * size], "<f8")
            self.at += 2 + 8 * size
        else:
            end = self.content.index(b";", self.at)
            text = self.content[self.at : end].translate(bytes.maketrans(b"()", b"  "))
            values, self.at = np.array(text.split(), np.float64), end
        if len(values) != size:
            raise self._damaged("it ends before its values do")
        return values.reshape(count, components).astype(np.float64)

    def _damaged(self, why: str) -> StageError:
        return StageError(f"cannot read the field {self.path}: {why}; solve it again with --force solve")
