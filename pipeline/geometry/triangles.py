"""Closed triangle surfaces: areas, volume, and whether they are closed."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from pipeline.geometry.parts import parts

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def area_vectors(points: Floats, triangles: Ints) -> Floats:
    """Half the cross product of two edges, so that the length is the area.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array

    Returns
    -------
    (m, 3) array [m2]
        Outward where the triangle is counterclockwise seen from outside.
    """
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return 0.5 * np.cross(b - a, c - a)


def on_sides(points: Floats, triangles: Ints, lower: Sequence[float], upper: Sequence[float]) -> npt.NDArray[np.bool_]:
    """Tell which triangles lie flat on a side of a box, across x or y, as a cut there leaves them.

    Parameters
    ----------
    points : (n, 3) array
    triangles : (m, 3) int array
    lower, upper : sequences of floats
        Corners of the box.

    Returns
    -------
    (m,) bool array
    """
    corners = points[triangles]
    found = np.zeros(len(triangles), dtype=bool)
    for axis in (0, 1):
        for place in (lower[axis], upper[axis]):
            found |= (corners[:, :, axis] == place).all(axis=1)
    return found


def enclosed_volume(points: Floats, triangles: Ints) -> float:
    """Volume inside a closed outward surface, by the divergence theorem.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array

    Returns
    -------
    float [m3]
        Negative where the surface is inside out.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> round(6 * enclosed_volume(corners, faces), 12)
    1.0
    """
    return float(signed_volumes(points, triangles).sum())


def signed_volumes(points: Floats, triangles: Ints) -> Floats:
    """Each triangle's share of the enclosed volume: summed over any closed part, the volume inside that part.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array

    Returns
    -------
    (m,) array [m3]
    """
    # measured from the middle of the surface: far from the origin the terms would cancel in rounding
    local = points - 0.5 * (points.min(axis=0) + points.max(axis=0))
    centers = local[triangles].mean(axis=1)
    shares: Floats = np.einsum("ij,ij->i", area_vectors(local, triangles), centers) / 3.0
    return shares


def unmatched_edges(triangles: Ints) -> int:
    """Count the directed edges whose opposite is missing or stands more than once.

    A surface is closed and consistently oriented exactly when this is 0 and no directed edge repeats.

    Parameters
    ----------
    triangles : (m, 3) int array

    Returns
    -------
    int
        0 for a closed, oriented 2-manifold along its edges.
    """
    start = triangles.ravel()
    end = triangles[:, [1, 2, 0]].ravel()
    count = int(triangles.max(initial=0)) + 1
    sorted_forward, sorted_backward = np.sort(start * count + end), np.sort(end * count + start)
    if np.array_equal(sorted_forward, sorted_backward) and (sorted_forward[1:] != sorted_forward[:-1]).all():
        return 0  # ten times faster than np.unique below, which hashes
    forward, repeats = np.unique(sorted_forward, return_counts=True)
    backward = np.unique(sorted_backward)
    missing = np.setdiff1d(forward, backward, assume_unique=True).size
    return int(missing + (repeats - 1).sum())


def winding_number(points: Floats, triangles: Ints, place: Floats) -> float:
    r"""How often a closed surface winds around a place: 1 inside, 0 outside.

    The solid angle of each triangle after van Oosterom and Strackee (1983, doi 10.1109/TBME.1983.325207, Eq. 8),
    :math:`\tan(\Omega/2) = a \cdot (b \times c) / (abc + (a \cdot b) c + (b \cdot c) a + (c \cdot a) b)`.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
    place : (3,) array [m]

    Returns
    -------
    float
        Negative inside a surface that is inside out.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> round(winding_number(corners, faces, np.full(3, 0.2)), 12)
    1.0
    """
    a, b, c = (points[triangles[:, k]] - place for k in range(3))
    x, y, z = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    dot = (np.einsum("ij,ij->i", one, other) for one, other in ((a, b), (b, c), (c, a)))
    over = x * y * z + sum(product * length for product, length in zip(dot, (z, x, y), strict=True))
    half_angle = np.arctan2(np.einsum("ij,ij->i", a, np.cross(b, c)), over)
    return float(half_angle.sum() / (2.0 * np.pi))


def connected_pieces(triangles: Ints) -> Ints:
    """Tell the parts of a surface that share no point from each other.

    Parameters
    ----------
    triangles : (m, 3) int array

    Returns
    -------
    (m,) int array
        Number of the part that each triangle belongs to, from 0.

    Examples
    --------
    >>> connected_pieces(np.array([[0, 1, 2], [3, 4, 5], [2, 1, 6]])).tolist()
    [0, 1, 0]
    """
    names, corner = np.unique(triangles, return_inverse=True)
    corner = corner.reshape(triangles.shape)
    ends = corner[:, [0, 1, 1, 2]].reshape(-1, 2)
    return parts(ends[:, 0], ends[:, 1], len(names))[1][corner[:, 0]]


def vertex_sums(triangles: Ints, vectors: Floats, vertices: int) -> Floats:
    """Sum over the triangles at each vertex: of area vectors, the direction of the normal.

    Parameters
    ----------
    triangles : (m, 3) int array
    vectors : (m, 3) array
        One per triangle.
    vertices : int

    Returns
    -------
    (vertices, 3) array

    Examples
    --------
    >>> vertex_sums(np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 0, 1.0], [0, 0, 2.0]]), 4)[:, 2].tolist()
    [3.0, 1.0, 3.0, 2.0]
    """
    corners = triangles.ravel()
    return np.stack([np.bincount(corners, np.repeat(vectors[:, k], 3), vertices) for k in range(3)], axis=1)
