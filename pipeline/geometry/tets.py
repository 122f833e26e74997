"""Tetrahedra on plain arrays."""

import numpy as np

from pipeline.geometry.triangles import Floats, Ints

FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
"""Local vertices of the four faces of a positive tetrahedron, each counterclockwise seen from outside."""


def volumes(points: Floats, tets: Ints) -> Floats:
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
