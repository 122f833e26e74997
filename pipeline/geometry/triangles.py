"""Closed triangle surfaces: areas, volume, and whether they are closed."""

import numpy as np
import numpy.typing as npt

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
    # measured from the middle of the surface: far from the origin the terms would cancel in rounding
    local = points - 0.5 * (points.min(axis=0) + points.max(axis=0))
    centers = local[triangles].mean(axis=1)
    return float(np.einsum("ij,ij->", area_vectors(local, triangles), centers) / 3.0)


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
    forward, repeats = np.unique(start * count + end, return_counts=True)
    backward = np.unique(end * count + start)
    missing = np.setdiff1d(forward, backward, assume_unique=True).size
    return int(missing + (repeats - 1).sum())
