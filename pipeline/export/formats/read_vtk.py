"""Reads VTK's files by VTK's own readers: `.vtu`, `.vtk`, and images and grids, in any version and encoding."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.export.formats.file_mesh import Cells, FileMesh, NamedFaces, PolyhedralCells, face_mesh, named
from pipeline.export.formats.reading import damage_told
from pipeline.export.formats.vtk_sizes import check_legacy, check_xml
from pipeline.isolated import isolated
from pipeline.nouns.arrays import Floats, Ints, require
from pipeline.nouns.mesh import FaceMesh

_POLYHEDRON, _VOXEL, _PIXEL, _POLYGON = 42, 11, 8, 7
_KINDS = {10: "tetra", 12: "hexahedron", 13: "wedge", 14: "pyramid", 15: "pentagonal prism", 16: "hexagonal prism"}
_FLAT = {5: 3, 9: 4}
_PASSED_BY = {0, 1, 2, 3, 4, 6}
"""Empty cells, points, lines and strips, which are no part of a volume."""
_SQUARE = [0, 1, 3, 2]
_GROUPS = ("gmsh:physical", "su2:tag", "medit:ref", "nastran:ref", "CellEntityIds")
"""Arrays of cells in which other programs keep the number of a surface."""


def read_vtk(path: Path) -> FaceMesh:
    """Read all cells of a file.

    Raises
    ------
    StageError
        If the file is damaged, holds no volume or curved cells, or asks for far more memory than its own size.
    """
    # before the fork, so that the time counts once
    import vtkmodules.util.numpy_support
    import vtkmodules.vtkCommonDataModel
    import vtkmodules.vtkIOLegacy
    import vtkmodules.vtkIOXML  # noqa: F401

    with damage_told(path):
        return face_mesh(isolated(_content, path))


def _content(path: Path) -> FileMesh:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    legacy = path.suffix.lower() == ".vtk"
    (check_legacy if legacy else check_xml)(path)
    grid = _read(path, legacy)
    count = grid.GetNumberOfCells()
    require(count > 0, "it has no cells, or its reader understood none")
    kinds = _kinds(grid)
    points = _points(grid)
    corners, offsets = _corners(grid, kinds, len(points))
    odd = sorted(set(np.unique(kinds).tolist()) - {*_KINDS, *_FLAT, *_PASSED_BY, _POLYHEDRON, _VOXEL, _PIXEL, _POLYGON})
    require(
        not odd,
        f"{int(np.isin(kinds, odd).sum())} cells are of VTK's kinds {odd}, which are not read: write linear cells",
    )
    cells: list[Cells | PolyhedralCells] = []
    for kind in [*_KINDS, _VOXEL]:
        rows = np.flatnonzero(kinds == kind)
        if len(rows):
            table = _table(corners, offsets, rows)
            if kind == _VOXEL:
                table = table[:, [*_SQUARE, *(4 + k for k in _SQUARE)]]
            cells.append(Cells(_KINDS.get(kind, "hexahedron"), table))
    polyhedra = np.flatnonzero(kinds == _POLYHEDRON)
    if len(polyhedra):
        cells.append(_polyhedra(grid, polyhedra))
    group = next((vtk_to_numpy(found) for name in _GROUPS if (found := grid.GetCellData().GetArray(name))), None)
    return FileMesh(points, cells, list(_surfaces(kinds, corners, offsets, group)))


def _read(path: Path, legacy: bool) -> Any:
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkSMPTools, vtkStringOutputWindow
    from vtkmodules.vtkIOLegacy import vtkGenericDataObjectReader
    from vtkmodules.vtkIOXML import vtkXMLGenericDataObjectReader

    # threads of the process that this one was forked from do not live here
    vtkSMPTools.SetBackend("Sequential")
    reader = vtkGenericDataObjectReader() if legacy else vtkXMLGenericDataObjectReader()
    words = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(words)
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    # what it warns of it left out
    found: Any = words.GetOutput()
    # it quotes the file, whose bytes need not be text
    text = found.decode("latin-1") if isinstance(found, bytes) else str(found)
    said = next((line for line in text.splitlines() if ": " in line and "0x" in line), text)
    require(not said, f"VTK's reader says: {said.rpartition('): ')[2][:200]}")
    require(
        grid is not None and hasattr(grid, "GetCellType"),
        "it holds no mesh: give a .vtu, .vti, .vts, .vtr or .vtk of a grid",
    )
    return grid


def _kinds(grid: Any) -> Ints:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if grid.IsA("vtkUnstructuredGrid"):
        return np.asarray(vtk_to_numpy(grid.GetCellTypesArray()), np.int64)
    if grid.IsA("vtkPolyData"):
        raise ValueError("it holds a surface, and has no tetrahedron, pyramid, prism or hexahedron")
    # a grid whose cells follow from its points: all of one kind
    return np.full(grid.GetNumberOfCells(), grid.GetCellType(0))


def _points(grid: Any) -> Floats:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if hasattr(grid, "GetPoints") and callable(grid.GetPoints) and grid.GetPoints() is not None:
        data = grid.GetPoints()
        return np.asarray(vtk_to_numpy(data.GetData() if hasattr(data, "GetData") else data), np.float64)
    return np.array([grid.GetPoint(k) for k in range(grid.GetNumberOfPoints())])


def _corners(grid: Any, kinds: Ints, points: int) -> tuple[Ints, Ints]:
    """Corners of all cells, one after the other, and where each begins and the last ends."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if grid.IsA("vtkUnstructuredGrid"):
        cells = grid.GetCells()
        offsets = np.asarray(vtk_to_numpy(cells.GetOffsetsArray()), np.int64)
        corners = np.asarray(vtk_to_numpy(cells.GetConnectivityArray()), np.int64)
        whole = len(offsets) == len(kinds) + 1 and offsets[0] == 0 and offsets[-1] <= len(corners)
        require(bool(whole and (np.diff(offsets) >= 0).all()), "its cells do not cover its list of corners")
        return corners, offsets
    dimensions = [0, 0, 0]
    grid.GetDimensions(dimensions)
    nx, ny, nz = dimensions
    require(min(nx, ny, nz) > 1, "it holds a flat grid, and no volume")
    k, j, i = np.meshgrid(*(np.arange(n - 1) for n in (nz, ny, nx)), indexing="ij")
    first = (i + nx * (j + ny * k)).ravel()
    layer = [0, 1, nx, nx + 1] if kinds[0] == _VOXEL else [0, 1, nx + 1, nx]
    steps = np.array([*layer, *(nx * ny + step for step in layer)])
    require(len(first) == len(kinds) and kinds[0] in (_VOXEL, 12), "some of its cells are blanked out")
    return (first[:, None] + steps).ravel(), 8 * np.arange(len(first) + 1)


