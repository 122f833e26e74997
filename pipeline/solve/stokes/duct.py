"""A meshed duct, ready for a flow: its nodes, unknowns, walls, matrices and boundary.

All in the unit system of the mesh's length, the face velocity and the viscosity.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pipeline.geometry.triangles import area_vectors
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.patches import FIBERS, INLET, SIDES
from pipeline.solve.stokes.conditions import Conditions, fixed_sides, no_slip, slip
from pipeline.solve.stokes.elements import Matrices, assemble
from pipeline.solve.stokes.nodes import Nodes, number_nodes
from pipeline.solve.stokes.unknowns import unknown_of_nodes
from pipeline.solve.stokes.walls import Walls, curve_walls


@dataclass(frozen=True, eq=False)
class Duct:
    """A meshed duct, ready for a flow.

    Parameters
    ----------
    points : (n, 3) array
        Vertices in mean fiber diameters from the duct's lower corner.
    tets : (m, 4) int array
    triangles : dict of (b, 3) int array
        Outward, by patch.
    pieces : Pieces
        The true fibers.
    radius : (fibers,) array
    upper : (3,) array
        The duct's upper corner.
    cyclic : bool
        Whether opposite sides are one; else they are planes that no air crosses.
    """

    points: Floats
    tets: Ints
    triangles: dict[str, Ints]
    pieces: Pieces
    radius: Floats
    upper: Floats
    cyclic: bool = False

    @cached_property
    def nodes(self) -> Nodes:
        """Vertices and the middles of edges."""
        return number_nodes(self.tets, len(self.points))

    @cached_property
    def unknown(self) -> Ints:
        """Unknown at each node."""
        return unknown_of_nodes(self.points, self.nodes, self.triangles, self.cyclic)

    @cached_property
    def walls(self) -> Walls:
        """The nodes where the true fibers want them."""
        return curve_walls(
            self.points, self.nodes, self.triangles[FIBERS], self.pieces, self.radius, np.zeros(3), self.upper
        )

    @cached_property
    def matrices(self) -> Matrices:
        """Stiffness, divergence and mass."""
        return assemble(self.walls.positions, self.nodes.cells, self.unknown[self.nodes.cells], self.walls.curved)

    @cached_property
    def ends(self) -> Ints:
        """Unknowns of the vertices at both ends of each edge's middle, by the middle's unknown, (e, 2) array."""
        middle = self.unknown[self.nodes.vertices :]
        ends = np.empty((self.matrices.unknowns - self.matrices.vertices, 2), np.int64)
        ends[middle - self.matrices.vertices] = self.unknown[self.nodes.ends]
        return ends

    @cached_property
    def held(self) -> Ints:
        """Unknowns on the walls that hold the air."""
        return np.unique(self.unknown[self.walls.wall])

    @cached_property
    def area(self) -> float:
        """Area of the inlet."""
        return float(np.linalg.norm(self.face_areas(INLET).sum(axis=0)))

    def face_areas(self, patch: str) -> Floats:
        """Area vectors of a plane patch's triangles, (t, 3) array."""
        return area_vectors(self.points, self.triangles[patch])

    def passing(self, velocity: Floats, patch: str) -> float:
        """Air that leaves through a plane patch."""
        middles = self.unknown[self.nodes.of_triangles(self.triangles[patch])[:, 3:]]
        # the mean of a quadratic on a triangle is that of the middles of its sides
        return float(np.einsum("fa,fa->", self.face_areas(patch), velocity[middles].mean(axis=1)))

    def conditions(self, slip_length: float) -> Conditions:
        """Hold the flow on the boundary; on the fibers by Navier's slip, or without slip at a length of 0."""
        planes = {} if self.cyclic else {name: SIDES.index(name) // 2 for name in SIDES if name in self.triangles}
        fixed, given = fixed_sides(self.nodes, self.unknown, self.triangles, planes, INLET)
        if slip_length == 0.0:
            return no_slip(fixed, given, self.unknown[self.walls.wall])
        return slip(fixed, given, self.nodes, self.unknown, self.walls, self.triangles[FIBERS], slip_length)
