"""A mesh as most files list it, cells by their corners and named surfaces, and the way to a solver's faces."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.geometry.cells import KINDS, cell_faces, polygons_of, rows_of
from pipeline.nouns.arrays import Floats, Ints, require
from pipeline.nouns.mesh import FaceMesh, Patch

UNNAMED = "boundary"
"""Patch of the boundary faces that a file gives no name."""
_NO_WORD = re.compile(r"[\s\"'/;{}]")


@dataclass(frozen=True, slots=True)
class Cells:
    """Cells of one kind of `pipeline.geometry.cells.KINDS`: (m, corners) int array, corners by row of the points."""

    kind: str
    corners: Ints


@dataclass(frozen=True, slots=True)
class PolyhedralCells:
    """Cells by their faces.

    Parameters
    ----------
    polygons : (k, width) int array
        Faces, filled up with -1.
    cell : (k,) int array
        Which of the cells each belongs to, from 0.
    count : int
        Number of cells.
    """

    polygons: Ints
    cell: Ints
    count: int


@dataclass(frozen=True, slots=True)
class NamedFaces:
    """Faces that a file lists by themselves.

    Parameters
    ----------
    polygons : (k, width) int array
        Filled up with -1.
    name : str, optional
        None where the file has neither name nor number for them.
    given : bool
        Whether the file has the name; else it is made of a number.
    """

    polygons: Ints
    name: str | None
    given: bool = True


@dataclass(frozen=True, slots=True)
class FileMesh:
    """What a file says.

    Parameters
    ----------
    points : (n, 3) array [m]
    cells : sequence of Cells or PolyhedralCells
    surfaces : sequence of NamedFaces
        A face may stand in several.
    """

    points: Floats
    cells: Sequence[Cells | PolyhedralCells]
    surfaces: Sequence[NamedFaces] = ()


def face_mesh(content: FileMesh) -> FaceMesh:
    """Give the cells as faces between an owner and a neighbour, the named surfaces as patches.

    A boundary face that several surfaces name belongs to the smallest of them, since a set of all walls says less than
    that of one wall; a name counts more than a number, and that more than none. Names lose what OpenFOAM's words cannot
    have: blanks, quotes, brackets. Points that no cell uses are dropped.

    Raises
    ------
    ValueError
        If there is no cell, or the cells do not fit together.
    """
    points = np.asarray(content.points, np.float64)
    require(points.ndim == 2 and points.shape[1] == 3, "its points have not three coordinates")
    polygons, cell, cells = _volume(content, points)
    found = cell_faces(polygons, cell)
    internal = len(found.neighbour)
    patch, names = _patches(content.surfaces, found.polygons[internal:])
    order = np.concatenate([np.arange(internal), internal + np.argsort(patch, kind="stable")])
    counts = np.bincount(patch, minlength=len(names))
    starts = internal + np.cumsum(counts) - counts
    ordered = found.polygons[order]
    used = np.zeros(len(points), bool)
    used[ordered[ordered >= 0]] = True
    return FaceMesh(
        points=points[used],
        corners=(np.cumsum(used) - 1)[ordered[ordered >= 0]],
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


def _volume(content: FileMesh, points: Floats) -> tuple[Ints, Ints, int]:
    """Faces of all cells with the cell of each, and the number of cells."""
    polygons: list[Ints] = []
    cell: list[Ints] = []
    cells = 0
    for block in content.cells:
        if isinstance(block, PolyhedralCells):
            _require_points(block.polygons[block.polygons >= 0], len(points), "polyhedron")
            polygons.append(block.polygons)
            cell.append(cells + block.cell)
            cells += block.count
            continue
        require(block.kind in KINDS, f"{len(block.corners)} cells are of the kind {block.kind}, which is not read")
        corners = block.corners
        _require_points(corners, len(points), block.kind)
        if block.kind == "wedge" and _mostly_inside_out(points, corners):
            # VTK and gmsh number a prism's two triangles the opposite way round
            corners = corners[:, [3, 4, 5, 0, 1, 2]]
        polygons.append(polygons_of(block.kind, corners))
        cell.append(cells + np.repeat(np.arange(len(corners)), len(KINDS[block.kind])))
        cells += len(corners)
    require(cells > 0, "it has no tetrahedron, pyramid, prism or hexahedron")
    return *_without_repeated_corners(widened(polygons), np.concatenate(cell)), cells


def _require_points(corners: Ints, points: int, kind: str) -> None:
    inside = corners.size == 0 or 0 <= int(corners.min()) <= int(corners.max()) < points
    require(inside, f"a {kind} has a corner that is no point")


def widened(polygons: list[Ints], least: int = 3) -> Ints:
    """Put polygons of different widths into one array, filled up with -1."""
    width = max((faces.shape[1] for faces in polygons), default=least)
    filled = [
        np.pad(faces, ((0, 0), (0, max(width, least) - faces.shape[1])), constant_values=-1) for faces in polygons
    ]
    return np.concatenate(filled) if filled else np.empty((0, max(width, least)), np.int64)


def _without_repeated_corners(polygons: Ints, cell: Ints) -> tuple[Ints, Ints]:
    """Take a collapsed cell's faces as what they are: a quadrangle of three points a triangle, of two none."""
    sizes = (polygons >= 0).sum(axis=1)
    column = np.arange(polygons.shape[1])
    following = np.where(column + 1 < sizes[:, None], np.roll(polygons, -1, axis=1), polygons[:, :1])
    repeated = (polygons >= 0) & (polygons == following)
    touched = np.flatnonzero(repeated.any(axis=1))
    if not len(touched):
        return polygons, cell
    polygons = polygons.copy()
    rows = np.where(repeated[touched], -1, polygons[touched])
    polygons[touched] = np.take_along_axis(rows, np.argsort(rows < 0, axis=1, kind="stable"), axis=1)
    kept = (polygons >= 0).sum(axis=1) >= 3
    return polygons[kept], cell[kept]


