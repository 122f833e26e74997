"""A finite-volume solution as a velocity to follow: read in text and in binary, with the solver's own fluxes."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest

from pipeline.capture.cells import velocity_in
from pipeline.capture.openfoam_flow import openfoam_cells
from pipeline.errors import StageError
from pipeline.geometry.triangles import area_vectors
from pipeline.nouns.arrays import Floats
from pipeline.nouns.mesh import FaceMesh
from tests.sample_meshes import duct


def written(path: Path, internal: Floats, patches: dict[str, Floats], binary: bool) -> None:
    """Write a field as OpenFOAM does."""
    kind = "vector" if internal.shape[1] == 3 else "scalar"

    def values(rows: Floats) -> bytes:
        head = f"nonuniform List<{kind}>\n{len(rows)}\n(".encode()
        if binary:
            return head + rows.astype("<f8").tobytes() + b")"
        text = " ".join(f"({' '.join(map(repr, row))})" if kind == "vector" else repr(row[0]) for row in rows.tolist())
        return head + text.encode() + b")"

    content = f"FoamFile\n{{\n    format {'binary' if binary else 'ascii'};\n    object {path.name};\n}}\n".encode()
    content += b"dimensions [0 1 -1 0 0 0 0];\ninternalField   " + values(internal) + b";\nboundaryField\n{\n"
    for name, rows in patches.items():
        content += (
            f"    {name}\n    {{\n        type calculated;\n        value ".encode() + values(rows) + b";\n    }\n"
        )
    path.write_bytes(content + b"}\n")


def solved(folder: Path, mesh: FaceMesh, binary: bool) -> None:
    """Write air at (0, 0, 2) everywhere."""
    time = folder / "120"
    time.mkdir(parents=True)
    (folder / "0").mkdir()
    flux = 2.0 * area_vectors(mesh.points, mesh.triangles())[:, 2:]
    inner = len(mesh.neighbour)
    written(time / "U", np.tile([0.0, 0.0, 2.0], (mesh.cells, 1)), {}, binary)
    by_patch = {patch.name: flux[patch.start : patch.start + patch.count] for patch in mesh.patches}
    written(time / "phi", flux[:inner], by_patch, binary)


@pytest.mark.parametrize("binary", [True, False])
def test_even_air_stays_even_away_from_the_walls_and_every_face_has_the_solvers_flux(
    tmp_path: Path, binary: bool
) -> None:
    mesh = duct((3, 3, 6), jitter=0.1).face_mesh()
    solved(tmp_path, mesh, binary)
    cells, _ = openfoam_cells(tmp_path, mesh, 0.0)
    # a cell whose vertices are all off the fiber's wall has the velocity that the solver has
    wall = next(patch for patch in mesh.patches if patch.name == "fibers")
    at_wall = np.unique(mesh.triangles()[wall.start : wall.start + wall.count])
    free = np.flatnonzero(~np.isin(cells.nodes[:, :4], at_wall).any(axis=1))
    assert len(free) > 10
    for cell in free[:10].tolist():
        x, y, z = cells.position[cells.nodes[cell, :4]].mean(axis=0).tolist()
        assert velocity_in(x, y, z, cell, cells) == pytest.approx([0.0, 0.0, 2.0], abs=1e-9)


def test_a_run_without_a_solution_or_with_that_of_another_mesh_is_told(tmp_path: Path) -> None:
    mesh, other = duct((2, 2, 4)).face_mesh(), duct((2, 2, 6)).face_mesh()
    (tmp_path / "empty").mkdir()
    with pytest.raises(StageError, match="holds no solution"):
        openfoam_cells(tmp_path / "empty", mesh, 0.0)
    solved(tmp_path / "run", mesh, binary=True)
    with pytest.raises(StageError, match=r"values where the mesh has"):
        openfoam_cells(tmp_path / "run", other, 0.0)
