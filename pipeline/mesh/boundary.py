"""Find the patch of each boundary face, and make the duct's planes exactly flat again.

fTetWild knows no patches and leaves every vertex anywhere within its envelope, while OpenFOAM refuses a
symmetry plane whose faces tilt by more than 3e-8 rad.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.box import Box
from pipeline.geometry.triangles import area_vectors
from pipeline.nouns.arrays import Bools, Floats, Ints
from pipeline.nouns.patches import DUCT, FIBERS, LOWER, PATCHES, UPPER


@dataclass(frozen=True, slots=True)
class Plane:
    """One face of the duct: coordinate `axis` equals `value`, the outside lies on the side `sign`."""

    patch: int
    axis: int
    value: float
    sign: int


def planes(box: Box) -> tuple[Plane, ...]:
    """Give the six faces of the duct with the index of their patch."""
    ends = {LOWER: (box.lower, -1), UPPER: (box.upper, 1)}
    return tuple(
        Plane(number, patch.axis, ends[patch.end][0][patch.axis], ends[patch.end][1])
        for number, patch in enumerate(DUCT)
        if patch.axis is not None
    )


# A boundary face belongs to a plane when it faces the plane's way: cos 35 degrees tells a plane's own triangles,
# tilted by the envelope at most, from a fiber's wall that happens to lie within the envelope.
_FACING = 0.82


def assign(points: Floats, faces: Ints, box: Box, tolerance: float) -> Ints:
    """Find the patch of each boundary face by where it lies and which way it faces.

    Parameters
    ----------
    points : (n, 3) array [m]
    faces : (b, 3) int array
        Boundary triangles, outward.
    box : Box [m]
        The duct.
    tolerance : float [m]
        How far a vertex may lie from its plane.

    Returns
    -------
    (b,) int array
        Index into `pipeline.nouns.patches.PATCHES`.
    """
    patch = np.full(len(faces), PATCHES.index(FIBERS), dtype=np.int64)
    vectors = area_vectors(points, faces)
    areas = np.linalg.norm(vectors, axis=1)
    for plane in planes(box):
        near = _near(points, faces, plane, tolerance)
        facing = plane.sign * vectors[:, plane.axis] >= _FACING * areas
        patch[near & facing] = plane.patch
    return patch


def blunted_edges(points: Floats, faces: Ints, box: Box, tolerance: float) -> Ints:
    """Find the faces that cut off an edge of the duct, and the plane that each belongs to.

    A mesher that keeps a surface within an envelope may join points beside an edge of the duct by a face across it,
    which faces neither plane's way and would count as a fiber's wall. All faces across one edge go to the same plane,
    so that what joins them ends on the edge.

    Parameters
    ----------
    points : (n, 3) array [m]
    faces : (b, 3) int array
        Boundary triangles.
    box : Box [m]
        The duct.
    tolerance : float [m]
        How far a vertex may lie from both planes.

    Returns
    -------
    (b,) int array
        Index into `pipeline.nouns.patches.PATCHES`, -1 where a face cuts off no edge.
    """
    found = np.full(len(faces), -1, dtype=np.int64)
    near_planes = np.zeros(len(faces), dtype=np.int64)
    for plane in planes(box):
        near = _near(points, faces, plane, tolerance)
        found[near & (found < 0)] = plane.patch
        near_planes += near
    return np.where(near_planes > 1, found, -1)


def flattened(points: Floats, faces: Ints, patch: Ints, box: Box) -> Floats:
    """Give the points with every vertex of a plane's face exactly on that plane, and none outside the duct.

    Parameters
    ----------
    points : (n, 3) array [m]
    faces : (b, 3) int array
    patch : (b,) int array
        As `assign` gives it.
    box : Box [m]

    Returns
    -------
    (n, 3) array [m]
    """
    flat = np.clip(points, box.lower, box.upper)
    for plane in planes(box):
        flat[np.unique(faces[patch == plane.patch]), plane.axis] = plane.value
    return flat


def _near(points: Floats, faces: Ints, plane: Plane, tolerance: float) -> Bools:
    """Tell which faces lie near a plane with every vertex, (b,) array."""
    return np.asarray((np.abs(points[:, plane.axis] - plane.value) <= tolerance)[faces].all(axis=1))


def free_axes(points: Floats, box: Box, cyclic: bool = False) -> Floats:
    """Tell along which axes each point may move without leaving the duct's planes: (n, 3) array of 0 and 1.

    On cyclic sides none may move at all: the two sides would no longer fit each other.
    """
    free = np.ones_like(points)
    for plane in planes(box):
        there = points[:, plane.axis] == plane.value
        free[there, plane.axis] = 0.0
        if cyclic and plane.axis < 2:
            free[there] = 0.0
    return free