def _mostly_inside_out(points: Floats, wedges: Ints) -> bool:
    a, b, c, d = (points[wedges[:, k]] for k in range(4))
    return bool((np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0).mean() > 0.5)


def _patches(surfaces: Sequence[NamedFaces], boundary: Ints) -> tuple[Ints, list[str]]:
    """Patch of each boundary face, and the patches' names in the file's order; faces without a name come last."""
    parts: dict[str, list[Ints]] = {}
    given: dict[str, bool] = {}
    for faces in surfaces:
        name = _NO_WORD.sub("", faces.name or "")
        if name and name != UNNAMED:
            parts.setdefault(name, []).append(faces.polygons)
            given[name] = given.get(name, False) or faces.given
    names = list(parts)
    patch = np.full(len(boundary), len(names))
    # the one that counts most comes last and overwrites the others
    sizes = {name: sum(map(len, faces)) for name, faces in parts.items()}
    for name in sorted(names, key=lambda name: (given[name], -sizes[name], -names.index(name))):
        listed = _each_once(widened(parts[name], boundary.shape[1]))
        row = rows_of(listed, widened([boundary], listed.shape[1]))
        patch[row[row >= 0]] = names.index(name)
    return patch, [*names, UNNAMED]


def _each_once(polygons: Ints) -> Ints:
    """Drop polygons of the same corners as one before."""
    _, index = np.unique(np.sort(polygons, axis=1), axis=0, return_index=True)
    return polygons[np.sort(index)]


def grouped(faces: Iterator[tuple[str | int | None, list[int]]]) -> list[NamedFaces]:
    """Collect single faces, each its name or number and corners, by name and number of corners."""
    groups: dict[tuple[str | int | None, int], list[list[int]]] = {}
    for name, corners in faces:
        groups.setdefault((name, len(corners)), []).append(corners)
    return [named(np.array(rows, np.int64), name) for (name, _), rows in groups.items()]


def named(polygons: Ints, name: str | int | None) -> NamedFaces:
    """Give faces under a name, or under one made of their group's number.

    Examples
    --------
    >>> named(np.array([[0, 1, 2]]), 7).name
    'surface-7'
    """
    given = not isinstance(name, int)
    return NamedFaces(polygons, name if isinstance(name, str) else None if name is None else f"surface-{name}", given)


def rows_by_number(numbers: Ints, wanted: Ints, what: str) -> Ints:
    """Find the rows of points or cells by the numbers that a file gives them.

    Parameters
    ----------
    numbers : (n,) int array
        Number of each row, in any order, none twice.
    wanted : int array
    what : str
        For the message: ``"node"``.

    Returns
    -------
    int array
        Of the shape of `wanted`.

    Raises
    ------
    ValueError
        If a number is wanted that no row has.
    """
    order = np.argsort(numbers, kind="stable")
    ranked = numbers[order]
    place = np.minimum(np.searchsorted(ranked, wanted), max(len(ranked) - 1, 0))
    missing = np.ones(wanted.shape, bool) if not len(ranked) else ranked[place] != wanted
    if missing.any():
        first = int(wanted[missing].ravel()[0])
        raise ValueError(f"{what} {first} is used but not there, and {int(missing.sum()) - 1} more uses like it")
    return np.asarray(order[place], np.int64)