def _table(corners: Ints, offsets: Ints, rows: Ints) -> Ints:
    sizes = offsets[rows + 1] - offsets[rows]
    size = int(sizes[0])
    require(bool((sizes == size).all()), "cells of the same kind have different numbers of corners")
    table: Ints = corners[offsets[rows][:, None] + np.arange(size)]
    return table


def _polyhedra(grid: Any, cells: Ints) -> PolyhedralCells:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if not hasattr(grid, "GetPolyhedronFaces"):
        return _older_polyhedra(grid, cells)
    faces, of_cells = grid.GetPolyhedronFaces(), grid.GetPolyhedronFaceLocations()
    require(faces is not None and of_cells is not None, "it has polyhedra without faces")
    ends, listed = (
        (
            np.asarray(vtk_to_numpy(part.GetOffsetsArray()), np.int64),
            np.asarray(vtk_to_numpy(part.GetConnectivityArray()), np.int64),
        )
        for part in (faces, of_cells)
    )
    number = np.diff(listed[0])[cells]
    chosen = listed[1][
        np.repeat(listed[0][cells] - (np.cumsum(number) - number), number) + np.arange(int(number.sum()))
    ]
    return PolyhedralCells(_filled(ends[1], ends[0], chosen), np.repeat(np.arange(len(cells)), number), len(cells))


def _older_polyhedra(grid: Any, cells: Ints) -> PolyhedralCells:
    """Before VTK 9.4: a list of how many faces, then for each how many corners and these, for each cell."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    require(grid.GetFaces() is not None, "it has polyhedra without faces")
    listed = vtk_to_numpy(grid.GetFaces()).tolist()
    places = vtk_to_numpy(grid.GetFaceLocations())[cells].tolist()
    ends, corners, of_cell = [0], list[int](), list[int]()
    for cell, start in enumerate(places):
        at = start + 1
        for _ in range(listed[start]):
            corners += listed[at + 1 : at + 1 + listed[at]]
            ends.append(len(corners))
            of_cell.append(cell)
            at += listed[at] + 1
    table = _filled(np.array(corners, np.int64), np.array(ends, np.int64), np.arange(len(of_cell)))
    return PolyhedralCells(table, np.array(of_cell, np.int64), len(cells))


def _filled(corners: Ints, ends: Ints, rows: Ints) -> Ints:
    """Polygons of a list as rows of one width, filled up with -1."""
    sizes = ends[rows + 1] - ends[rows]
    require(bool((sizes >= 3).all()), "a face of a polyhedron has fewer than three corners")
    column = np.arange(int(sizes.max(initial=3)))
    places = np.minimum(ends[rows][:, None] + column, max(len(corners) - 1, 0))
    return np.where(column < sizes[:, None], corners[places], -1)


def _surfaces(kinds: Ints, corners: Ints, offsets: Ints, group: Any) -> Iterator[NamedFaces]:
    numbers = np.zeros(len(kinds), np.int64) if group is None else np.asarray(group).ravel().astype(np.int64)
    require(len(numbers) == len(kinds), "its numbers of surfaces are not as many as its cells")
    flat = [*_FLAT, _PIXEL, _POLYGON]
    chosen = np.flatnonzero(np.isin(kinds, flat))
    sizes = np.diff(offsets)
    for number in np.unique(numbers[chosen]).tolist():
        name = None if group is None else number
        for size in np.unique(sizes[chosen]).tolist():
            for pixels in (False, True):
                rows = chosen[
                    (numbers[chosen] == number) & (sizes[chosen] == size) & ((kinds[chosen] == _PIXEL) == pixels)
                ]
                if len(rows):
                    table = _table(corners, offsets, rows)
                    yield named(table[:, _SQUARE] if pixels else table, name)
