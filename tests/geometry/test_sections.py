"""Sections of cells: as large as the plane within the mesh is, and each cell's as large as its shape says."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.sections import Section, section
from pipeline.nouns.arrays import Floats
from pipeline.nouns.mesh import FaceMesh
from tests.quality.test_kinds import beside_smaller
from tests.sample_meshes import cylinder, duct


def cut(mesh: FaceMesh, axis: int, place: float) -> Section:
    return section(mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, axis, place)


def areas(found: Section) -> Floats:
    a, b, c = (found.points[found.triangles[:, k]] for k in range(3))
    result: Floats = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return result


@pytest.mark.parametrize(("axis", "place", "area"), [(0, 0.3, 1.75), (1, 0.5001, 1.5), (2, 0.1, 1.0), (2, 1.0001, 0.5)])
def test_tetrahedra_fill_the_plane_but_for_the_bar(axis: int, place: float, area: float) -> None:
    # a duct of 1 x 1 x 2 whose bar along x is 1/2 x 1/2 of it
    found = cut(duct((4, 4, 8), jitter=0.2).face_mesh(), axis, place)
    assert areas(found).sum() == pytest.approx(area, rel=1e-9)
    assert (found.points[:, axis] == place).sum() >= len(found.points) - len(np.unique(found.cell))


def test_hexahedra_around_a_cylinder_fill_the_plane_but_for_its_circle() -> None:
    radius, solidity = 1e-6, 0.1
    mesh = cylinder(solidity, radius, around=8, outward=4, turns=1)
    depth = mesh.points[:, 0].max()
    side = radius * np.sqrt(np.pi / solidity)
    found = cut(mesh, 0, 0.4 * depth)
    assert areas(found).sum() == pytest.approx(3 * side**2 - np.pi * radius**2, rel=1e-9)
    assert len(np.unique(found.cell)) == mesh.cells


def test_a_cube_beside_smaller_ones_has_its_own_square() -> None:
    found = cut(beside_smaller(), 2, 0.3)
    size = np.bincount(found.cell, areas(found))
    # cells are numbered as they were made: the large one first; two of the small ones are met
    assert size[0] == pytest.approx(1.0, rel=1e-12)
    assert sorted(size[1:][size[1:] > 0]) == pytest.approx([0.25, 0.25], rel=1e-12)


def test_outlines_between_two_cells_stand_once() -> None:
    found = cut(duct((1, 1, 1), hole=False).face_mesh(), 2, 0.7)
    # six tetrahedra around the diagonal, each met in a triangle or a quadrangle
    assert len(found.outlines) < len(found.triangles)
    length = np.linalg.norm(np.diff(found.points[found.outlines], axis=1), axis=2).sum()
    doubled = np.linalg.norm(found.points[found.triangles[:, 0]] - found.points[found.triangles[:, 1]], axis=1).sum()
    # inner pieces count twice by cells, the outer ones, 4 in all, once
    assert 2 * length == pytest.approx(doubled + 4, rel=1e-9)


def test_a_plane_beside_the_mesh_meets_nothing() -> None:
    found = cut(duct((2, 2, 4)).face_mesh(), 0, 7.0)
    assert found.triangles.shape == (0, 3)
    assert found.outlines.shape == (0, 2)
