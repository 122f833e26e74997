"""Abaqus' input file: nodes, tetrahedra, and an element set of triangles per patch."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from pathlib import Path

from pipeline.export.formats.format import Format, Order
from pipeline.export.formats.read_abaqus import read_abaqus
from pipeline.export.formats.text import groups, rows, write_text
from pipeline.nouns.mesh import FaceMesh

_TYPES = {4: "C3D4", 3: "S3"}


def write_abaqus(mesh: FaceMesh, folder: Path, order: Order) -> None:
    """Write `mesh.inp` in meters, the patches as element sets by name."""
    order.progress("export: abaqus")
    write_text(folder / "mesh.inp", format_abaqus(mesh))


def format_abaqus(mesh: FaceMesh) -> Iterator[str]:
    """Give the file's text, piece by piece."""
    yield "*HEADING\nwritten by fibertwin, in meters\n*NODE\n"
    yield from rows(mesh.points, lambda k, p: f"{k + 1}, {p[0]!r}, {p[1]!r}, {p[2]!r}\n")
    first = 1
    for _, name, cells in groups(mesh):
        yield f"*ELEMENT, TYPE={_TYPES[cells.shape[1]]}, ELSET={name}\n"
        yield from rows(cells + 1, lambda k, c, first=first: f"{first + k}, {', '.join(map(str, c))}\n")  # type: ignore[misc]
        first += len(cells)


FORMAT = Format(
    "abaqus",
    (".inp",),
    cells="tetrahedra",
    write=write_abaqus,
    read=read_abaqus,
    # an AVS file of the same suffix starts with a number or #
    recognizes=lambda head: head.lstrip()[:1] == b"*",
)
