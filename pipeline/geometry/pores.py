"""The pores of voxels: sizes of inscribed spheres, the way of the largest one, and half the flow of tubes."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.conduction import conductance_through
from pipeline.geometry.triangles import Floats

_HALF = 0.5
_PRECISE = 0.02
"""Relative width at which halving ends: spheres in voxels are not known better."""


@dataclass(frozen=True, eq=False, slots=True)
class Spheres:
    """The largest spheres about each voxel.

    Parameters
    ----------
    room : (x, y, z) array [voxel]
        Signed distance from each voxel's middle to the solid, negative within it.
    thickness : (x, y, z) array [voxel]
        Radius of the largest sphere that fits into the air and holds the voxel's middle; 0 in the solid.
    entered : (x, y, z) array [voxel]
        Radius of the largest sphere that comes from the end at the lowest z and then holds the voxel's middle.
    passing : float [voxel]
        Radius of the largest sphere that passes from end to end; 0 where none does.
    periodic : bool
        Whether the sides wrap; else the medium goes on as its mirror image.
    """

    room: Floats
    thickness: Floats
    entered: Floats
    passing: float
    periodic: bool


def spheres_in(room: Floats, periodic: bool) -> Spheres:
    """Measure the spheres that fit between solid voxels.

    Parameters
    ----------
    room : (x, y, z) array [voxel]
        Signed distance from each voxel's middle to the solid, negative within it.
    periodic : bool

    Returns
    -------
    Spheres
        Spheres have their middles in voxels' middles, between both ends of z.
    """
    from pipeline.geometry.spheres import covered_by, widest_way

    room = np.ascontiguousarray(room, np.float64)
    way = widest_way(room, periodic)
    return Spheres(
        room=room,
        thickness=covered_by(room, room, periodic),
        entered=covered_by(room, way, periodic),
        passing=float(way[:, :, -1].max()),
        periodic=periodic,
    )


def mean_flow_radius(spheres: Spheres, step: int = 1) -> float:
    r"""Give the radius of the sphere behind which half of the dry flow passes [voxel]; 0 where nothing passes.

    Parameters
    ----------
    spheres : Spheres
    step : int
        Every how many voxels the flow is solved for; the spheres are those of all voxels.

    Returns
    -------
    float

    Notes
    -----
    The mean flow pore of ASTM F316: where the flow through the wetted medium is half of that through the dry one. The
    gas enters with spheres of one size, and what they cover is dry. The air of a voxel conducts as a tube of its
    inscribed sphere does by Hagen and Poiseuille, :math:`k = r^2 / 8`; the flow is :math:`\nabla\cdot(k\nabla p) = 0`.
    Exact for round tubes side by side.
    """
    part = (slice(step // 2, None, step),) * 3
    room, entered = spheres.room[part] / step, spheres.entered[part]
    conductivity = (spheres.thickness[part] / step) ** 2 / 8.0

    def flow(radius: float) -> float:
        return conductance_through(np.where(entered >= radius, conductivity, 0.0), room, spheres.periodic)

    dry = flow(0.0)
    if dry <= 0.0:
        return 0.0
    low, high = 0.0, spheres.passing
    # the largest sphere alone may carry half of it
    if flow(high) >= _HALF * dry:
        return high
    while high - low > _PRECISE * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if flow(middle) >= _HALF * dry else (low, middle)
    return 0.5 * (low + high)
