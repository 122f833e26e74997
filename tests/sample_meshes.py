"""Tetrahedral meshes of shapes with closed-form answers, for tests of what comes after the mesher."""

import itertools

import numpy as np

from pipeline.data import FIBERS, PATCHES, TetMesh
from pipeline.geometry.box import Box
from pipeline.geometry.tets import FACES, volumes
from pipeline.geometry.triangles import Ints


def boundary_of(tets: Ints) -> Ints:
    """Faces that belong to one tetrahedron only, found by counting."""
    triangles = tets[:, FACES].reshape(-1, 3)
    _, index, count = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True, return_counts=True)
    once: Ints = triangles[index[count == 1]]
    return once


def kuhn_tets(cells: tuple[int, int, int]) -> Ints:
    """Six positive tetrahedra in each cube of a grid of points in C order."""
    shape = tuple(n + 1 for n in cells)
    corner = np.stack(np.meshgrid(*(np.arange(n) for n in cells), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    result = []
    for axes in itertools.permutations(range(3)):
        path = np.zeros((4, 3), np.int64)
        for step, axis in enumerate(axes):
            path[step + 1 :, axis] += 1
        if np.linalg.det(path[1:].astype(float)) < 0:
            path = path[[0, 1, 3, 2]]
        result.append(np.ravel_multi_index(np.moveaxis(corner + path, -1, 0), shape))
    return np.concatenate(result)


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
    tets = kuhn_tets(cells)
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
