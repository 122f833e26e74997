"""Tetrahedra of the unit cube as a mesh that improvements take, with a fiber wherever a test wants one."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.box import Box
from pipeline.geometry.fibers import FiberDistance
from pipeline.mesh.freedom import Freedom
from pipeline.mesh.working_mesh import WorkingMesh
from pipeline.nouns.arrays import Floats, Ints

CUBE = Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


def nearly_flat(place: float) -> FiberDistance:
    """A fiber so thick that its surface is the plane z = place within the unit cube, and lies above it."""
    radius = 1000.0
    start = np.array([[-10.0, 0.5, place + radius]])
    return FiberDistance.about(
        start, start + np.array([20.0, 0, 0]), np.array([radius]), np.zeros((1, 2), bool),
        np.zeros(1, np.int64), np.ones(1), np.zeros(3), np.ones(3),
    )  # fmt: skip


def freedom(off: float = 0.0, place: float = 300.0, box: Box = CUBE) -> Freedom:
    """Vertices of walls may move so far; the fiber lies above z = place."""
    return Freedom(box, False, nearly_flat(place), np.ones(1), off, 0.0)


def working(points: Floats, tets: Ints, free: Freedom | None = None) -> WorkingMesh:
    return WorkingMesh.of(points, tets, free or freedom())
