"""Rows of numbers as text, a piece at a time, so that a file never stands in memory whole."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh

_ROWS = 20_000  # lines that become text at once
VOLUME = "fluid"
"""Name of all cells, where a format wants one."""


def write_text(path: Path, pieces: Iterable[str]) -> None:
    """Write text piece by piece."""
    with path.open("w", encoding="ascii", errors="backslashreplace", newline="\n") as file:
        file.writelines(pieces)


def rows(table: Ints | Floats, line: Callable[[int, list[float]], str]) -> Iterator[str]:
    """Give a line per row of a table, many lines a piece: `line` gets the row's number from 0 and its values."""
    for start in range(0, len(table), _ROWS):
        yield "".join(line(k, row) for k, row in enumerate(table[start : start + _ROWS].tolist(), start))


def groups(mesh: FaceMesh) -> list[tuple[int, str, Ints]]:
    """Give tetrahedra, then each patch's triangles, with a number from 1 and a name.

    Parameters
    ----------
    mesh : FaceMesh
        Of tetrahedra.
    """
    triangles = mesh.triangles()
    parts = [(VOLUME, mesh.tets())]
    parts += [(patch.name, triangles[patch.start : patch.start + patch.count]) for patch in mesh.patches]
    return [(number, name, cells) for number, (name, cells) in enumerate(parts, 1)]


def write_numbers(mesh: FaceMesh, folder: Path) -> None:
    """Write `patches.txt`, which says which number is which patch where a format has numbers only."""
    listed = "".join(f"{number} {name}\n" for number, name, _ in groups(mesh))
    write_text(folder / "patches.txt", [listed])
