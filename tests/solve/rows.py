"""Rows of cylinders across a duct in tetrahedra, whose walls are straight facets and whose drags are known."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.box import Box
from pipeline.geometry.tets import volumes
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.patches import FIBERS, PATCHES
from tests.sample_meshes import TetMesh, boundary_of


def rows(
    solidity: float = 0.1,
    count: int = 1,
    around: int = 6,
    outward: int = 6,
    plenum: float = 1.5,
    radius: float = 0.5e-6,
) -> tuple[TetMesh, FluidDomain]:
    """Lay rows of cylinders along x in a duct along z, a pitch apart, with `plenum` pitches before and behind.

    `around` cells lie on each side of the square about a cylinder, `outward` between it and the square.
    """
    flat, triangles, side = _plane(solidity, count, around, outward, plenum, radius)
    depth = side / around
    points = np.concatenate([np.column_stack([np.full(len(flat), x), flat]) for x in (0.0, depth)])
    tets = _prisms(triangles, len(flat))
    turned = volumes(points, tets) < 0
    tets[turned] = tets[turned][:, [0, 2, 1, 3]]
    faces = boundary_of(tets)
    lower, upper = points.min(axis=0), points.max(axis=0)
    patch = np.full(len(faces), PATCHES.index(FIBERS))
    for name, at, value in (
        ("inlet", 2, lower[2]), ("outlet", 2, upper[2]), ("xmin", 0, lower[0]), ("xmax", 0, upper[0]),
        ("ymin", 1, lower[1]), ("ymax", 1, upper[1]),
    ):  # fmt: skip
        patch[np.isclose(points[faces][:, :, at], value, rtol=0, atol=1e-9 * side).all(axis=1)] = PATCHES.index(name)
    slab = Box((lower[0], lower[1], -0.5 * side), (upper[0], upper[1], (count - 0.5) * side))
    mesh = TetMesh(points, tets, faces, patch, PATCHES, slab)
    middles = np.column_stack([np.zeros(count), np.zeros(count), side * np.arange(count)])
    axis = np.array([1.0, 0.0, 0.0])
    pieces = Pieces(middles - depth * axis, middles + 2 * depth * axis, np.arange(count), np.ones((count, 2), bool))
    center = points[faces].mean(axis=1)
    nearest = np.clip(np.round(center[:, 2] / side), 0, count - 1).astype(np.int64)
    fiber = np.where(patch == PATCHES.index(FIBERS), nearest, -1)
    box = Box((*lower.tolist(),), (*upper.tolist(),))
    domain = FluidDomain(points, faces, patch, PATCHES, fiber, np.full(count, radius), box, slab, pieces)
    return mesh, domain


def _plane(
    solidity: float, count: int, around: int, outward: int, plenum: float, radius: float
) -> tuple[Floats, Ints, float]:
    side = radius * np.sqrt(np.pi / solidity)
    edge, ones = np.linspace(-0.5, 0.5, around + 1)[:-1], np.full(around, 0.5)
    square = side * np.concatenate(
        [np.column_stack(c) for c in ((edge, -ones), (ones, edge), (-edge, ones), (-ones, -edge))]
    )
    circle = radius * square / np.linalg.norm(square, axis=1)[:, None]
    growth = 1.2 ** np.arange(outward)
    share = np.concatenate([[0], np.cumsum(growth)]) / growth.sum()
    ring = (circle + share[:, None, None] * (square - circle)).reshape(-1, 2)
    n, k = 4 * around, np.arange(4 * around)
    ring_quads = np.concatenate(
        [
            np.column_stack([n * j + k, n * (j + 1) + k, n * (j + 1) + (k + 1) % n, n * j + (k + 1) % n])
            for j in range(outward)
        ]
    )
    points, quads, total = [], [], 0
    for row in range(count):
        points.append(ring + np.array([0.0, row * side]))
        quads.append(ring_quads + total)
        total += len(ring)
    y, length = np.linspace(-0.5, 0.5, around + 1) * side, round(plenum * around)
    for low in (-0.5 - plenum, count - 0.5):
        z = side * (low + plenum * np.linspace(0, 1, length + 1))
        points.append(np.stack(np.meshgrid(y, z, indexing="ij"), axis=-1).reshape(-1, 2))
        a = total + (np.arange(around)[:, None] * (length + 1) + np.arange(length)).ravel()
        quads.append(np.column_stack([a, a + length + 1, a + length + 2, a + 1]))
        total += len(points[-1])
    _, first, index = np.unique(
        np.round(np.concatenate(points) / side, 9), axis=0, return_index=True, return_inverse=True
    )
    corners = index.ravel()[np.concatenate(quads)]
    return np.concatenate(points)[first], np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]]), side


def _prisms(triangles: Ints, layer: int) -> Ints:
    """Three tetrahedra over each triangle; the diagonals of its sides start at the lower number, so neighbors fit."""
    a, b, c = np.sort(triangles, axis=1).T
    top_a, top_b, top_c = a + layer, b + layer, c + layer
    return np.concatenate(
        [np.column_stack(t) for t in ((a, b, c, top_c), (a, b, top_b, top_c), (a, top_a, top_b, top_c))]
    )
