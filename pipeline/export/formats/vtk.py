"""VTK files for ParaView and PyVista: the volume, one surface per patch, and one file that names them all."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.export.formats.format import Format
from pipeline.export.formats.read_vtk import read_vtk
from pipeline.export.formats.vtk_index import BOUNDARY, INDEX, VOLUME, format_vtm
from pipeline.geometry.faces import compacted
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS
from pipeline.progress import Progress, silent

if TYPE_CHECKING:
    import pyvista as pv


def write_vtk(mesh: FaceMesh, folder: Path, fields: Mapping[str, Floats], progress: Progress = silent) -> None:
    """Write `mesh.vtm`, which names `internal.vtu` and `boundary/<patch>.vtp`.

    Cell data `fiber` of the patch of the fibers numbers the fiber at each face, where the mesh knows it.

    Parameters
    ----------
    mesh : FaceMesh
        Tetrahedra are written as such, all other cells as polyhedra.
    folder : Path
        Made if it is not there.
    fields : mapping of name to (cells,) array
        Put on the cells, for example the quality of each.
    progress : Progress
    """
    progress("export: VTK")
    grid = volume_grid(mesh)
    (folder / BOUNDARY).mkdir(parents=True, exist_ok=True)
    for name, values in fields.items():
        grid.cell_data[name] = values
    grid.save(folder / VOLUME)
    for patch in mesh.patches:
        surface = patch_surface(mesh, patch.name)
        surface.cell_data["owner"] = mesh.owner[patch.start : patch.start + patch.count]
        if patch.name == FIBERS and len(mesh.fiber):
            surface.cell_data["fiber"] = mesh.fiber
        surface.save(folder / BOUNDARY / f"{patch.name}.vtp")
    (folder / INDEX).write_text(format_vtm(patch.name for patch in mesh.patches), encoding="utf-8")


def volume_grid(
    mesh: FaceMesh, chosen: npt.NDArray[np.bool_] | None = None, scale: float = 1.0
) -> "pv.UnstructuredGrid":
    """Give the cells to VTK.

    Parameters
    ----------
    mesh : FaceMesh
    chosen : (cells,) bool array, optional
        The cells wanted; all when not given.
    scale : float
        VTK's length over the mesh's.

    Returns
    -------
    pyvista.UnstructuredGrid
        Of tetrahedra where all cells are, else of polyhedra.
    """
    import pyvista as pv

    wanted = np.ones(mesh.cells, dtype=bool) if chosen is None else chosen
    points = mesh.points * scale
    if mesh.tetrahedral:
        return pv.UnstructuredGrid({pv.CellType.TETRA: mesh.tets()[wanted]}, points)
    count = int(wanted.sum())
    return pv.UnstructuredGrid(_polyhedra(mesh, wanted), np.full(count, pv.CellType.POLYHEDRON, np.uint8), points)


def _polyhedra(mesh: FaceMesh, wanted: npt.NDArray[np.bool_]) -> Ints:
    """Cells as VTK lists them: entries that follow, faces, and for each face its corners behind their number."""
    cell = np.concatenate([mesh.owner, mesh.neighbour])
    face = np.concatenate([np.arange(mesh.faces), np.arange(mesh.internal)])
    order = np.flatnonzero(wanted[cell])
    order = order[np.argsort(cell[order], kind="stable")]
    cell, face = cell[order], face[order]
    size = np.diff(mesh.offsets)[face]
    # what stands before each face in the list: two numbers for every cell begun, and the faces before it
    begun = np.cumsum(np.append(True, cell[1:] != cell[:-1]))
    start = 2 * begun + np.cumsum(size + 1) - (size + 1)
    result = np.empty(int(start[-1] + size[-1] + 1), np.int64)
    result[start] = size
    place = np.repeat(start + 1 - (np.cumsum(size) - size), size) + np.arange(int(size.sum()))
    corner = np.repeat(mesh.offsets[face] - (np.cumsum(size) - size), size) + np.arange(int(size.sum()))
    result[place] = mesh.corners[corner]
    first = np.flatnonzero(np.append(True, cell[1:] != cell[:-1]))
    heads = start[first] - 2
    result[heads + 1] = np.diff(np.append(first, len(face)))
    result[heads] = np.diff(np.append(heads, len(result))) - 1
    return result


def patch_surface(mesh: FaceMesh, name: str, scale: float = 1.0) -> "pv.PolyData":
    """Give the faces of a patch to VTK.

    Parameters
    ----------
    mesh : FaceMesh
    name : str
        Of the patch.
    scale : float
        VTK's length over the mesh's.

    Returns
    -------
    pyvista.PolyData
        One polygon per face, in the mesh's order, facing out of the air.
    """
    import pyvista as pv

    which = mesh.patch(name)
    offsets = mesh.offsets[which.start : which.stop + 1]
    points, corners = compacted(mesh.points, mesh.corners[offsets[0] : offsets[-1]])
    # VTK wants the number of corners before those of each face
    return pv.PolyData(points * scale, faces=np.insert(corners, offsets[:-1] - offsets[0], np.diff(offsets)))


FORMAT = Format(
    "vtk",
    (".vtu", ".vtk", ".vti", ".vts", ".vtr"),
    write=lambda mesh, folder, order: write_vtk(mesh, folder, order.fields, order.progress),
    read=read_vtk,
)
