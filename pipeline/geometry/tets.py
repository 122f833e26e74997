"""Tetrahedra on plain arrays."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any

import numpy as np
import numpy.typing as npt

from pipeline.geometry.triangles import Floats, Ints

Cells = npt.NDArray[np.int32]
"""Numbers of vertices or cells: two billions of either suffice, in half the memory."""
Numbers = npt.NDArray[np.signedinteger[Any]]
"""Whole numbers of either size."""

FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
"""Local vertices of the four faces of a positive tetrahedron, each counterclockwise seen from outside."""


def volumes(points: Floats, tets: Numbers) -> Floats:
    """Signed volume of each tetrahedron.

    Parameters
    ----------
    points : (n, 3) array [m]
    tets : (m, 4) int array

    Returns
    -------
    (m,) array [m3]
        Positive where vertex 3 lies on the side that the counterclockwise triangle 0, 1, 2 faces.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> float(6 * volumes(corners, np.array([[0, 1, 2, 3]]))[0])
    1.0
    """
    a, b, c, d = (points[tets[:, k]] for k in range(4))
    volume: Floats = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6.0
    return volume


def boundary(tets: Numbers) -> tuple[Ints, Ints]:
    """Find the triangles that belong to one tetrahedron only.

    Parameters
    ----------
    tets : (m, 4) int array
        Positive tetrahedra.

    Returns
    -------
    faces : (b, 3) int array
        Counterclockwise seen from outside.
    cell : (b,) int array
        The tetrahedron of each face.

    Examples
    --------
    >>> faces, cell = boundary(np.array([[0, 1, 2, 3], [1, 2, 3, 4]]))
    >>> len(faces), np.bincount(cell).tolist()
    (6, [3, 3])
    """
    faces = tets.astype(np.int64)[:, FACES].reshape(-1, 3)
    ordered = np.sort(faces, axis=1)
    count = int(tets.max(initial=0)) + 1
    # two steps keep the product of three indices within 64 bits
    _, pair = np.unique(ordered[:, 0] * count + ordered[:, 1], return_inverse=True)
    _, where, repeats = np.unique(pair * count + ordered[:, 2], return_index=True, return_counts=True)
    single = np.sort(where[repeats == 1])
    return faces[single], single // 4


def volume_between(points: Floats, triangles: Ints, low: float, high: float) -> float:
    """Volume that a closed surface encloses between two planes across z, cut exactly.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        Outward; the surface may have holes through it and voids in it.
    low, high : float [m]
        The planes' z.

    Returns
    -------
    float [m3]

    Notes
    -----
    Each triangle and one fixed point span a tetrahedron whose volume counts with its sign: what lies outside the
    surface cancels, and so it does in what the planes leave of each.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> round(6 * volume_between(corners, FACES, 0.5, 2.0), 12)  # a corner of half the size
    0.125
    """
    middle = points.mean(axis=0)
    # the point lies on the inner side of an outward triangle, against the order of a positive tetrahedron
    spanned = np.column_stack([triangles[:, ::-1], np.full(len(triangles), len(points))])
    vertices = np.concatenate([points, middle[None]])
    heights = np.sort(vertices[spanned, 2], axis=1)
    share = _share_below(heights, high) - _share_below(heights, low)
    return float(volumes(vertices, spanned) @ share)


def _share_below(heights: Floats, level: float) -> Floats:
    # what a plane cuts off a tetrahedron: a corner, or a wedge that three tetrahedra fill (by products of the
    # shares at which the plane cuts the edges), or all but a corner
    z0, z1, z2, z3 = heights.T

    def cut(below: Floats, above: Floats) -> Floats:
        length = above - below
        share: Floats = np.clip(np.divide(level - below, length, out=np.ones_like(length), where=length > 0), 0.0, 1.0)
        return share

    s01, s02, s03, s12, s13, s23 = cut(z0, z1), cut(z0, z2), cut(z0, z3), cut(z1, z2), cut(z1, z3), cut(z2, z3)
    corner = s01 * s02 * s03
    wedge = s02 * s03 + (1.0 - s02) * s03 * s12 + (1.0 - s03) * s12 * s13
    rest = 1.0 - (1.0 - s03) * (1.0 - s13) * (1.0 - s23)
    share: Floats = np.select([level <= z0, level >= z3, level <= z1, level <= z2], [0.0, 1.0, corner, wedge], rest)
    return share
