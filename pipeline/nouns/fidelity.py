"""How well the walls of a mesh stand where the true fibers do."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

LARGEST_SHARE_IN_AIR = 0.02
"""Share of a fiber's axis that may lie in the mesh's air: its ends, where it grazes a side; more of it is missing."""
LARGEST_RADIUS_ERROR = 0.15
"""Mean distance of a fiber's walls from the fiber, over its radius, from which on the fiber is another one."""
NEAREST = 1.5
"""Diameters from a fiber beyond which a wall is none of it, but a part of the air that was lost."""
_MOST_NAMED = 5  # fibers that a message names


@dataclass(frozen=True, slots=True)
class FiberWalls:
    """How the walls of one fiber stand; lengths are in its own diameters.

    Parameters
    ----------
    fiber : int
        Its number in the mat.
    diameter : float [m]
    area : float [-]
        Of its walls in the mesh, in squared diameters; 0 for one that lies within others.
    mean_deviation : float [-]
        Mean distance of its walls from the true fiber, either way.
    typical_deviation : float [-]
        99 % of its walls' area is nearer than this.
    radius_error : float [-]
        How much its walls stand off its true radius on average, relative; above 0 they stand outside.
    in_air : float [-]
        Share of its axis in the duct that lies in the air of the mesh.
    """

    fiber: int
    diameter: float
    area: float
    mean_deviation: float
    typical_deviation: float
    radius_error: float
    in_air: float

    def fault(self, deviation: float) -> str | None:
        """Say what is wrong with the fiber, or None.

        Parameters
        ----------
        deviation : float [-]
            Distance within which 99 % of its walls have to stand, in its diameters.
        """
        if self.in_air > LARGEST_SHARE_IN_AIR:
            return f"{self.in_air:.0%} of its axis lies in the air of the mesh"
        if self.area > 0.0 and self.typical_deviation > deviation:
            return f"a hundredth of its walls is farther than {self.typical_deviation:.3g} of its diameters from it"
        if self.area > 1.0 and abs(self.radius_error) > LARGEST_RADIUS_ERROR:
            return f"its radius is off by {self.radius_error:+.0%}"
        return None


@dataclass(frozen=True, slots=True)
class Fidelity:
    """Distance between the mesh's walls and the true fibers, each in the diameters of the fiber next to it.

    Parameters
    ----------
    mean_deviation : float [-]
        Mean distance over the area of all walls, either way.
    typical_deviation : float [-]
        99 % of the walls' area is nearer than this.
    largest_deviation : float [-]
        Of all: found where fibers meet, and the sharp air between them is filled.
    fibers : tuple of FiberWalls
        By number.
    """

    mean_deviation: float
    typical_deviation: float
    largest_deviation: float
    fibers: tuple[FiberWalls, ...]

    @property
    def radius_error(self) -> tuple[float, ...]:
        """Of each fiber."""
        return tuple(walls.radius_error for walls in self.fibers)

    def faults(self, deviation: float) -> tuple[str, ...]:
        """Name the fibers that are missing, or whose walls are off by more than allowed, and say by how much.

        Parameters
        ----------
        deviation : float [-]
            Distance within which 99 % of each fiber's walls have to stand, in its own diameters; and all walls within
            `NEAREST`, or that if it is more.
        """
        found = [(walls, fault) for walls in self.fibers if (fault := walls.fault(deviation)) is not None]
        named = [
            f"fiber {walls.fiber} of {len(self.fibers)} (d {walls.diameter * 1e6:.3g} um): {fault}"
            for walls, fault in found[:_MOST_NAMED]
        ]
        if len(found) > _MOST_NAMED:
            named.append(f"and {len(found) - _MOST_NAMED} more")
        # a share of the area does not show them: a dent in a plane of the duct is small, and moves the drag by percents
        if self.largest_deviation >= max(NEAREST, deviation):
            named.append(f"walls stand {self.largest_deviation:.3g} diameters or more from every fiber")
        return tuple(named)
