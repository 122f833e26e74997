"""Fluent's mesh in text (`.msh`): nodes, cells, faces, and zones with names and conditions.

The numbers of nodes, cells and faces are hexadecimal, but a zone's id is decimal where its name is given.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from pipeline.errors import StageError
from pipeline.export.formats.format import Format
from pipeline.export.formats.read_fluent import read_fluent
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.nouns.patches import DUCT
from pipeline.progress import Progress, silent

_INTERIOR = (2, "interior")
_BY_ROLE = {
    "inlet": (10, "velocity-inlet"),
    "outlet": (5, "pressure-outlet"),
    "wall": (3, "wall"),
    "side": (7, "symmetry"),
}
_CONDITIONS = {patch.name: _BY_ROLE[patch.role] for patch in DUCT}
"""Number and name of the condition that a patch gets. Fluent's symmetry is its frictionless wall too."""
FLUID_ZONE = 2
_TETRAHEDRA, _POLYHEDRA = 2, 7
_TRIANGLES, _POLYGONS = 3, 5  # a polygon's row begins with how many corners it has
_ROWS = 20_000  # faces that become text at once: the memory stays small


def write_fluent(mesh: FaceMesh, path: Path, sides: str = "symmetry", progress: Progress = silent) -> None:
    """Write a mesh in meters: tetrahedra as such, all other cells as polyhedra.

    Parameters
    ----------
    mesh : FaceMesh
    path : Path
        ``.msh``; its folder is made if it is not there.
    sides : "symmetry" or "slip"
    progress : Progress

    Raises
    ------
    StageError
        If the sides are cyclic, or a patch has no condition known.
    """
    if sides == "cyclic":
        raise StageError(
            "Fluent pairs periodic faces itself: set enclosure.sides to symmetry, and after reading the mesh "
            "use /mesh/modify-zones/make-periodic"
        )
    unknown = sorted({patch.name for patch in mesh.patches} - set(_CONDITIONS))
    if unknown:
        raise StageError(f"no Fluent condition is known for patch {', '.join(unknown)}")
    progress("export: Fluent")
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(format_fluent(mesh))


def format_fluent(mesh: FaceMesh) -> Iterator[str]:
    """Give the file's text, piece by piece."""
    yield '(0 "written by fibertwin, in meters")\n(2 3)\n'
    yield f"(10 (0 1 {len(mesh.points):x} 0 3))\n(10 (1 1 {len(mesh.points):x} 1 3)(\n"
    for start in range(0, len(mesh.points), _ROWS):
        yield "".join("%.16e %.16e %.16e\n" % (x, y, z) for x, y, z in mesh.points[start : start + _ROWS].tolist())  # noqa: UP031 (twice as fast)
    kind = _TETRAHEDRA if mesh.tetrahedral else _POLYHEDRA
    yield f"))\n(12 (0 1 {mesh.cells:x} 0))\n(12 ({FLUID_ZONE} 1 {mesh.cells:x} 1 {kind}))\n"
    yield f"(13 (0 1 {mesh.faces:x} 0))\n"
    shape = _TRIANGLES if mesh.tetrahedral else _POLYGONS
    zones = [(Patch("interior-fluid", 0, mesh.internal), _INTERIOR)]
    zones += [(patch, _CONDITIONS[patch.name]) for patch in mesh.patches]
    for zone, (patch, (condition, _)) in enumerate(zones, FLUID_ZONE + 1):
        yield f"(13 ({zone:x} {patch.start + 1:x} {patch.start + patch.count:x} {condition:x} {shape})(\n"
        yield from _format_faces(mesh, patch)
        yield "))\n"
    yield f"(45 ({FLUID_ZONE} fluid fluid)())\n"
    for zone, (patch, (_, name)) in enumerate(zones, FLUID_ZONE + 1):
        yield f"(45 ({zone} {name} {patch.name})())\n"


def _format_faces(mesh: FaceMesh, patch: Patch) -> Iterator[str]:
    end = patch.start + patch.count
    triangles = mesh.tetrahedral
    for start in range(patch.start, end, _ROWS):
        rows = slice(start, min(start + _ROWS, end))
        own = (mesh.owner[rows] + 1).tolist()
        other = (mesh.neighbour[rows] + 1).tolist() if end <= mesh.internal else [0] * len(own)
        bounds = mesh.offsets[rows.start : rows.stop + 1]
        # the right hand's thumb points into the first cell: the owner's outward order, reversed
        if triangles:
            a, b, c = (mesh.corners[bounds[0] : bounds[-1]].reshape(-1, 3).T[::-1] + 1).tolist()
            yield "".join("%x %x %x %x %x\n" % row for row in zip(a, b, c, own, other, strict=True))  # noqa: UP031 (twice as fast)
            continue
        corners = (mesh.corners[bounds[0] : bounds[-1]] + 1).tolist()
        ends = (bounds - bounds[0]).tolist()
        for k, (first, last) in enumerate(pairwise(ends)):
            numbers = [last - first, *reversed(corners[first:last]), own[k], other[k]]
            yield " ".join(f"{number:x}" for number in numbers) + "\n"


FORMAT = Format(
    "fluent",
    (".msh", ".cas"),
    write=lambda mesh, folder, order: write_fluent(mesh, folder / "mesh.msh", order.sides, order.progress),
    read=read_fluent,
    recognizes=lambda head: head.lstrip()[:1] == b"(",
)
