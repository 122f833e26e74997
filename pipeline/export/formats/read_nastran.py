"""Reads NASTRAN bulk data: small, large and free fields in any mixture, and coordinate systems given by points."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from pipeline.export.formats.file_mesh import Cells, FileMesh, face_mesh, grouped, rows_by_number
from pipeline.export.formats.nastran_systems import SYSTEMS, System, in_base
from pipeline.export.formats.reading import damage_told
from pipeline.nouns.arrays import Floats, Ints, require
from pipeline.nouns.mesh import FaceMesh

_CELLS = {"CTETRA": ("tetra", 4), "CPYRAM": ("pyramid", 5), "CPYRA": ("pyramid", 5), "CPENTA": ("wedge", 6),
          "CHEXA": ("hexahedron", 8)}  # fmt: skip
_FACES = {"CTRIA3": 3, "CTRIAR": 3, "CQUAD4": 4, "CQUADR": 4}
_READ = {*_CELLS, *_FACES, *SYSTEMS, "GRID", "GRDSET"}
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[edED]?[+-]?\d+)?")
_EXPONENT = re.compile(r"(?<=[\d.])(?=[+-])")
_NAME = re.compile(r'\$HMNAME\s+COMP\s+(\d+)\s*"([^"]+)"|\$ANSA_NAME_COMMENT;(\d+);PSHELL;([^;]+);', re.IGNORECASE)
_SMALL, _LARGE = 8, 16


def read_nastran(path: Path) -> FaceMesh:
    """Read the grid points, the solid elements and, as patches by their property's number or name, the shells.

    Raises
    ------
    StageError
        If the file is damaged, has elements with nodes on their edges, or would open another file.
    """
    with damage_told(path):
        text = path.read_text(encoding="latin-1")
        names = {int(m[1] or m[3]): (m[2] or m[4]).strip() for m in _NAME.finditer(text)}
        return face_mesh(_content(cards(text), names))


def cards(text: str) -> Iterator[list[str]]:
    r"""Give each card that is read as its fields, the name first; continuations follow in the same list.

    Examples
    --------
    >>> list(cards("grid,1,,0.,1.,2.\nGRID*   2                               0.5             0.\n*       7."))
    [['GRID', '1', '', '0.', '1.', '2.'], ['GRID', '2', '', '0.5', '0.', '7.']]
    """
    lines = text.splitlines()
    start = next((k for k, line in enumerate(lines) if re.match(r"\s*begin\s+bulk", line, re.IGNORECASE)), -1)
    card: list[str] = []
    for line in lines[start + 1 :]:
        line = line.split("$")[0].rstrip()
        if not line.strip():
            continue
        first = line.split(",")[0].strip() if "," in line else line.expandtabs(_SMALL)[:_SMALL].strip()
        if first.upper().startswith("ENDDATA"):
            break
        if first.upper() == "INCLUDE" or re.match(r"\s*include\b", line, re.IGNORECASE):
            raise ValueError("INCLUDE names another file, which a mesh file may not; put its lines in its place")
        if not first or first[0] in "+*":
            card += _fields(line)
            continue
        if card and card[0] in _READ:
            yield card
        card = [first.rstrip("*").upper(), *_fields(line)]
    if card and card[0] in _READ:
        yield card


def _fields(line: str) -> list[str]:
    """Fields of a line behind its first, without the one that marks the continuation."""
    if "," in line:
        words = [word.strip() for word in line.split(",")]
        # the tenth field names the line that follows, and so does one that starts with +
        return [word for k, word in enumerate(words[1:], 1) if k < 9 and not word.startswith("+C") and word != "+"]
    line = line.expandtabs(_SMALL)
    width = _LARGE if "*" in line[:_SMALL] else _SMALL
    line = line[: _SMALL + 64]
    return [line[k : k + width].strip() for k in range(_SMALL, len(line), width)]


def _content(listed: Iterator[list[str]], names: dict[int, str]) -> FileMesh:
    numbers: list[int] = []
    places: list[tuple[float, float, float]] = []
    systems_of: list[int] = []
    systems: dict[int, System] = {}
    usual = 0
    volume: dict[str, list[list[int]]] = {}
    faces: list[tuple[str | int | None, list[int]]] = []
    for name, *fields in listed:
        if name == "GRID":
            numbers.append(int(fields[0]))
            places.append((real(_at(fields, 2)), real(_at(fields, 3)), real(_at(fields, 4))))
            systems_of.append(int(_at(fields, 1) or -1))
        elif name == "GRDSET":
            usual = int(_at(fields, 1) or 0)
        elif name in SYSTEMS:
            number = int(fields[0])
            systems[number] = System(name, int(_at(fields, 1) or 0), [real(word) for word in _padded(fields[2:], 9)])
        elif name in _CELLS:
            kind, size = _CELLS[name]
            corners = [int(word) for word in fields[2:] if word]
            require(len(corners) == size, _not_linear(name, fields[0], len(corners), size))
            volume.setdefault(kind, []).append(corners)
        else:
            size = _FACES[name]
            group = int(fields[1] or fields[0])
            corners = [int(word) for word in fields[2 : 2 + size]]
            faces.append((names.get(group, group), corners))
    known = np.array(numbers, np.int64)
    points = _based(np.array(places, np.float64).reshape(-1, 3), np.array(systems_of), usual, systems)
    _require_each_once(known)
    cells = [Cells(kind, rows_by_number(known, np.array(rows, np.int64), "node")) for kind, rows in volume.items()]
    surfaces = [
        replace(group, polygons=rows_by_number(known, group.polygons, "node")) for group in grouped(iter(faces))
    ]
    return FileMesh(points, cells, surfaces)


def _require_each_once(numbers: Ints) -> None:
    found, count = np.unique(numbers, return_counts=True)
    twice = found[count > 1]
    require(not len(twice), f"{len(twice)} nodes have the number of another, first {twice[:1].tolist()}")


def _not_linear(name: str, number: str, corners: int, size: int) -> str:
    return f"{name} {number} has {corners} nodes, not {size}: write the mesh with linear elements"


def _at(fields: list[str], place: int) -> str:
    return fields[place] if place < len(fields) else ""


def _padded(fields: list[str], count: int) -> list[str]:
    return [*fields, *[""] * count][:count]


def real(word: str) -> float:
    """Give a real number as NASTRAN writes it; a blank is 0.

    Examples
    --------
    >>> real("1.5-3"), real("-.25D+2"), real("")
    (0.0015, -25.0, 0.0)
    """
    if not word:
        return 0.0
    require(_NUMBER.fullmatch(word) is not None, f"{word!r} is no number")
    plain = word.lower().replace("d", "e")
    return float(plain if "e" in plain else _EXPONENT.sub("e", plain, count=1))


def _based(places: Floats, systems_of: Ints, usual: int, systems: dict[int, System]) -> Floats:
    """Places in the base system, of points each in the system of its number."""
    system = np.where(systems_of < 0, usual, systems_of) if len(places) else systems_of
    points = places.copy()
    for number in np.unique(system[system > 0]).tolist():
        points[system == number] = in_base(places[system == number], number, systems)
    return points
