"""Meshes that are not ours: an OpenFOAM case, Fluent, or any file that meshio reads."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.errors import StageError
from pipeline.export.formats.read_exchange import read_exchange
from pipeline.export.formats.read_fluent import read_fluent
from pipeline.machine import memory_bounded
from pipeline.nouns.mesh import FaceMesh
from pipeline.openfoam.read import FILES, LARGEST_FILE, mesh_folder, read_openfoam


def read_mesh(path: Path) -> FaceMesh:
    """Read a mesh of tetrahedra, hexahedra, prisms, pyramids or, from OpenFOAM and Fluent, any polyhedra.

    Parameters
    ----------
    path : Path
        An OpenFOAM case (its folder, its `polyMesh` folder, or a ``.foam`` file in it), or a mesh file: Fluent's
        ``.msh`` or ``.cas`` in text, VTK's ``.vtu`` or ``.vtk``, gmsh's ``.msh``, or what else meshio reads.

    Returns
    -------
    FaceMesh
        With the file's patches where it names any, otherwise with one patch `boundary`.

    Raises
    ------
    StageError
        If the path is no mesh, or the mesh is damaged.
    """
    try:
        # a few bytes of a compressed file can ask for all of the machine's memory
        with memory_bounded():
            return _read(path)
    except MemoryError:
        raise StageError(f"cannot read {path}: it asks for more memory than this machine has free") from None


def mesh_files(path: Path) -> list[Path]:
    """Give the files that `read_mesh` reads a mesh from."""
    place = path.parent if path.suffix == ".foam" else path
    return [mesh_folder(place) / name for name in FILES] if place.is_dir() else [place]


def _read(path: Path) -> FaceMesh:
    if path.suffix == ".foam":
        path = path.parent
    if path.is_dir():
        return read_openfoam(path)
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            start = file.read(4096)
    except OSError as problem:
        raise StageError(f"cannot read {path}: {(problem.strerror or str(problem)).lower()}") from problem
    if size > LARGEST_FILE:
        raise StageError(f"{path} has {size} bytes, more than the {LARGEST_FILE} that a mesh file may have")
    if path.suffix in (".msh", ".cas") and start.lstrip()[:1] == b"(":
        return read_fluent(path)
    return read_exchange(path)
