"""SU2's mesh: elements, points, and a marker per patch. meshio 5.3 reads it but stops with an error when writing it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from pathlib import Path

from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import Progress, silent

_ROWS = 20_000  # lines that become text at once: the memory stays small
_TRIANGLE, _TETRAHEDRON = 5, 10  # VTK's numbers


def write_su2(mesh: FaceMesh, path: Path, progress: Progress = silent) -> None:
    """Write tetrahedra and named markers, in meters.

    Parameters
    ----------
    mesh : FaceMesh
        Of tetrahedra.
    path : Path
        Its folder is made if it is not there.
    progress : Progress
    """
    progress("export: su2")
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(format_su2(mesh))


def format_su2(mesh: FaceMesh) -> Iterator[str]:
    """Give the file's text, piece by piece."""
    yield f"NDIME= 3\nNELEM= {mesh.cells}\n"
    tets = mesh.tets()
    for start in range(0, mesh.cells, _ROWS):
        rows = enumerate(tets[start : start + _ROWS].tolist(), start)
        yield "".join(f"{_TETRAHEDRON} {a} {b} {c} {d} {k}\n" for k, (a, b, c, d) in rows)
    yield f"NPOIN= {len(mesh.points)}\n"
    yield "".join(f"{x!r} {y!r} {z!r} {k}\n" for k, (x, y, z) in enumerate(mesh.points.tolist()))
    yield f"NMARK= {len(mesh.patches)}\n"
    for patch in mesh.patches:
        yield f"MARKER_TAG= {patch.name}\nMARKER_ELEMS= {patch.count}\n"
        corners = mesh.triangles()[patch.start : patch.start + patch.count].tolist()
        yield "".join(f"{_TRIANGLE} {a} {b} {c}\n" for a, b, c in corners)
