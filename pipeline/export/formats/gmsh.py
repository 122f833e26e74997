"""gmsh's mesh, version 2.2 in text: what every other program reads of its versions."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from pathlib import Path

from pipeline.export.formats.format import Format, Order
from pipeline.export.formats.read_gmsh import read_gmsh
from pipeline.export.formats.text import groups, rows, write_text
from pipeline.nouns.mesh import FaceMesh

_KINDS = {3: 2, 4: 4}  # gmsh's number of the kind with so many corners: triangle, tetrahedron


def write_gmsh(mesh: FaceMesh, folder: Path, order: Order) -> None:
    """Write `mesh.msh` in meters, the patches as named physical groups."""
    order.progress("export: gmsh")
    write_text(folder / "mesh.msh", format_gmsh(mesh))


def format_gmsh(mesh: FaceMesh) -> Iterator[str]:
    """Give the file's text, piece by piece."""
    parts = groups(mesh)
    yield f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(parts)}\n"
    yield from (f'{cells.shape[1] - 1} {number} "{name}"\n' for number, name, cells in parts)
    yield f"$EndPhysicalNames\n$Nodes\n{len(mesh.points)}\n"
    yield from rows(mesh.points, lambda k, p: f"{k + 1} {p[0]!r} {p[1]!r} {p[2]!r}\n")
    yield f"$EndNodes\n$Elements\n{sum(len(cells) for _, _, cells in parts)}\n"
    first = 1
    for number, _, cells in parts:
        head = f"{_KINDS[cells.shape[1]]} 2 {number} {number}"
        yield from rows(
            cells + 1,
            lambda k, c, head=head, first=first: f"{first + k} {head} {' '.join(map(str, c))}\n",  # type: ignore[misc]
        )
        first += len(cells)
    yield "$EndElements\n"


FORMAT = Format(
    "gmsh",
    (".msh",),
    cells="tetrahedra",
    write=write_gmsh,
    read=read_gmsh,
    recognizes=lambda head: head.lstrip()[:1] == b"$",
)
