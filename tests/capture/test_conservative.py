"""A velocity that lost air loses none after the correction: by Gauss' law, cell by cell and face by face."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.capture.cells import Cells, velocity_in
from pipeline.capture.conservative import conserved
from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats
from tests.capture.test_cells import quadratic
from validation.closed_flows import brick, sampled

_PLACES = np.array([[1 / 6, 1 / 6], [2 / 3, 1 / 6], [1 / 6, 2 / 3]])  # exact for quadratics on a triangle


def leaky(places: Floats) -> Floats:
    """Give a velocity with divergence, which enters and leaves through z only."""
    x, y, z = places.T
    bubble = x * (1 - x) * y * (1 - y)
    return np.stack([bubble * (1 + z), 0.3 * bubble * z * z, 1 + 0.2 * np.sin(3 * z) * x], axis=1)


def flux_through(triangle: Floats, cell: int, cells: Cells) -> float:
    """Integrate the velocity that a cell gives over a triangle."""
    a, b, c = triangle
    area = 0.5 * np.cross(b - a, c - a)
    places = (a + s * (b - a) + t * (c - a) for s, t in _PLACES)
    found = [velocity_in(float(x), float(y), float(z), cell, cells) for x, y, z in places]
    return float(np.mean(found, axis=0) @ area)


def test_no_cell_keeps_air_and_both_sides_of_a_face_agree_point_by_point() -> None:
    cells = sampled(*brick(np.zeros(3), np.ones(3), (2, 2, 3)), leaky)
    rng = np.random.default_rng(1)
    for cell in rng.integers(0, len(cells.nodes), 25):
        corners = cells.position[cells.nodes[cell, :4]]
        # a smaller copy within the cell: the law holds there too, since no place has divergence
        inner = corners.mean(axis=0) + 0.6 * (corners - corners.mean(axis=0))
        faces = [inner[[0, 2, 1]], inner[[0, 1, 3]], inner[[0, 3, 2]], inner[[1, 2, 3]]]
        out = [flux_through(face, int(cell), cells) for face in faces]
        assert sum(out) == pytest.approx(0.0, abs=1e-9 * max(map(abs, out)) + 1e-12)
        for face in range(4):
            other = cells.neighbor[cell, face]
            if other < 0:
                continue
            triangle = np.delete(corners, face, axis=0)
            normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
            x, y, z = (rng.dirichlet(np.ones(3)) @ triangle).tolist()
            one, two = (np.dot(np.array(velocity_in(x, y, z, int(k), cells)), normal) for k in (cell, other))
            assert one == pytest.approx(two, abs=1e-8 * float(np.linalg.norm(normal)))


def test_a_wall_that_leaks_is_closed_and_the_outlet_takes_its_air() -> None:
    points, tets = brick(np.zeros(3), np.ones(3), (2, 2, 2))
    cells = sampled(points, tets, leaky)
    corners = cells.position[cells.nodes[:, :4]]
    low, high = (corners[:, :, 2] == z for z in (0.0, 1.0))
    # the faces against each vertex whose three corners lie there
    wall, opening = ((on.sum(axis=1, keepdims=True) - on == 3) & (cells.neighbor < 0) for on in (low, high))
    found = conserved(cells.nodes, cells.position, leaky(cells.position), cells.neighbor, opening, wall)
    again = conserved(cells.nodes, cells.position, leaky(cells.position), cells.neighbor, opening, np.zeros_like(wall))
    # no air comes in any more: what goes out is the bubble's nothing
    speed = [np.abs(each.flux[..., 2]).max() for each in (found, again)]
    assert speed[0] < 0.5 * speed[1]


def test_a_velocity_without_divergence_stays_as_it_is() -> None:
    points, tets = brick(np.zeros(3), np.ones(3), (2, 1, 2))
    cells = sampled(points, tets, quadratic)
    velocity = quadratic(cells.position)
    no_face = np.zeros(cells.neighbor.shape, bool)
    found = conserved(cells.nodes, cells.position, velocity, cells.neighbor, no_face, no_face)
    assert found.changed < 1e-12


def test_air_that_nothing_takes_is_an_error() -> None:
    points, tets = brick(np.zeros(3), np.ones(3), (1, 1, 1))
    cells = sampled(points, tets, quadratic)
    closed = np.zeros(cells.neighbor.shape, bool)
    with pytest.raises(StageError, match="no opening takes it"):
        conserved(cells.nodes, cells.position, leaky(cells.position), cells.neighbor, closed, closed)
