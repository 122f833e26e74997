"""Meshes that are not ours: an OpenFOAM case, or a file of any format that the registry reads."""

# SPDX-License-Identifier: GPL-3.0-or-later

import stat
from pathlib import Path

from pipeline.errors import StageError
from pipeline.export.formats.format import HEAD
from pipeline.export.formats.registry import of_file, suffixes_read, why_not_read
from pipeline.machine import memory_bounded
from pipeline.nouns.mesh import FaceMesh
from pipeline.openfoam.read import LARGEST_FILE, read_openfoam
from pipeline.openfoam.read import mesh_files as openfoam_files


def read_mesh(path: Path) -> FaceMesh:
    """Read a mesh of tetrahedra, hexahedra, prisms, pyramids or, from OpenFOAM and Fluent, any polyhedra.

    Parameters
    ----------
    path : Path
        An OpenFOAM case (its folder, its `polyMesh` folder, or a ``.foam`` file in it), or a mesh file of a format
        that `pipeline.export.formats.registry` lists. The suffix's case does not matter.

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
    place = path.parent if path.suffix.lower() == ".foam" else path
    return openfoam_files(place) if place.is_dir() else [place]


def _read(path: Path) -> FaceMesh:
    if path.suffix.lower() == ".foam":
        path = path.parent
    if path.is_dir():
        return read_openfoam(path)
    try:
        about = path.stat()
        if not stat.S_ISREG(about.st_mode):
            raise StageError(f"cannot read {path}: it is no file")
        with path.open("rb") as file:
            head = file.read(HEAD)
    except OSError as problem:
        raise StageError(f"cannot read {path}: {(problem.strerror or str(problem)).lower()}") from problem
    if about.st_size > LARGEST_FILE:
        raise StageError(f"{path} has {about.st_size} bytes, more than the {LARGEST_FILE} that a mesh file may have")
    found = of_file(path, head)
    if found is None or found.read is None:
        reason = why_not_read(path)
        known = f"an OpenFOAM case's folder, {', '.join(suffixes_read())}"
        raise StageError(
            f"cannot read {path}: the format {reason}"
            if reason
            else f"cannot tell the mesh format of {path} by its suffix and first characters; known: {known}"
        )
    return found.read(path)
