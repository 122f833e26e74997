# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.faces import compacted, tet_faces
from tests.sample_meshes import duct


def test_every_tetrahedron_has_four_faces_and_euler_holds() -> None:
    mesh = duct(hole=False)
    faces = mesh.face_mesh()
    assert 2 * faces.internal + (faces.faces - faces.internal) == 4 * len(mesh.tets)
    # a ball: points - edges + faces - cells = 1
    corners = faces.corners.reshape(-1, 3)
    edges = np.unique(np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    assert len(faces.points) - len(edges) + faces.faces - faces.cells == 1


def test_each_cell_is_closed_by_its_face_vectors() -> None:
    faces = duct(jitter=0.2).face_mesh()
    shape = faces.polyhedra()
    total = np.zeros((faces.cells, 3))
    np.add.at(total, faces.owner, shape.areas)
    np.add.at(total, faces.neighbour, -shape.areas[: faces.internal])
    # rounding of areas of about 1/32
    assert np.abs(total).max() < 1e-16
    # the bar takes 2 x 2 of the 4 x 8 columns of the plan
    assert shape.volumes.sum() == pytest.approx(2.0 * (1 - 4 / 32), rel=1e-13)
    assert shape.volumes.min() > 0


def test_faces_stand_in_solver_order() -> None:
    faces = duct(jitter=0.2).face_mesh()
    inner = np.stack([faces.owner[: faces.internal], faces.neighbour], axis=1)
    assert (np.lexsort((inner[:, 1], inner[:, 0])) == np.arange(faces.internal)).all()
    assert (inner[:, 0] < inner[:, 1]).all()
    for patch in faces.patches:
        owners = faces.owner[patch.start : patch.start + patch.count]
        assert (np.diff(owners) >= 0).all()


def test_patches_keep_their_areas() -> None:
    faces = duct().face_mesh()
    areas = faces.polyhedra().areas
    total = {p.name: areas[p.start : p.start + p.count].sum(axis=0) for p in faces.patches}
    # a patch's summed area vector is its plane's: outward, as large as the plane less the bar's cut
    assert total["inlet"] == pytest.approx([0, 0, -1], abs=1e-14)
    assert total["outlet"] == pytest.approx([0, 0, 1], abs=1e-14)
    assert total["ymax"] == pytest.approx([0, 2, 0], abs=1e-14)
    assert total["xmin"] == pytest.approx([-2 * (1 - 4 / 32), 0, 0], abs=1e-14)
    assert total["fibers"] == pytest.approx([0, 0, 0], abs=1e-14)


def test_renumbering_narrows_the_band() -> None:
    mesh = duct((6, 6, 12), jitter=0.1)
    shuffled = mesh.tets[np.random.default_rng(0).permutation(len(mesh.tets))]
    found = tet_faces(shuffled)
    band = int((found.neighbour - found.owner[: len(found.neighbour)]).max())
    # a layer across a 6 x 6 duct has 216 tetrahedra; a level of the ordering is about as large
    assert band < 2 * 216
    assert sorted(found.order.tolist()) == list(range(len(shuffled)))


def test_the_renumbered_cells_are_the_tetrahedra() -> None:
    mesh = duct(jitter=0.2)
    found = tet_faces(mesh.tets)
    vertices: list[set[int]] = [set() for _ in mesh.tets]
    for triangle, cell in zip(found.triangles.tolist(), found.owner.tolist(), strict=True):
        vertices[cell].update(triangle)
    for triangle, cell in zip(found.triangles.tolist(), found.neighbour.tolist(), strict=False):
        vertices[cell].update(triangle)
    assert vertices == [set(tet) for tet in mesh.tets[found.order].tolist()]


def test_three_tetrahedra_on_one_face_are_refused() -> None:
    with pytest.raises(ValueError, match="1 faces belong to more than two cells"):
        tet_faces(np.array([[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]))


def test_unused_points_are_dropped() -> None:
    points, corners = compacted(np.arange(15.0).reshape(5, 3), np.array([[4, 0, 2]]))
    assert points[:, 0].tolist() == [0, 6, 12]
    assert corners.tolist() == [[2, 0, 1]]
