"""What changes some cells of a mesh tells their neighbors, and a part that was worked on alone fits the rest.

An edge on the interface of a part that was split on one side only left two walls within the air; they made the next
cells faulty, and the mesh doubled from pass to pass (the default case, seed 3).
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.adjacency import neighbors
from pipeline.geometry.tets import boundary, volumes
from pipeline.geometry.triangles import area_vectors
from pipeline.mesh.boundary import assign
from pipeline.mesh.improve.split import split_corners, split_longest
from pipeline.mesh.working_mesh import INTERFACE, WALL, WorkingMesh
from pipeline.nouns.arrays import Ints
from tests.mesh.boxes import kuhn_box
from tests.mesh.meshes import CUBE, working


def cube_and_part(seed: int) -> tuple[WorkingMesh, Ints]:
    """A cube in tetrahedra, and those within a ball somewhere in it, some at the cube's sides."""
    points, tets = kuhn_box(4)
    rng = np.random.default_rng(seed)
    distance = np.linalg.norm(points[tets].mean(axis=1) - rng.uniform(0.1, 0.9, 3), axis=1)
    return working(points, tets), np.flatnonzero(distance < rng.uniform(0.25, 0.45))


def consistent(mesh: WorkingMesh) -> None:
    """Every neighbor is the one that matching all faces anew finds, every patch that of the face's place."""
    found = neighbors(mesh.tets)
    np.testing.assert_array_equal(np.where(mesh.across < 0, -1, mesh.across), found)
    faces, patch = mesh.boundary()
    place = assign(mesh.points, faces, CUBE, 0.0)
    np.testing.assert_array_equal(patch, place)
    np.testing.assert_array_equal(mesh.planes, mesh.freedom.planes_at(mesh.points))


@pytest.mark.parametrize("seed", range(6))
def test_splits_and_losses_keep_the_neighbors(seed: int) -> None:
    mesh, _ = cube_and_part(seed)
    rng = np.random.default_rng(seed)
    for _ in range(3):
        mesh = split_longest(mesh, rng.random(mesh.cells) < 0.3)
        consistent(mesh)
        mesh = split_corners(mesh)
        consistent(mesh)
        mesh = mesh.without(rng.random(mesh.cells) < 0.05)
        consistent(mesh)
    assert (mesh.across == WALL).sum() > 0
    assert volumes(mesh.points, mesh.tets).min() > 0.0


@pytest.mark.parametrize("seed", range(12))
def test_a_part_that_was_split_leaves_no_wall_in_the_air(seed: int) -> None:
    mesh, cells = cube_and_part(seed)
    part = mesh.part(cells)
    rng = np.random.default_rng(seed)
    improved = split_corners(part.mesh)
    for _ in range(3):
        improved = split_corners(split_longest(improved, rng.random(improved.cells) < 0.5))
    assert improved.cells > 1.5 * len(cells)  # something was split
    whole, place = mesh.with_part(part, improved)
    consistent(whole)
    assert len(np.unique(place)) == improved.cells
    assert volumes(whole.points, whole.tets).min() > 0.0
    assert volumes(whole.points, whole.tets).sum() == pytest.approx(1.0, rel=1e-12)
    faces, _ = boundary(whole.tets)
    # the cube's own sides, and nothing else
    assert np.linalg.norm(area_vectors(whole.points, faces), axis=1).sum() == pytest.approx(6.0, rel=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_a_part_that_lost_cells_leaves_walls_where_they_were(seed: int) -> None:
    mesh, cells = cube_and_part(seed)
    part = mesh.part(cells)
    kept = volumes(mesh.points, mesh.tets).sum() - volumes(mesh.points, mesh.tets[cells]).sum()
    lost = np.random.default_rng(seed).random(len(cells)) < 0.4
    improved = part.mesh.without(lost)
    whole, _ = mesh.with_part(part, improved)
    assert (whole.across == INTERFACE).sum() == 0
    consistent(whole)
    left = volumes(improved.points, improved.tets).sum()
    assert volumes(whole.points, whole.tets).sum() == pytest.approx(kept + left, rel=1e-12)
