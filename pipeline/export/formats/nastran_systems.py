"""NASTRAN's coordinate systems by three points: rectangular, cylindrical, spherical, each in another or the base."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.nouns.arrays import Floats, require

SYSTEMS = frozenset({"CORD2R", "CORD2C", "CORD2S", "CORD1R", "CORD1C", "CORD1S"})
"""Cards that define one; those of kind 1 name grid points and are refused."""


@dataclass(frozen=True, slots=True)
class System:
    """A system as its card gives it: within which other, and the coordinates of its origin, a point on z, one in xz."""

    card: str
    within: int
    points: list[float]


def in_base(places: Floats, number: int, systems: dict[int, System], inside: tuple[int, ...] = ()) -> Floats:
    """Give points of a system in the base system.

    Parameters
    ----------
    places : (n, 3) array
        Cylindrical: radius, angle [degree], z; spherical: radius, angle from z, angle about z.
    number : int
        Of the system; 0 is the base.
    systems : dict of number to System

    Returns
    -------
    (n, 3) array

    Raises
    ------
    ValueError
        If the system is not there, is defined by grid points, by itself, or by points on a line.

    Examples
    --------
    >>> about_z = System("CORD2C", 0, [0, 0, 0, 0, 0, 1, 1, 0, 0])
    >>> in_base(np.array([[2.0, 90.0, 5.0]]), 1, {1: about_z}).round(12).tolist()
    [[0.0, 2.0, 5.0]]
    """
    if number == 0:
        return places
    require(number in systems, f"coordinate system {number} is used but not there")
    require(number not in inside, f"coordinate system {number} is defined by itself")
    system = systems[number]
    require(
        system.card.startswith("CORD2"),
        f"coordinate system {number} is a {system.card}, of which only CORD2R, CORD2C and CORD2S are read",
    )
    origin, on_z, in_xz = in_base(
        np.array(system.points, np.float64).reshape(3, 3), system.within, systems, (*inside, number)
    )
    z = on_z - origin
    y = np.cross(z, in_xz - origin)
    require(
        bool(np.linalg.norm(z) > 0 and np.linalg.norm(y) > 0),
        f"coordinate system {number} is defined by points on a line",
    )
    x = np.cross(y, z)
    axes = np.array([axis / np.linalg.norm(axis) for axis in (x, y, z)])
    based: Floats = origin + _rectangular(places, system.card[-1]) @ axes
    return based


def _rectangular(places: Floats, kind: str) -> Floats:
    if kind == "R":
        return places
    if kind == "C":
        angle = np.radians(places[:, 1])
        return np.column_stack([places[:, 0] * np.cos(angle), places[:, 0] * np.sin(angle), places[:, 2]])
    from_z, about_z = np.radians(places[:, 1:]).T
    across = places[:, 0] * np.sin(from_z)
    return np.column_stack([across * np.cos(about_z), across * np.sin(about_z), places[:, 0] * np.cos(from_z)])
