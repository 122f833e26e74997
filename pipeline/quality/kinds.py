"""What the cells of a mesh are: tetrahedra, hexahedra, prisms, pyramids, or other polyhedra."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.nouns.arrays import Ints
from pipeline.nouns.mesh import FaceMesh

POLYHEDRA = "polyhedra"
_FACES_OF = {"tetrahedra": (4, 0), "pyramids": (4, 1), "prisms": (2, 3), "hexahedra": (0, 6)}
"""Kinds by their numbers of triangles and of quadrangles; a cell with these and no other face is of the kind."""
_NAMES = (*_FACES_OF, POLYHEDRA)


def cells_by_kind(mesh: FaceMesh) -> dict[str, int]:
    """Count the cells of each kind, as `checkMesh` does; kinds that the mesh has not are left out.

    A cell beside smaller ones has more faces than its shape has sides: it counts as a polyhedron.
    """
    counts = np.bincount(_kind_of_cells(mesh), minlength=len(_NAMES))
    return {name: int(count) for name, count in zip(_NAMES, counts, strict=True) if count}


def kinds_in_words(mesh: FaceMesh) -> str:
    """Say what the cells are, most frequent first: "980 hexahedra and 44 polyhedra with 7 to 15 faces"."""
    counts = sorted(cells_by_kind(mesh).items(), key=lambda item: -item[1])
    one = {"tetrahedra": "tetrahedron", "hexahedra": "hexahedron", POLYHEDRA: "polyhedron"}
    parts = [
        f"{count:,} {one.get(name, name[:-1]) if count == 1 else name}"
        + (_faces_in_words(mesh) if name == POLYHEDRA else "")
        for name, count in counts
    ]
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def _faces_in_words(mesh: FaceMesh) -> str:
    faces = _per_cell(mesh, np.ones(mesh.faces, bool))[_kind_of_cells(mesh) == _NAMES.index(POLYHEDRA)]
    low, high = int(faces.min()), int(faces.max())
    return f" with {low} faces" if low == high else f" with {low} to {high} faces, {faces.mean():.1f} on average"


def _kind_of_cells(mesh: FaceMesh) -> Ints:
    """Index in `_NAMES` of each cell."""
    size = np.diff(mesh.offsets)
    triangles, quads = _per_cell(mesh, size == 3), _per_cell(mesh, size == 4)
    others = _per_cell(mesh, size > 4)
    kind = np.full(mesh.cells, _NAMES.index(POLYHEDRA))
    for number, (three, four) in enumerate(_FACES_OF.values()):
        kind[(triangles == three) & (quads == four) & (others == 0)] = number
    return kind


def _per_cell(mesh: FaceMesh, which: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Ints:
    """How many of the chosen faces each cell has."""
    ours = np.bincount(mesh.owner[which], minlength=mesh.cells)
    return ours + np.bincount(mesh.neighbour[which[: mesh.internal]], minlength=mesh.cells)
