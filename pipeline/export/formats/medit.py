"""Medit's mesh in text (`.mesh`): vertices, then lists of elements whose last number names a group."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pipeline.export.formats.file_mesh import Cells, FileMesh, NamedFaces, face_mesh, named
from pipeline.export.formats.format import Format, Order
from pipeline.export.formats.reading import damage_told
from pipeline.export.formats.text import groups, rows, write_numbers, write_text
from pipeline.nouns.arrays import require
from pipeline.nouns.mesh import FaceMesh

_CELLS = {
    "Tetrahedra": ("tetra", 4),
    "Hexahedra": ("hexahedron", 8),
    "Prisms": ("wedge", 6),
    "Pyramids": ("pyramid", 5),
}
_FACES = {"Triangles": 3, "Quadrilaterals": 4}
_TITLES = {4: "Tetrahedra", 3: "Triangles"}
_WORD = re.compile(r"^\s*([A-Z][A-Za-z]+)", re.MULTILINE)


def write_medit(mesh: FaceMesh, folder: Path, order: Order) -> None:
    """Write `mesh.mesh` in meters, the patches by number, and `patches.txt` with their names."""
    order.progress("export: medit")
    write_text(folder / "mesh.mesh", format_medit(mesh))
    write_numbers(mesh, folder)


def format_medit(mesh: FaceMesh) -> Iterator[str]:
    """Give the file's text, piece by piece."""
    yield f"MeshVersionFormatted 2\nDimension 3\nVertices\n{len(mesh.points)}\n"
    yield from rows(mesh.points, lambda _, p: f"{p[0]!r} {p[1]!r} {p[2]!r} 0\n")
    parts = groups(mesh)
    for size, title in _TITLES.items():
        chosen = [(number, cells) for number, _, cells in parts if cells.shape[1] == size]
        yield f"{title}\n{sum(len(cells) for _, cells in chosen)}\n"
        for number, cells in chosen:
            yield from rows(cells + 1, lambda _, c, number=number: f"{' '.join(map(str, c))} {number}\n")  # type: ignore[misc]
    yield "End\n"


def read_medit(path: Path) -> FaceMesh:
    """Read a mesh in text; each number of surfaces becomes a patch ``surface-<number>``.

    Raises
    ------
    StageError
        If the file is damaged, or holds something else.
    """
    with damage_told(path):
        return face_mesh(_content(re.sub(r"#[^\n]*", "", path.read_text(encoding="latin-1"))))


def _content(text: str) -> FileMesh:
    found = list(_WORD.finditer(text))
    require(bool(found) and found[0][1] == "MeshVersionFormatted", "it does not start with MeshVersionFormatted")
    points = np.empty((0, 3))
    cells: list[Cells] = []
    surfaces: list[NamedFaces] = []
    for word, following in zip(found, [*found[1:], None], strict=True):
        body = text[word.end() : following.start() if following else None]
        title = word[1]
        if title == "Dimension":
            require(body.split()[:1] == ["3"], f"it has {body.strip()[:20]} dimensions, not 3")
        elif title == "Vertices":
            points = _table(body, 4, title)[:, :3]
        elif title in _CELLS:
            kind, size = _CELLS[title]
            cells.append(Cells(kind, _table(body, size + 1, title)[:, :size].astype(np.int64) - 1))
        elif title in _FACES:
            table = _table(body, _FACES[title] + 1, title).astype(np.int64)
            surfaces += [named(table[table[:, -1] == n, :-1] - 1, n) for n in np.unique(table[:, -1]).tolist()]
    return FileMesh(points, cells, surfaces)


def _table(body: str, columns: int, title: str) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    count, *words = body.split()
    require(len(words) == int(count) * columns, f"{title} says {count} rows but has {len(words) / columns:g}")
    return np.array(words, np.float64).reshape(-1, columns)


FORMAT = Format("medit", (".mesh",), cells="tetrahedra", patches="by number", write=write_medit, read=read_medit)
