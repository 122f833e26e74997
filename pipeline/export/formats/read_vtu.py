"""Reads VTK's `.vtu` with polyhedra among other cells, as `foamToVTK` writes it: meshio takes only one of both."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.geometry.triangles import Ints

_POLYHEDRON = 42
"""VTK's number of the kind."""
_NEWER = re.compile(rb'(<VTKFile\b[^>]*\bversion=)(["\'])2\.\d+\2')
"""Version of files in which VTK 9.4 and newer keep polyhedra as polygons and their numbers."""
_HEAD = 4096  # bytes in which a file says its version


def read_vtu(path: Path) -> Any:
    """Give what meshio makes of a file, with the cells of all kinds.

    Raises
    ------
    Exception
        Whatever meshio's reader ends with on a damaged file; it trusts its input.
    """
    import meshio

    with _taking_both_kinds(), path.open("rb") as file:
        head = file.read(_HEAD)
        if not _NEWER.search(head):
            return meshio.vtu.read(str(path))
        # what a newer file names otherwise is told apart below, but meshio asks for the version first
        with tempfile.NamedTemporaryFile(suffix=".vtu") as older:
            older.write(_NEWER.sub(rb'\g<1>"1.0"', head, count=1))
            shutil.copyfileobj(file, older)
            older.flush()
            return meshio.vtu.read(older.name)


@contextlib.contextmanager
def _taking_both_kinds() -> Iterator[None]:
    # meshio parses every file, and refuses only when it puts the cells together
    from meshio.vtu import _vtu

    original = _vtu._organize_cells

    def organized(point_offsets: Any, cells: Any, cell_data_raw: Any) -> Any:
        kinds = [np.asarray(piece["types"]) == _POLYHEDRON for piece in cells]
        alike = not any(kind.any() for kind in kinds) or (len(cells) == 1 and kinds[0].all())
        if alike and not any("polyhedron_to_faces" in piece for piece in cells):
            return original(point_offsets, cells, cell_data_raw)
        blocks = []
        for offset, piece, polyhedral in zip(point_offsets, cells, kinds, strict=True):
            blocks += _blocks(_vtu, int(offset), piece, polyhedral.ravel())
        return blocks, {}

    _vtu._organize_cells = organized
    try:
        yield
    finally:
        _vtu._organize_cells = original


def _blocks(vtu: Any, offset: int, piece: Any, polyhedral: Any) -> list[Any]:
    """Blocks of one piece of a file: those of the usual kinds, and one of polyhedra."""
    ends = np.asarray(piece["offsets"], np.int64).ravel()
    corners = np.asarray(piece["connectivity"], np.int64).ravel()
    sizes = np.diff(ends, prepend=0)
    if (sizes < 1).any() or (len(ends) and ends[-1] != len(corners)):
        raise ValueError("its cells do not cover its list of corners")
    usual, blocks = ~polyhedral, []
    if usual.any():
        kept = np.repeat(usual, sizes)
        found, _ = vtu.vtk_cells_from_data(
            corners[kept], np.cumsum(sizes[usual]), np.asarray(piece["types"]).ravel()[usual], {}
        )
        blocks = [vtu.CellBlock(block.type, block.data + offset) for block in found]
    if polyhedral.any():
        polyhedra = _newer_polyhedra if "polyhedron_to_faces" in piece else _polyhedra
        cells = polyhedra({name: np.asarray(values, np.int64).ravel() for name, values in piece.items()}, polyhedral)
        blocks.append(vtu.CellBlock("polyhedron", [[face + offset for face in cell] for cell in cells]))
    return blocks


def _polyhedra(piece: dict[str, Ints], polyhedral: Any) -> list[list[Ints]]:
    """Faces of each polyhedron where each has a list of its own, one after the other."""
    ends = piece["faceoffsets"][polyhedral]
    # it starts where that of the polyhedron before ends
    return [_faces_of(piece["faces"][start:end]) for start, end in zip([0, *ends[:-1]], ends, strict=True)]


def _newer_polyhedra(piece: dict[str, Ints], polyhedral: Any) -> list[list[Ints]]:
    """Faces of each polyhedron where polygons stand by themselves, and polyhedra name theirs."""
    polygons = np.split(piece["face_connectivity"], piece["face_offsets"][:-1])
    faces_of = np.split(piece["polyhedron_to_faces"], piece["polyhedron_offsets"][:-1])
    cells = [[polygons[face] for face in faces_of[cell].tolist()] for cell in np.flatnonzero(polyhedral).tolist()]
    if any(len(face) < 3 for cell in cells for face in cell):
        raise ValueError("a face of a polyhedron has fewer than three corners")
    return cells


def _faces_of(listed: Ints) -> list[Ints]:
    """Faces of a polyhedron from VTK's list: how many, then for each how many corners, and these."""
    faces, at = [], 1
    for _ in range(int(listed[0])):
        size = int(listed[at])
        faces.append(listed[at + 1 : at + 1 + size])
        at += size + 1
    if at != len(listed) or any(len(face) < 3 for face in faces):
        raise ValueError("the faces of a polyhedron are not what its list says")
    return faces
