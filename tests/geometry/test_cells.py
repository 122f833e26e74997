# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.geometry.cells import KINDS, cell_faces, matched_pairs, polygons_of, rows_of
from pipeline.geometry.polyhedra import polyhedra
from pipeline.geometry.triangles import Floats

UNIT = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0]])


def _prism(sides: int) -> Floats:
    """Corners of a prism of height 1 on a regular polygon in the unit circle, of area n / 2 sin(2 pi / n)."""
    angle = 2 * np.pi * np.arange(sides) / sides
    return np.array([[np.cos(a), np.sin(a), z] for z in (0.0, 1.0) for a in angle])


SHAPES: dict[str, tuple[Floats, float]] = {
    "tetra": (UNIT[[0, 1, 3, 4]], 1 / 6),
    "pyramid": (UNIT[:5], 1 / 3),
    "wedge": (UNIT[[0, 1, 3, 4, 5, 7]], 1 / 2),
    "hexahedron": (UNIT, 1.0),
    "pentagonal prism": (_prism(5), 5 / 2 * np.sin(2 * np.pi / 5)),
    "hexagonal prism": (_prism(6), 6 / 2 * np.sin(2 * np.pi / 6)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_cell_of_the_usual_numbering_has_its_volume_and_is_closed(kind: str) -> None:
    points, volume = SHAPES[kind]
    found = cell_faces(polygons_of(kind, np.arange(len(points))[None]), np.zeros(len(KINDS[kind]), np.int64))
    corners, sizes = found.polygons[found.polygons >= 0], (found.polygons >= 0).sum(axis=1)
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    shape = polyhedra(points, corners, offsets, found.owner, found.neighbour, 1)
    assert shape.volumes[0] == pytest.approx(volume, rel=1e-14)
    assert shape.areas.sum(axis=0) == pytest.approx([0, 0, 0], abs=1e-15)


def test_neighbours_share_one_face_that_looks_from_the_lower_cell_to_the_higher() -> None:
    # a tetrahedron under the diagonal of another's face, given in the wrong order
    tets = np.array([[1, 3, 2, 4], [0, 1, 2, 3]])
    found = cell_faces(polygons_of("tetra", tets), np.repeat([0, 1], 4))
    assert found.neighbour.tolist() == [1]
    assert sorted(found.polygons[0].tolist()) == [1, 2, 3]
    assert len(found.owner) == 7


def test_a_cell_with_the_same_face_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="1 cells have the same face twice"):
        cell_faces(np.array([[0, 1, 2], [2, 1, 0]]), np.array([0, 0]))


def test_three_cells_on_one_face_are_refused() -> None:
    with pytest.raises(ValueError, match="1 faces belong to more than two"):
        matched_pairs(np.array([[0, 1, 2], [2, 1, 0], [1, 2, 0]]))


def test_polygons_of_other_sizes_do_not_match() -> None:
    assert rows_of(np.array([[1, 2, 3, -1]]), np.array([[1, 2, 3, 4]])).tolist() == [-1]
