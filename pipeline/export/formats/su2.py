"""SU2's mesh: elements, points, and a marker per patch."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pipeline.export.formats.file_mesh import Cells, FileMesh, NamedFaces, face_mesh, grouped
from pipeline.export.formats.format import Format, Order
from pipeline.export.formats.reading import Tokens, damage_told, numbers_of
from pipeline.export.formats.text import rows, write_text
from pipeline.nouns.arrays import require
from pipeline.nouns.mesh import FaceMesh

_TRIANGLE, _TETRAHEDRON = 5, 10  # VTK's numbers
_CELLS = {10: ("tetra", 4), 12: ("hexahedron", 8), 13: ("wedge", 6), 14: ("pyramid", 5)}
_FACES = {5: 3, 9: 4}
_LINE = 3


def write_su2(mesh: FaceMesh, folder: Path, order: Order) -> None:
    """Write `mesh.su2` in meters, the patches as markers by name."""
    order.progress("export: su2")
    write_text(folder / "mesh.su2", format_su2(mesh))


def format_su2(mesh: FaceMesh) -> Iterator[str]:
    """Give the file's text, piece by piece."""
    yield f"NDIME= 3\nNELEM= {mesh.cells}\n"
    yield from rows(mesh.tets(), lambda k, c: f"{_TETRAHEDRON} {' '.join(map(str, c))} {k}\n")
    yield f"NPOIN= {len(mesh.points)}\n"
    yield from rows(mesh.points, lambda k, p: f"{p[0]!r} {p[1]!r} {p[2]!r} {k}\n")
    yield f"NMARK= {len(mesh.patches)}\n"
    for patch in mesh.patches:
        yield f"MARKER_TAG= {patch.name}\nMARKER_ELEMS= {patch.count}\n"
        corners = mesh.triangles()[patch.start : patch.start + patch.count]
        yield from rows(corners, lambda k, c: f"{_TRIANGLE} {' '.join(map(str, c))}\n")


def read_su2(path: Path) -> FaceMesh:
    """Read a mesh of one zone in three dimensions.

    Raises
    ------
    StageError
        If the file is damaged, or holds something else.
    """
    with damage_told(path):
        return face_mesh(_content(path.read_text(encoding="latin-1")))


def _content(text: str) -> FileMesh:
    lines = Tokens([re.sub(r"\s*=", "= ", line.split("%")[0]).split() for line in text.splitlines()])
    points = np.empty((0, 3))
    cells: list[Cells] = []
    surfaces: list[NamedFaces] = []
    for words in lines:
        match words:
            case ["NDIME=", dimensions]:
                require(dimensions == "3", f"it has {dimensions} dimensions, not 3")
            case ["NZONE=", zones]:
                require(zones == "1", f"it has {zones} zones; write each into a file of its own")
            case ["NPOIN=", count, *_]:
                points = np.array([numbers_of(row[:3], float, 3) for row in lines.take(int(count), "points")])
            case ["NELEM=", count]:
                cells += _elements(lines.take(int(count), "elements"), None)[0]
            case ["MARKER_TAG=", *name]:
                _, elements = next(lines, ["", "0"])
                surfaces += _elements(lines.take(int(elements), f"elements of {' '.join(name)}"), " ".join(name))[1]
    return FileMesh(points, cells, surfaces)


def _elements(lines: Iterator[list[str]], name: str | None) -> tuple[list[Cells], list[NamedFaces]]:
    volume: dict[str, list[list[int]]] = {}
    faces: list[tuple[str | int | None, list[int]]] = []
    for words in lines:
        kind = int(words[0]) if words else -1
        if kind in _CELLS:
            cell, size = _CELLS[kind]
            volume.setdefault(cell, []).append(numbers_of(words[1 : 1 + size], int, size))
        elif kind in _FACES:
            faces.append((name, numbers_of(words[1 : 1 + _FACES[kind]], int, _FACES[kind])))
        else:
            require(kind == _LINE, f"an element is of SU2's kind {kind}, which is not read")
    return [Cells(kind, np.array(rows, np.int64)) for kind, rows in volume.items()], grouped(iter(faces))


FORMAT = Format("su2", (".su2",), cells="tetrahedra", write=write_su2, read=read_su2)
