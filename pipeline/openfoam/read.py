"""Reads `constant/polyMesh`, in text and in binary, from any OpenFOAM tool."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from pipeline.errors import StageError
from pipeline.nouns.arrays import Ints
from pipeline.nouns.mesh import CYCLIC, FLAT, FaceMesh, Patch
from pipeline.openfoam.dictionary import COMMENT, Words, read_named
from pipeline.reading import open_file

_HEADER = re.compile(rb"FoamFile\s*\{(?P<body>.*?)\}\s*", re.DOTALL)
_COUNT = re.compile(rb"\s*(?P<count>\d{1,10})\s*")
_UNIFORM = re.compile(rb"\s*\{(?P<value>[^{}]*)\}")
_TIME = re.compile(r"\d+(\.\d*)?(e[+-]?\d+)?", re.IGNORECASE)
_MOST_UNIFORM = 100_000_000
LARGEST_FILE = 20_000_000_000
"""A file of more bytes is refused before it is opened: its mesh would not fit into memory."""


FILES = ("points", "faces", "owner", "neighbour", "boundary")
"""What a mesh consists of."""


def mesh_folder(case: Path) -> Path:
    """Give the folder of a mesh's faces: the case's latest `polyMesh`, or the folder itself if it is one."""
    return case if (case / "points").is_file() else _instance(case, "faces")


def mesh_files(case: Path) -> list[Path]:
    """Give the files that `read_openfoam` reads: each from the latest time that has it, as OpenFOAM takes it.

    A mesh that moves has new points only, one that snappyHexMesh refined has all files in a later time.
    """
    faces = mesh_folder(case)
    points = faces if faces == case else _instance(case, "points")
    return [(points if name == "points" else faces) / name for name in FILES]


def _instance(case: Path, name: str) -> Path:
    times = []
    for folder in case.iterdir() if case.is_dir() else ():
        if _TIME.fullmatch(folder.name) and any((folder / "polyMesh" / each).exists() for each in (name, f"{name}.gz")):
            times.append(folder)
    latest = max(times, key=lambda folder: float(folder.name), default=case / "constant")
    return latest / "polyMesh"


def read_openfoam(case: Path) -> FaceMesh:
    """Read the mesh of an OpenFOAM case.

    Parameters
    ----------
    case : Path
        A case folder, of whose times the latest with a mesh counts, or a `polyMesh` folder.

    Returns
    -------
    FaceMesh

    Raises
    ------
    StageError
        If there is no mesh, or a file is damaged or compressed.
    """
    folder = mesh_folder(case)
    try:
        files = dict(zip(FILES, mesh_files(case), strict=True))
        if not files["faces"].parent.is_dir() and (case / "processor0").is_dir():
            raise ValueError("it is decomposed; run reconstructParMesh -constant, or give one processor's folder")
        points = _List(files["points"]).floats(3)
        corners, offsets = _read_faces(_List(files["faces"]))
        owner = _List(files["owner"]).labels()
        neighbour = _List(files["neighbour"]).labels()
        patches = _read_boundary(_contents(files["boundary"]))
        # older tools pad the neighbours of boundary faces with -1
        neighbour = neighbour[neighbour >= 0]
        cells = int(max(owner.max(initial=-1), neighbour.max(initial=-1))) + 1
        return FaceMesh(points, corners, offsets, owner, neighbour, cells, patches)
    except (OSError, ValueError) as problem:
        detail = f"{problem.strerror}: {problem.filename}" if isinstance(problem, OSError) else str(problem)
        raise StageError(f"cannot read the mesh in {folder}: {detail}") from problem


def _contents(path: Path) -> bytes:
    if not path.exists() and path.with_name(path.name + ".gz").exists():
        raise ValueError(f"{path.name} is compressed; run gunzip in the folder")
    # a pipe in a file's place would keep a reader waiting for good
    with open_file(path) as file:
        if path.stat().st_size > LARGEST_FILE:
            raise ValueError(f"{path.name} is larger than {LARGEST_FILE} bytes")
        return file.read()


class _List:
    """One file: its header understood, its lists read one after the other."""

    def __init__(self, path: Path) -> None:
        content = _contents(path)
        # a comment never follows the header's end, and binary data could look like one
        banner = _HEADER.search(content[:100_000])
        if banner is None:
            raise ValueError(f"{path.name} has no FoamFile header")
        header = banner["body"].decode("latin-1")
        self.name = path.name
        self.binary = bool(re.search(r"format\s+binary", header))
        self.kind = (re.search(r"class\s+(\w+)", header) or ["", ""])[1]
        self.label = np.dtype("<i8" if "label=64" in header else "<i4")
        self.scalar = np.dtype("<f4" if "scalar=32" in header else "<f8")
        if "MSB" in header:
            raise ValueError(f"{path.name} was written on a big-endian machine")
        self.rest = content[banner.end() :]
        if not self.binary:
            self.rest = COMMENT.sub(b" ", self.rest)
        else:
            self.rest = re.sub(rb"\A(\s*//[^\n]*\n)*", b"", self.rest)

    def labels(self) -> Ints:
        return self._array(self.label, 1, np.dtype(np.int64)).ravel().astype(np.int64)

    def floats(self, components: int) -> npt.NDArray[np.float64]:
        return self._array(self.scalar, components, np.dtype(np.float64)).astype(np.float64)

    def _array(
        self, raw: np.dtype[np.generic], components: int, parsed: np.dtype[np.generic]
    ) -> npt.NDArray[np.generic]:
        count = self._start()
        if self.binary:
            size = count * components * raw.itemsize
            if not count:
                return np.empty((0, components), raw)
            if len(self.rest) < size + 2 or self.rest[:1] != b"(":
                raise ValueError(f"{self.name} ends before its {count} entries do")
            values = np.frombuffer(self.rest, raw, count * components, 1)
            self.rest = self.rest[size + 2 :]
        elif uniform := _UNIFORM.match(self.rest):
            # a list of equal values; a mesh of so many cells would not fit into memory
            if count > _MOST_UNIFORM:
                raise ValueError(f"{self.name} says {count} equal entries")
            self.rest = self.rest[uniform.end() :]
            values = np.tile(
                _numbers(
                    uniform["value"].translate(None, b"()")
                    if components == 1
                    else uniform["value"].replace(b"(", b" ").replace(b")", b" "),
                    parsed,
                    self.name,
                ),
                count,
            )
        else:
            text = (
                self.rest.translate(None, b"()")
                if components == 1
                else self.rest.replace(b"(", b" ").replace(b")", b" ")
            )
            values = _numbers(text, parsed, self.name)
        if len(values) != count * components:
            raise ValueError(f"{self.name} says {count} entries but has {len(values) / components:g}")
        return values.reshape(count, components)

    def _start(self) -> int:
        match = _COUNT.match(self.rest)
        if match is None:
            raise ValueError(f"{self.name} has no list")
        self.rest = self.rest[match.end() :]
        return int(match["count"])


def _numbers(text: bytes, kind: np.dtype[np.generic], name: str) -> npt.NDArray[np.generic]:
    try:
        return np.array(text.split(), dtype=kind)
    except (ValueError, OverflowError) as problem:
        raise ValueError(f"{name}: {problem}") from None


def _read_faces(file: _List) -> tuple[Ints, Ints]:
    if file.binary:
        if file.kind != "faceCompactList":
            raise ValueError(f"faces are a {file.kind}, which no OpenFOAM tool writes in binary")
        offsets = file.labels()
        return file.labels(), offsets
    match = _COUNT.match(file.rest)
    if match is None:
        raise ValueError("faces has no list")
    count, body = int(match["count"]), file.rest[match.end() :]
    # "3(1 2 3)" reads as 3 1 2 3 once the parentheses are gone
    numbers = _numbers(body.replace(b"(", b" ").replace(b")", b" "), np.dtype(np.int64), "faces").astype(np.int64)
    starts = np.empty(count, np.int64)
    place = 0
    for face in range(count):
        if place >= len(numbers) or numbers[place] < 3:
            raise ValueError(f"face {face} of {count} is missing or no polygon")
        starts[face] = place
        place += int(numbers[place]) + 1
    if place != len(numbers):
        raise ValueError(f"the {count} faces do not end where their list does")
    keep = np.ones(len(numbers), bool)
    keep[starts] = False
    return numbers[keep], np.concatenate([[0], np.cumsum(numbers[starts])])


def _read_boundary(content: bytes) -> tuple[Patch, ...]:
    patches = []
    for name, entries in read_named(content):
        if isinstance(entries, Words):
            raise ValueError(f"{name} in boundary is no patch")
        found = {key: words[0] for key, words in entries if isinstance(words, Words) and words}
        count, start = found.get("nFaces", ""), found.get("startFace", "")
        if not (count.isdigit() and start.isdigit()):
            raise ValueError(f"patch {name} in boundary has no nFaces or startFace")
        kind = found.get("type", "")
        patches.append(Patch(name, int(start), int(count), kind if kind in (*FLAT, CYCLIC) else "patch"))
    return tuple(patches)
