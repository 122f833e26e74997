"""`constant/polyMesh`: points, faces, owner, neighbour, boundary."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.errors import StageError
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.openfoam.foam_file import (
    LARGEST_LABEL,
    Encoding,
    format_faces,
    format_header,
    format_labels,
    format_vectors,
)

LOCATION = "constant/polyMesh"


def write_poly_mesh(mesh: FaceMesh, folder: Path, types: dict[str, str], encoding: Encoding = "binary") -> None:
    """Write the mesh's five files into an existing folder.

    Parameters
    ----------
    mesh : FaceMesh
    folder : Path
        The `polyMesh` folder.
    types : dict
        Entries of each patch in `boundary`, like ``"type wall;"``.
    encoding : "binary" or "ascii"
    """
    if max(len(mesh.corners), mesh.cells) > LARGEST_LABEL:
        raise StageError(
            f"{mesh.cells} cells need labels of 64 bits, but OpenFOAM is mostly built with 32; coarsen the mesh"
        )
    note = f"nPoints:{len(mesh.points)} nCells:{mesh.cells} nFaces:{mesh.faces} nInternalFaces:{mesh.internal}"
    faces_class = "faceCompactList" if encoding == "binary" else "faceList"
    parts = {
        "points": ("vectorField", "", format_vectors(mesh.points, encoding)),
        "faces": (faces_class, "", format_faces(mesh.corners, mesh.offsets, encoding)),
        "owner": ("labelList", note, format_labels(mesh.owner, encoding)),
        "neighbour": ("labelList", note, format_labels(mesh.neighbour, encoding)),
    }
    for name, (kind, comment, content) in parts.items():
        with (folder / name).open("wb") as file:
            file.write(format_header(kind, name, LOCATION, encoding, comment).encode())
            file.write(content)
    (folder / "boundary").write_text(format_boundary(mesh.patches, types), encoding="ascii")


def format_boundary(patches: tuple[Patch, ...], types: dict[str, str]) -> str:
    """List of the patches with their types; always text.

    Examples
    --------
    >>> print(format_boundary((Patch("inlet", 12, 2),), {"inlet": "type patch;"}).split("}")[1])
    1
    (
        inlet
        {
            type patch;
            nFaces 2;
            startFace 12;
    <BLANKLINE>
    """
    entries = "".join(
        f"    {patch.name}\n    {{\n        {types[patch.name]}\n"
        f"        nFaces {patch.count};\n        startFace {patch.start};\n    }}\n"
        for patch in patches
    )
    return format_header("polyBoundaryMesh", "boundary", LOCATION) + f"{len(patches)}\n(\n{entries})\n"
