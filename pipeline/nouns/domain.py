"""The air in the duct, by its surface."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.box import Box
from pipeline.geometry.triangles import enclosed_volume, unmatched_edges
from pipeline.nouns.arrays import Floats, Ints, freeze, require
from pipeline.nouns.fibers import Pieces


@dataclass(frozen=True, eq=False, slots=True)
class FluidDomain:
    """The air in the duct, as a closed surface whose every triangle lies in one patch.

    Parameters
    ----------
    points : (n, 3) array [m]
    triangles : (m, 3) int array
        Counterclockwise seen from outside the air.
    patch : (m,) int array
        Index into `patches`.
    patches : tuple of str
        ``inlet`` (lowest z), ``outlet`` (highest z), ``xmin``, ``xmax``, ``ymin``, ``ymax``, ``fibers``.
    fiber : (m,) int array
        Fiber that a triangle came from; -1 on the duct's planes.
    radius : (fibers,) array [m]
        Radius of each fiber, as in `Mat`.
    box : Box [m]
        The duct with both plenums.
    slab : Box [m]
        The mat's slab within it.
    pieces : Pieces
        The fibers that the surface was built about.
    cyclic : bool
        Whether opposite sides are one to the solver: the air goes on through each where it enters the other.
    """

    points: Floats
    triangles: Ints
    patch: Ints
    patches: tuple[str, ...]
    fiber: Ints
    radius: Floats
    box: Box
    slab: Box
    pieces: Pieces
    cyclic: bool = False

    def __post_init__(self) -> None:
        freeze(
            self,
            points=np.asarray(self.points, np.float64),
            triangles=np.asarray(self.triangles, np.int64),
            patch=np.asarray(self.patch, np.int64),
            fiber=np.asarray(self.fiber, np.int64),
            radius=np.asarray(self.radius, np.float64),
        )
        require(self.patch.shape == (len(self.triangles),), "not every triangle names its patch")
        require(self.fiber.shape == (len(self.triangles),), "not every triangle names its fiber")
        missing = sorted({*range(len(self.patches))} - set(np.unique(self.patch).tolist()))
        require(not missing, f"no triangle in patch {', '.join(self.patches[k] for k in missing)}")
        require(
            bool((self.patch >= 0).all() and (self.patch < len(self.patches)).all()),
            "a triangle names a patch that does not exist",
        )
        open_edges = unmatched_edges(self.triangles)
        require(open_edges == 0, f"the duct's surface is not closed: {open_edges} edges lack their partner")
        require(self.volume > 0, "the duct's surface is inside out")

    @property
    def mean_diameter(self) -> float:
        """Mean fiber diameter [m], the unit of a mesh's lengths in a case file."""
        return 2.0 * float(self.radius.mean())

    @property
    def volume(self) -> float:
        """Volume of the air [m3]."""
        return enclosed_volume(self.points, self.triangles)

    def volume_error(self, air: float) -> float:
        """Relative error of the fibers' volume [-] where a mesh fills so much air [m3]; above 0 they are too thick."""
        volume = self.volume
        return (volume - air) / (self.box.volume - volume)
