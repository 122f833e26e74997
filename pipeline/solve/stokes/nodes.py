"""The nodes of quadratic tetrahedra: the vertices, then the middle of every edge."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.flow_field import EDGES

FACE_EDGES = np.array([[0, 1], [1, 2], [2, 0]])
"""Local vertices of a triangle's edges, in VTK's order."""


@dataclass(frozen=True, eq=False, slots=True)
class Nodes:
    """Numbers of the nodes of a quadratic mesh.

    Parameters
    ----------
    vertices : int
        The first nodes are these.
    ends : (e, 2) int array
        Lower and higher vertex of each edge; its middle is node ``vertices + edge``.
    cells : (m, 10) int array
        Nodes of each tetrahedron in VTK's order.
    """

    vertices: int
    ends: Ints
    cells: Ints

    @property
    def count(self) -> int:
        """Number of nodes."""
        return self.vertices + len(self.ends)

    def middles(self, points: Floats) -> Floats:
        """Give the middles of the straight edges, (e, 3) array."""
        middle: Floats = 0.5 * (points[self.ends[:, 0]] + points[self.ends[:, 1]])
        return middle

    def of_triangles(self, triangles: Ints) -> Ints:
        """Nodes of triangles whose edges are edges of the mesh, (t, 6) int array in VTK's order."""
        pairs = np.sort(triangles[:, FACE_EDGES], axis=2).reshape(-1, 2)
        known = self.ends[:, 0] * self.vertices + self.ends[:, 1]
        found = np.searchsorted(known, pairs[:, 0] * self.vertices + pairs[:, 1])
        return np.hstack([triangles, self.vertices + found.reshape(-1, 3)])


def number_nodes(tets: Ints, vertices: int) -> Nodes:
    """Give the middles of the edges of tetrahedra their numbers.

    Parameters
    ----------
    tets : (m, 4) int array
    vertices : int

    Returns
    -------
    Nodes
        Edges are sorted by their ends.

    Examples
    --------
    >>> nodes = number_nodes(np.array([[0, 1, 2, 3], [1, 2, 3, 4]]), 5)
    >>> nodes.count, nodes.cells[0].tolist()
    (14, [0, 1, 2, 3, 5, 8, 6, 7, 9, 11])
    """
    pairs = np.sort(tets[:, EDGES], axis=2).reshape(-1, 2)
    keys, edge = np.unique(pairs[:, 0] * vertices + pairs[:, 1], return_inverse=True)
    ends = np.column_stack([keys // vertices, keys % vertices])
    return Nodes(vertices, ends, np.hstack([tets, vertices + edge.reshape(-1, 6)]))
