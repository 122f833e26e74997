"""Formats of other tools, through meshio, as far as they can name the patches."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np

from pipeline.nouns.mesh import FaceMesh
from pipeline.progress import Progress, silent

VOLUME = "fluid"
SUFFIXES = {"gmsh": ".msh", "abaqus": ".inp", "nastran": ".bdf", "medit": ".mesh"}
"""File suffix of each format that is written here."""


def write_exchange(mesh: FaceMesh, path: Path, kind: str, progress: Progress = silent) -> None:
    """Write tetrahedra, and the patches' triangles by name or, where a format has only numbers, by number.

    Parameters
    ----------
    mesh : FaceMesh
        Of tetrahedra.
    path : Path
        Its folder is made if it is not there.
    kind : str
        One of `SUFFIXES`. gmsh and abaqus keep the patches' names; nastran and medit keep their numbers, and
        `patches.txt` beside the mesh says which is which.
    progress : Progress
    """
    import meshio

    progress(f"export: {kind}")
    path.parent.mkdir(parents=True, exist_ok=True)
    triangles, tets = mesh.triangles(), mesh.tets()
    blocks = [("tetra", tets)]
    blocks += [("triangle", triangles[patch.start : patch.start + patch.count]) for patch in mesh.patches]
    names = [VOLUME, *(patch.name for patch in mesh.patches)]
    tags = [np.full(len(cells), number, np.int32) for number, (_, cells) in enumerate(blocks, 1)]
    writer = {"gmsh": "gmsh22"}.get(kind, kind)
    if kind == "gmsh":
        whole = meshio.Mesh(
            mesh.points,
            blocks,
            cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
            field_data={name: np.array([number, 3 if name == VOLUME else 2]) for number, name in enumerate(names, 1)},
        )
        meshio.write(path, whole, writer, binary=False)
        return
    if kind == "abaqus":
        sets = {
            name: [np.arange(len(cells)) if k == at else np.empty(0, np.int64) for k, (_, cells) in enumerate(blocks)]
            for at, name in enumerate(names)
        }
        meshio.write(path, meshio.Mesh(mesh.points, blocks, cell_sets=sets), writer)
        return
    reference = {"nastran": "nastran:ref", "medit": "medit:ref"}[kind]
    meshio.write(path, meshio.Mesh(mesh.points, blocks, cell_data={reference: tags}), writer)
    path.with_name("patches.txt").write_text(
        "".join(f"{number} {name}\n" for number, name in enumerate(names, 1)), encoding="ascii"
    )
