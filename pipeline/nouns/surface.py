"""The fibers' outside as one closed surface."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.box import Box
from pipeline.geometry.triangles import area_vectors, enclosed_volume, on_sides, unmatched_edges
from pipeline.nouns.arrays import Floats, Ints, freeze, require
from pipeline.nouns.fibers import Pieces


@dataclass(frozen=True, eq=False, slots=True)
class Surface:
    """The fibers' outside, united into closed surfaces and cut flush with the plan's sides.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        Counterclockwise seen from the air.
    fiber : (m,) int array
        Fiber that each triangle came from; the flat cuts on the sides belong to their fiber too.
    radius : (fibers,) array [m]
        Radius of each fiber of the mat, as in `Mat`.
    slab : Box [m]
        The mat's slab.
    pieces : Pieces
        The fibers that the surface was built about.
    """

    points: Floats
    triangles: Ints
    fiber: Ints
    radius: Floats
    slab: Box
    pieces: Pieces

    def __post_init__(self) -> None:
        freeze(
            self,
            points=np.asarray(self.points, np.float64),
            triangles=np.asarray(self.triangles, np.int64),
            fiber=np.asarray(self.fiber, np.int64),
            radius=np.asarray(self.radius, np.float64),
        )
        require(len(self.triangles) > 0, "the surface has no triangle")
        require(bool(np.isfinite(self.points).all()), "a surface point is not finite")
        require(self.fiber.shape == (len(self.triangles),), "not every triangle names its fiber")
        require(
            bool((self.fiber >= 0).all() and (self.fiber < len(self.radius)).all()),
            "a triangle names a fiber that the mat does not have",
        )
        open_edges = unmatched_edges(self.triangles)
        require(open_edges == 0, f"the surface is not closed: {open_edges} edges lack their partner")
        require(self.volume > 0, "the surface is inside out")

    @property
    def volume(self) -> float:
        """Solid volume [m3]."""
        return enclosed_volume(self.points, self.triangles)

    @property
    def solidity(self) -> float:
        """Solid volume over the slab's volume [-]."""
        return self.volume / self.slab.volume

    @property
    def free_area(self) -> float:
        """Area that air can meet: without the flat cuts on the plan's sides [m2]."""
        cut = on_sides(self.points, self.triangles, self.slab.lower, self.slab.upper)
        return float(np.linalg.norm(area_vectors(self.points, self.triangles)[~cut], axis=1).sum())
