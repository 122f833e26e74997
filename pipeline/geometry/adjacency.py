"""Which tetrahedra meet at a face, and which at a vertex."""

import numpy as np

from pipeline.geometry.tets import FACES
from pipeline.geometry.triangles import Ints


def neighbors(tets: Ints) -> Ints:
    """Find the tetrahedron on the other side of each face.

    Parameters
    ----------
    tets : (m, 4) int array
        A conforming mesh of positive tetrahedra.

    Returns
    -------
    (m, 4) int array
        By local face as in `pipeline.geometry.tets.FACES`; -1 on the boundary.

    Examples
    --------
    >>> neighbors(np.array([[0, 1, 2, 3], [1, 2, 3, 4]])).tolist()
    [[-1, -1, -1, 1], [0, -1, -1, -1]]
    """
    faces = np.sort(tets[:, FACES].reshape(-1, 3), axis=1)
    order = np.lexsort(faces.T[::-1])
    ranked = faces[order]
    twin = np.flatnonzero((ranked[1:] == ranked[:-1]).all(axis=1))
    across = np.full(len(faces), -1, dtype=np.int64)
    across[order[twin]] = order[twin + 1] // 4
    across[order[twin + 1]] = order[twin] // 4
    return across.reshape(-1, 4)


def cells_at_vertices(tets: Ints, vertices: int) -> tuple[Ints, Ints]:
    """List the tetrahedra at each vertex.

    Parameters
    ----------
    tets : (m, 4) int array
    vertices : int
        Number of vertices.

    Returns
    -------
    first : (vertices + 1,) int array
    cells : (4 m,) int array
        Vertex v has ``cells[first[v]:first[v + 1]]``.
    """
    order = np.argsort(tets.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(np.bincount(tets.ravel(), minlength=vertices))])
    return first.astype(np.int64), (order // 4).astype(np.int64)
