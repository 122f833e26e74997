"""What cells are called, and in which unit they are told."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import meshio
import numpy as np
import pytest

from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.read import read_mesh
from pipeline.geometry.cells import cell_faces, polygons_of
from pipeline.nouns.arrays import Floats
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.quality.kinds import cells_by_kind, kinds_in_words
from tests.openfoam import AIR, foam
from tests.sample_meshes import cylinder, duct

CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)


def one_of_each(folder: Path) -> FaceMesh:
    """Make two cubes, a prism, a pyramid and a tetrahedron that share nothing."""
    corners: dict[str, tuple[int, ...]] = {
        "hexahedron": (0, 1, 2, 3, 4, 5, 6, 7),
        "wedge": (0, 1, 3, 4, 5, 7),
        "pyramid": (0, 1, 2, 3, 4),
        "tetra": (0, 1, 3, 4),
    }
    points: list[Floats] = []
    blocks = []
    for number, kind in enumerate(("hexahedron", "hexahedron", "wedge", "pyramid", "tetra")):
        start = sum(map(len, points))
        points.append(CUBE[list(corners[kind])] + [2.0 * number, 0, 0])
        blocks.append((kind, np.arange(start, start + len(points[-1]))[None]))
    meshio.write(folder / "each.vtu", meshio.Mesh(np.concatenate(points), blocks))
    return read_mesh(folder / "each.vtu")


def test_each_kind_is_counted_as_what_it_is(tmp_path: Path) -> None:
    mesh = one_of_each(tmp_path)
    assert cells_by_kind(mesh) == {"tetrahedra": 1, "pyramids": 1, "prisms": 1, "hexahedra": 2}
    assert kinds_in_words(mesh) == "2 hexahedra, 1 tetrahedron, 1 pyramid and 1 prism"


def test_tetrahedra_and_hexahedra_are_told_in_a_word() -> None:
    assert kinds_in_words(duct((2, 2, 2), hole=False).face_mesh()) == "48 tetrahedra"
    mesh = cylinder(0.1, 1e-6, around=4, outward=3, turns=1)
    assert kinds_in_words(mesh) == f"{mesh.cells:,} hexahedra"


def test_a_cube_beside_four_small_ones_is_a_polyhedron() -> None:
    mesh = beside_smaller()
    assert cells_by_kind(mesh) == {"hexahedra": 4, "polyhedra": 1}
    assert kinds_in_words(mesh) == "4 hexahedra and 1 polyhedron with 9 faces"


def beside_smaller() -> FaceMesh:
    """Make a cube whose side toward +x is divided among four cubes of half its size."""
    half = np.stack(np.meshgrid([1, 1.5], [0, 0.5, 1], [0, 0.5, 1], indexing="ij"), axis=-1).reshape(-1, 3)
    points, index = np.unique(np.concatenate([CUBE, half]), axis=0, return_inverse=True)
    large, small = index.ravel()[:8], index.ravel()[8:].reshape(2, 3, 3)
    cubes = [
        [small[i, j, k] for i, j, k in ((0, y, z), (1, y, z), (1, y + 1, z), (0, y + 1, z),
         (0, y, z + 1), (1, y, z + 1), (1, y + 1, z + 1), (0, y + 1, z + 1))]
        for y in (0, 1) for z in (0, 1)
    ]  # fmt: skip
    around = polygons_of("hexahedron", large[None])
    kept = around[~np.isclose(points[around][:, :, 0], 1).all(axis=1)]
    theirs = polygons_of("hexahedron", np.array(cubes))
    toward = theirs[np.isclose(points[theirs][:, :, 0], 1).all(axis=1)][:, ::-1]
    found = cell_faces(np.concatenate([kept, toward, theirs]), np.repeat(np.arange(5), [9, 6, 6, 6, 6]))
    start, faces = len(found.neighbour), len(found.owner)
    return FaceMesh(
        points, found.polygons.ravel(), np.arange(0, 4 * len(found.owner) + 1, 4), found.owner, found.neighbour, 5,
        (Patch("inlet", start, 1), Patch("outlet", start + 1, faces - start - 1)),
    )  # fmt: skip


@pytest.mark.openfoam
def test_checkmesh_sees_the_same_kinds(tmp_path: Path) -> None:
    write_openfoam(beside_smaller(), tmp_path, AIR)
    text = foam(tmp_path, "checkMesh")
    assert "hexahedra:     4" in text
    assert "polyhedra:     1" in text
