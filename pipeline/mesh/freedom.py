"""How far a vertex of the mesh may move: not across the duct's planes, and off and along a fiber by shares of it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.geometry.box import Box
from pipeline.mesh.boundary import planes
from pipeline.mesh.distance import fiber_distance
from pipeline.nouns.arrays import Floats
from pipeline.nouns.domain import FluidDomain

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance

Planes = npt.NDArray[np.uint8]
"""A bit for each plane of the duct, by the number of its patch, on which a vertex lies."""

_REACH = 3.0  # radii from a fiber beyond which it does not matter
_ALONG = 0.2  # edges that improving may move a vertex along its fiber


@dataclass(frozen=True, eq=False, slots=True)
class Freedom:
    """What bounds the moves of vertices.

    Parameters
    ----------
    box : Box [m]
        The duct, which no vertex may leave.
    cyclic : bool
        Whether opposite sides are one to the solver: then what moves on one has to move on the other.
    distance : FiberDistance
    diameter : (fibers,) array [m]
    off, along : float [-]
        How far a vertex of a wall may move off it and along it, in diameters of its fiber.
    """

    box: Box
    cyclic: bool
    distance: "FiberDistance"
    diameter: Floats
    off: float
    along: float

    @classmethod
    def of(cls, domain: FluidDomain, off: float, edge: float) -> "Freedom":
        """Give the freedom in a duct.

        Parameters
        ----------
        domain : FluidDomain
        off : float [-]
            How far a vertex may move off its wall, in diameters of the fiber.
        edge : float [-]
            Edge of the cells at a fiber, in its diameters.
        """
        distance = fiber_distance(domain, _REACH * domain.radius)
        return cls(domain.box, domain.cyclic, distance, 2.0 * domain.radius, off, _ALONG * edge)

    @property
    def limits(self) -> tuple[Floats, Floats]:
        """Lowest and highest coordinates of the duct, two (3,) arrays [m]."""
        return np.array(self.box.lower), np.array(self.box.upper)

    def nearest(self, points: Floats) -> tuple[Floats, Floats]:
        """Distance to the nearest fiber and its diameter, two (n,) arrays [m]; nan for what none is near."""
        distance, piece = self.distance.with_piece(points)
        diameter = self.diameter[self.distance.field[2][np.maximum(piece, 0)]]
        return distance, np.where(piece >= 0, diameter, np.nan)

    def off_and_along(self, points: Floats) -> tuple[Floats, Floats]:
        """Give how far vertices of walls may move off the wall and along it, two (n,) arrays [m]."""
        _, diameter = self.nearest(points)
        # a wall far from every fiber is nobody's: the thinnest decides
        diameter = np.where(np.isnan(diameter), self.diameter.min(), diameter)
        return self.off * diameter, self.along * diameter

    def planes_at(self, points: Floats) -> Planes:
        """Tell on which of the duct's planes each point lies, (n,) array of bits."""
        found = np.zeros(len(points), np.uint8)
        for plane in planes(self.box):
            found[points[:, plane.axis] == plane.value] |= np.uint8(1 << plane.patch)
        return found

    def free_axes(self, on: Planes) -> Floats:
        """Tell along which axes vertices may move by the planes they lie on, (n, 3) array of 0 and 1."""
        free = np.ones((len(on), 3))
        for plane in planes(self.box):
            there = (on & np.uint8(1 << plane.patch)) > 0
            free[there, plane.axis] = 0.0
        return free
