"""The velocity and the pressure of the air everywhere in a duct, on curved quadratic tetrahedra."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.nouns.arrays import Bools, Floats, Ints, all_within, freeze, require

FLOW_FILE = "flow.vtu"
"""File beside a flow's own that viewers open."""
EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
"""Local vertices of a tetrahedron's edges, in the order of its last six nodes, which is VTK's."""


def basis(places: Floats) -> Floats:
    r"""Quadratic functions of a tetrahedron: the weights of its ten nodes.

    Parameters
    ----------
    places : (..., 4) array [-]
        Barycentric coordinates :math:`\lambda`.

    Returns
    -------
    (..., 10) array [-]
        :math:`\lambda_i (2\lambda_i - 1)` for vertices, :math:`4 \lambda_i \lambda_j` for edges; they sum to 1.

    Examples
    --------
    >>> (0.0 + basis(np.array([1.0, 0.0, 0.0, 0.0]))).tolist()
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """
    one, two = EDGES.T
    return np.concatenate([places * (2.0 * places - 1.0), 4.0 * places[..., one] * places[..., two]], axis=-1)


@dataclass(frozen=True, eq=False, slots=True)
class FlowField:
    """A flow on quadratic tetrahedra whose edges on the walls are curved.

    Parameters
    ----------
    positions : (n, 3) array [m]
        Nodes: the mesh's vertices (on the walls moved onto the true fibers), then the middles of edges.
    cells : (m, 10) int array
        Nodes of each tetrahedron: its four vertices as in the mesh, then the middles of `EDGES`.
    velocity : (n, 3) array [m/s]
    pressure : (vertices,) array [Pa]
        Above the outlet's; linear within a tetrahedron.
    curved : (m,) bool array
        Which tetrahedra have a curved edge; in the others a place and its barycentric coordinates are one to one.
    slip_length : float [m]
        Of the air on the fibers; 0 where it stands still on them.
    """

    positions: Floats
    cells: Ints
    velocity: Floats
    pressure: Floats
    curved: Bools
    slip_length: float

    def __post_init__(self) -> None:
        freeze(
            self,
            positions=np.asarray(self.positions, np.float64),
            cells=np.asarray(self.cells, np.int64),
            velocity=np.asarray(self.velocity, np.float64),
            pressure=np.asarray(self.pressure, np.float64),
            curved=np.asarray(self.curved, np.bool_),
        )
        require(self.cells.ndim == 2 and self.cells.shape[1] == 10, "a tetrahedron has not ten nodes")
        require(all_within(self.cells, len(self.positions)), "a tetrahedron has a node that is not there")
        require(self.positions.ndim == 2 and self.positions.shape[1] == 3, "a node has not three coordinates")
        require(self.velocity.shape == self.positions.shape, "not every node has a velocity")
        vertices = self.pressure.ndim == 1 and all_within(self.cells[:, :4], len(self.pressure))
        require(vertices, "not every vertex of a tetrahedron has a pressure")
        require(self.curved.shape == (len(self.cells),), "not every tetrahedron says whether it is curved")
        require(self.slip_length >= 0.0, "the slip length is below 0")
        finite = all(bool(np.isfinite(each).all()) for each in (self.positions, self.velocity, self.pressure))
        require(finite, "a position, a velocity or a pressure is not finite")

    def place(self, cell: Ints, barycentric: Floats) -> Floats:
        """Where barycentric coordinates of tetrahedra are, (k, 3) array [m]; `cell` is (k,), `barycentric` (k, 4)."""
        return np.asarray(np.einsum("kn,kna->ka", basis(barycentric), self.positions[self.cells[cell]]))

    def velocity_at(self, cell: Ints, barycentric: Floats) -> Floats:
        """Velocity at barycentric coordinates of tetrahedra, (k, 3) array [m/s]."""
        return np.asarray(np.einsum("kn,kna->ka", basis(barycentric), self.velocity[self.cells[cell]]))

    def pressure_at(self, cell: Ints, barycentric: Floats) -> Floats:
        """Pressure at barycentric coordinates of tetrahedra, (k,) array [Pa]."""
        return np.asarray(np.einsum("kn,kn->k", barycentric, self.pressure[self.cells[cell, :4]]))
