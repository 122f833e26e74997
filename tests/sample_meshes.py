"""Tetrahedral meshes of shapes with closed-form answers, for tests of what comes after the mesher."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.adjacency import corners_of, neighbors
from pipeline.geometry.box import Box
from pipeline.geometry.cells import cell_faces, polygons_of, rows_of
from pipeline.geometry.faces import compacted, tet_faces
from pipeline.geometry.tets import FACES, volumes
from pipeline.geometry.triangles import Ints
from pipeline.nouns.arrays import Floats
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.nouns.patches import FIBERS, PATCHES
from validation.closed_flows import brick_tets

NO_PIECES = Pieces(np.empty((0, 3)), np.empty((0, 3)), np.empty(0, np.int64), np.empty((0, 2), bool))
"""Of a shape that no fiber made."""


@dataclass(frozen=True, eq=False, slots=True)
class TetMesh:
    """Tetrahedra whose boundary triangles name their patch."""

    points: Floats
    tets: Ints
    faces: Ints
    patch: Ints
    patches: tuple[str, ...]
    slab: Box

    def face_mesh(self) -> FaceMesh:
        """Give the mesh as faces between cells; points that no tetrahedron uses are dropped."""
        points, tets = compacted(self.points, self.tets)
        across = neighbors(self.tets)
        cell, side = np.nonzero(across < 0)
        across[cell, side] = -1 - self.patch[rows_of(corners_of(self.tets, cell, side), self.faces)]
        return FaceMesh.of_triangles(points, tet_faces(tets, across), self.patches)


def boundary_of(tets: Ints) -> Ints:
    """Faces that belong to one tetrahedron only, found by counting."""
    triangles = tets[:, FACES].reshape(-1, 3)
    _, index, count = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True, return_counts=True)
    once: Ints = triangles[index[count == 1]]
    return once


def duct(
    cells: tuple[int, int, int] = (4, 4, 8),
    size: tuple[float, float, float] = (1.0, 1.0, 2.0),
    hole: bool = True,
    jitter: float = 0.0,
    seed: int = 1,
) -> TetMesh:
    """Make a duct along z in tetrahedra, with a square bar of "fiber" across it along x.

    Inner points are moved by up to `jitter` of the spacing, which makes the mesh non-orthogonal.
    """
    axes = [np.linspace(0, length, n + 1) for length, n in zip(size, cells, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    tets = brick_tets(cells)
    spacing = np.array(size) / cells
    if hole:
        middle = points[tets].mean(axis=1)
        bar = np.abs(middle[:, 1:] - 0.5 * np.array(size)[1:]) < spacing[1:]
        tets = tets[~bar.all(axis=1)]
    faces = boundary_of(tets)
    patch = np.full(len(faces), PATCHES.index(FIBERS))
    for name, axis, value in (
        ("inlet", 2, 0.0), ("outlet", 2, size[2]), ("xmin", 0, 0.0), ("xmax", 0, size[0]),
        ("ymin", 1, 0.0), ("ymax", 1, size[1]),
    ):  # fmt: skip
        patch[(points[faces][:, :, axis] == value).all(axis=1)] = PATCHES.index(name)
    inner = np.ones(len(points), bool)
    inner[np.unique(faces)] = False
    points[inner] += jitter * spacing * np.random.default_rng(seed).uniform(-1, 1, (int(inner.sum()), 3))
    # a jitter this large could turn a tetrahedron inside out
    assert (volumes(points, tets) > 0).all()
    patches = PATCHES if hole else PATCHES[:-1]
    return TetMesh(points, tets, faces, patch, patches, Box((0.0, 0.0, 0.25 * size[2]), (*size[:2], 0.75 * size[2])))


def cylinder(solidity: float, radius: float, around: int = 12, outward: int = 12, turns: float = 2.0) -> FaceMesh:
    """Make one cell of a square array of cylinders in hexahedra, with `turns` cells of plenum before and behind it.

    The cylinder runs along x, the flow along z; `around` cells lie on each side of the square cell around it.
    """
    side = radius * np.sqrt(np.pi / solidity)
    edge = np.linspace(-0.5, 0.5, around + 1)[:-1]
    ones = np.full(around, 0.5)
    square = side * np.concatenate(
        [np.column_stack(c) for c in ((edge, -ones), (ones, edge), (-edge, ones), (-ones, -edge))]
    )
    circle = radius * square / np.linalg.norm(square, axis=1)[:, None]
    # the circle's polygon gets the circle's area, or coarse meshes would have thin cylinders
    nxt = np.roll(circle, -1, axis=0)
    polygon = 0.5 * abs((circle[:, 0] * nxt[:, 1] - circle[:, 1] * nxt[:, 0]).sum())
    circle *= np.sqrt(np.pi * radius**2 / polygon)
    growth = 1.12 ** np.arange(outward)
    share = np.concatenate([[0], np.cumsum(growth)]) / growth.sum()
    ring = (circle + share[:, None, None] * (square - circle)).reshape(-1, 2)
    n, k = 4 * around, np.arange(4 * around)
    quads = [np.column_stack([n * j + k, n * (j + 1) + k, n * (j + 1) + (k + 1) % n, n * j + (k + 1) % n])
             for j in range(outward)]  # fmt: skip
    y = np.linspace(-0.5, 0.5, around + 1) * side
    length = round(turns * around)
    points, count = [ring], len(ring)
    for low in (-0.5 - turns, 0.5):
        z = side * (low + turns * np.linspace(0, 1, length + 1))
        points.append(np.stack(np.meshgrid(y, z, indexing="ij"), axis=-1).reshape(-1, 2))
        a = count + (np.arange(around)[:, None] * (length + 1) + np.arange(length)).ravel()
        quads.append(np.column_stack([a, a + length + 1, a + length + 2, a + 1]))
        count += len(points[-1])
    flat, index = np.unique(np.round(np.concatenate(points) / side, 9), axis=0, return_inverse=True)
    corners = index.ravel()[np.concatenate(quads)]
    layer = len(flat)
    depth = side / around
    nodes = np.concatenate([np.column_stack([np.full(layer, x), flat * side]) for x in (0.0, depth)])
    # y, z counterclockwise seen from +x: the lower layer's quad looks toward the upper
    cells = np.concatenate([corners, corners + layer], axis=1)
    return _named(nodes, cells, {
        "inlet": (2, nodes[:, 2].min()), "outlet": (2, nodes[:, 2].max()), "xmin": (0, 0.0), "xmax": (0, depth),
        "ymin": (1, nodes[:, 1].min()), "ymax": (1, nodes[:, 1].max()),
    })  # fmt: skip


def _named(points: Floats, cells: Ints, planes: dict[str, tuple[int, float]]) -> FaceMesh:
    """Put hexahedra into solver order; faces on no plane are the fibers."""
    found = cell_faces(polygons_of("hexahedron", cells), np.repeat(np.arange(len(cells)), 6))
    internal = len(found.neighbour)
    patch = np.full(len(found.owner) - internal, len(planes))
    for number, (axis, value) in enumerate(planes.values()):
        patch[(points[found.polygons[internal:]][:, :, axis] == value).all(axis=1)] = number
    order = np.concatenate([np.arange(internal), internal + np.argsort(patch, kind="stable")])
    counts = np.bincount(patch, minlength=len(planes) + 1)
    starts = internal + np.cumsum(counts) - counts
    return FaceMesh(
        points=points,
        corners=found.polygons[order].ravel(),
        offsets=np.arange(0, 4 * len(order) + 1, 4),
        owner=found.owner[order],
        neighbour=found.neighbour,
        cells=len(cells),
        patches=tuple(
            Patch(name, int(start), int(size))
            for name, start, size in zip((*planes, FIBERS), starts, counts, strict=True)
        ),
    )
