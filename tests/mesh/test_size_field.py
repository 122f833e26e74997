"""The edge length wanted at each place: shortest at the fibers, each by its own diameter."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest
from scipy.spatial import Delaunay

from pipeline.geometry.tets import volumes
from pipeline.mesh.engines.ftetwild.size_field import size_field, wanted
from pipeline.nouns.arrays import Floats

LOWER, UPPER = np.zeros(3), np.array([6.0, 6.0, 8.0])


def fiber(x: float, z: float, diameter: float) -> Floats:
    """Points on a cylinder along y, rings of ten every 0.6 diameters."""
    along = np.arange(LOWER[1], UPPER[1], 0.6 * diameter)
    angle = np.arange(10) * 2 * np.pi / 10
    ring = 0.5 * diameter * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=1) + np.array([x, 0, z])
    return np.concatenate([ring + np.array([0, y, 0]) for y in along])


THICK, THIN = fiber(2.0, 4.0, 1.2), fiber(4.5, 4.0, 0.2)
POINTS = np.concatenate([THICK, THIN])
DIAMETER = np.repeat([1.2, 0.2], [len(THICK), len(THIN)])


def test_every_fiber_gets_edges_by_its_own_diameter() -> None:
    found = wanted(POINTS, POINTS, DIAMETER, 0.6, 1.0, 3.0)
    assert found[: len(THICK)] == pytest.approx(0.72)
    assert found[len(THICK) :] == pytest.approx(0.12)


def test_edges_grow_with_the_distance_up_to_the_longest() -> None:
    surface = np.array([[2.0, y, z] for y in (1.0, 3.0, 5.0) for z in np.arange(4.6, 8.0, 0.1)])
    found = wanted(surface, THICK, DIAMETER[: len(THICK)], 0.5, 0.5, 1.5)
    # half a diameter is taken off, since the nearest point of the fiber is nearer than its nearest vertex
    distance = surface[:, 2] - 4.6
    assert (found <= np.minimum(1.5, 0.6 + 0.5 * distance) + 1e-12).all()
    assert (found >= np.minimum(1.5, 0.6 + 0.5 * (distance - 0.6)) - 1e-12).all()
    assert wanted(surface, THICK, DIAMETER[: len(THICK)], 0.5, 0.0, 1.5) == pytest.approx(0.6)


@pytest.mark.parametrize("growth", [0.0, 1.0])
def test_the_background_mesh_fills_the_duct_and_holds_what_is_wanted_at_each_fiber(growth: float) -> None:
    field = size_field(LOWER, UPPER, POINTS, DIAMETER, 0.6, growth, 3.0)
    nodes, tets, values = field["bg_vertices"], field["bg_tets"], field["bg_values"]
    size = volumes(nodes, tets.astype(np.int64))
    assert (size > 0).all()
    # less the tetrahedra without volume that rows of nodes on the duct's planes leave
    assert size.sum() == pytest.approx(np.prod(UPPER - LOWER), rel=1e-6)
    # interpolated as the mesher does it, at every point of the thin fiber, which is thinner than the nodes' spacing
    mesh = Delaunay(nodes)
    inside = mesh.find_simplex(THIN)
    weight = np.einsum("kij,kj->ki", mesh.transform[inside, :3], THIN - mesh.transform[inside, 3])
    weight = np.column_stack([weight, 1 - weight.sum(axis=1)])
    found = (weight * values[mesh.simplices[inside]]).sum(axis=1)
    assert found.max() < 0.121 + 0.2 * growth


def test_the_field_of_a_wide_duct_stays_small() -> None:
    wide = size_field(np.zeros(3), np.full(3, 200.0), POINTS + 90.0, DIAMETER, 0.6, 1.0, 3.0)
    assert len(wide["bg_values"]) < 30_000
