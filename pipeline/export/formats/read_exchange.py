"""Reads what meshio reads: the cells as faces between an owner and a neighbour, the surfaces as patches."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import io
import struct
import zlib
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError

import numpy as np

from pipeline.errors import StageError
from pipeline.export.formats.read_vtu import read_vtu
from pipeline.geometry.cells import KINDS, cell_faces, polygons_of, rows_of
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh, Patch

UNNAMED = "boundary"
_SURFACES = {"triangle": 3, "quad": 4}
_TAGS = ("gmsh:physical", "su2:tag", "medit:ref", "nastran:ref")
_READABLE = frozenset(
    {
        "abaqus",
        "avsucd",
        "flac3d",
        "gmsh",
        "medit",
        "nastran",
        "netgen",
        "permas",
        "su2",
        "tetgen",
        "ugrid",
        "vtk",
        "vtu",
    }
)
"""What meshio reads here: not those that hold surfaces only, that name other files to read, or that need HDF5."""
_IGNORED = {"vertex", "line", *_SURFACES}
# What meshio's readers, which trust their input, end with on a damaged file.
_DAMAGE = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    EOFError,
    LookupError,
    MemoryError,
    NameError,
    OSError,
    ParseError,
    RuntimeError,
    StopIteration,
    TypeError,
    ValueError,
    struct.error,
    zlib.error,
)


def read_exchange(path: Path) -> FaceMesh:
    """Read a file of tetrahedra, hexahedra, prisms and pyramids.

    Raises
    ------
    StageError
        If no reader takes the file, or its mesh has no volume, or cells that are not read.
    """
    content = _load(path)
    try:
        return _faces(content)
    except ValueError as problem:
        raise StageError(f"the mesh in {path} is no volume mesh that a solver could take: {problem}") from problem


def _load(path: Path) -> Any:
    import meshio
    from meshio._exceptions import CorruptionError
    from meshio._helpers import extension_to_filetypes, reader_map

    kinds = [kind for kind in extension_to_filetypes.get(path.suffix.lower(), []) if kind in _READABLE]
    if not kinds:
        known = sorted(suffix for suffix, names in extension_to_filetypes.items() if _READABLE & set(names))
        raise StageError(f"cannot tell the mesh format of {path}; known: an OpenFOAM case's folder, {', '.join(known)}")
    problems = []
    for kind in kinds:
        try:
            # meshio prints a line for each line that it cannot read: what it makes of the file is what counts
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                return read_vtu(path) if kind == "vtu" else reader_map[kind](str(path))
        except (meshio.ReadError, CorruptionError, *_DAMAGE) as problem:
            problems.append(f"as {kind}: {type(problem).__name__} {problem}".strip())
    raise StageError(f"cannot read {path}: " + "; ".join(problems))


def _faces(content: Any) -> FaceMesh:
    points = np.asarray(content.points, np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError("its points have not three coordinates")
    polygons, cell, cells = _volume(content, points)
    found = cell_faces(polygons, cell)
    internal = len(found.neighbour)
    boundary = found.polygons[internal:]
    patch, names = _patches(content, boundary)
    order = np.concatenate([np.arange(internal), internal + np.argsort(patch, kind="stable")])
    counts = np.bincount(patch, minlength=len(names))
    starts = internal + np.cumsum(counts) - counts
    ordered = found.polygons[order]
    return FaceMesh(
        points=points,
        corners=ordered[ordered >= 0],
        offsets=np.concatenate([[0], np.cumsum((ordered >= 0).sum(axis=1))]),
        owner=found.owner[order],
        neighbour=found.neighbour,
        cells=cells,
        patches=tuple(
            Patch(name, int(start), int(count))
            for name, start, count in zip(names, starts, counts, strict=True)
            if count
        ),
    )


def _volume(content: Any, points: Floats) -> tuple[Ints, Ints, int]:
    """Faces of all cells with the cell of each, and the number of cells."""
    polygons: list[Ints] = []
    cell: list[Ints] = []
    cells = 0
    for block in content.cells:
        if block.type in _IGNORED:
            continue
        if block.type.startswith("polyhedron"):
            faces = [np.asarray(face, np.int64) for faces in block.data for face in faces]
            width = max(map(len, faces), default=4)
            polygons.append(np.array([np.pad(face, (0, width - len(face)), constant_values=-1) for face in faces]))
            cell.append(cells + np.repeat(np.arange(len(block.data)), [len(faces) for faces in block.data]))
            cells += len(block.data)
            continue
        if block.type not in KINDS:
            raise ValueError(f"{len(block.data)} cells are of the kind {block.type}, which is not read")
        corners = _corners(block, len(points))
        if block.type == "wedge" and _mostly_inside_out(points, corners):
            # VTK and gmsh number a prism's two triangles the opposite way round
            corners = corners[:, [3, 4, 5, 0, 1, 2]]
        polygons.append(polygons_of(block.type, corners))
        cell.append(cells + np.repeat(np.arange(len(corners)), len(KINDS[block.type])))
        cells += len(corners)
    if not cells:
        raise ValueError("it has no tetrahedron, pyramid, prism or hexahedron")
    width = max(faces.shape[1] for faces in polygons)
    return np.concatenate([_widened(faces, width) for faces in polygons]), np.concatenate(cell), cells


def _widened(faces: Ints, width: int) -> Ints:
    return np.pad(faces, ((0, 0), (0, width - faces.shape[1])), constant_values=-1)


def _corners(block: Any, points: int) -> Ints:
    """Corners of a block's cells, where each has as many as its kind and all are points."""
    size = _SURFACES.get(block.type) or int(KINDS[block.type].max()) + 1
    corners = np.asarray(block.data, np.int64)
    if corners.ndim != 2 or corners.shape[1] != size:
        raise ValueError(f"a {block.type} has not {size} corners")
    if len(corners) and not 0 <= corners.min() <= corners.max() < points:
        raise ValueError(f"a {block.type} has a corner that is no point")
    return corners


def _mostly_inside_out(points: Floats, wedges: Ints) -> bool:
    a, b, c, d = (points[wedges[:, k]] for k in range(4))
    return bool((np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0).mean() > 0.5)


def _patches(content: Any, boundary: Ints) -> tuple[Ints, list[str]]:
    """Patch of each boundary face, and the patches' names; faces that no surface names come last."""
    width = max(4, boundary.shape[1])
    surfaces, label = [np.empty((0, width), np.int64)], []
    for index, block in enumerate(content.cells):
        if block.type in _SURFACES:
            surfaces.append(_widened(_corners(block, len(content.points)), width))
            label += _labels(content, index, len(block.data))
    row = rows_of(_widened(boundary, width), np.concatenate(surfaces))
    names = sorted(set(label) - {UNNAMED})
    number = np.array([names.index(name) if name in names else len(names) for name in [*label, UNNAMED]], np.int64)
    return number[row], [*names, UNNAMED]


def _labels(content: Any, index: int, count: int) -> list[str]:
    """Names of the faces of one block of surfaces: from its groups or numbers, and from the file's sets."""
    label = [UNNAMED] * count
    names = {(int(tag), int(dim)): name for name, (tag, dim) in content.field_data.items()}
    for key, values in content.cell_data.items():
        if key in _TAGS:
            label = [names.get((int(tag), 2), f"surface-{int(tag)}") for tag in values[index]]
    for name, parts in content.cell_sets.items():
        if not name.startswith("gmsh:") and index < len(parts) and parts[index] is not None:
            for face in np.asarray(parts[index], np.int64).tolist():
                if not 0 <= face < count:
                    raise ValueError(f"its set {name} names a face that is not there")
                label[face] = name
    return label
