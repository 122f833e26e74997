"""Pores between solid voxels: how large spheres fit in them, and which one passes through."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import distance_transform_edt, label

from pipeline.tomography.solid import Solid

_STEPS = 24
"""Sizes that the distribution is told at."""


@dataclass(frozen=True, slots=True)
class Pores:
    """The pores of a medium.

    Parameters
    ----------
    diameter : tuple of float [m]
        Of spheres, ascending.
    share : tuple of float [-]
        Share of the air's volume that spheres of at least this diameter reach without touching the solid.
    median : float [m]
        Diameter of spheres that reach half of the air.
    largest : float [m]
    bubble_point : float [m]
        Diameter of the largest sphere that passes through along z, from side to side; 0 where none does.
    """

    diameter: tuple[float, ...]
    share: tuple[float, ...]
    median: float
    largest: float
    bubble_point: float


def pores_of(solid: Solid, voxel: float) -> Pores:
    """Measure pores by the largest inscribed spheres.

    Parameters
    ----------
    solid : (x, y, z) bool array
        With solid in it.
    voxel : float [m]

    Returns
    -------
    Pores
        To about two voxels: distances are from the middle of a voxel of air to that of the nearest solid one, less
        half a voxel. Beyond the window there is air.
    """
    air = ~solid
    room = distance_transform_edt(air) - 0.5
    largest = float(room.max())
    radii = np.linspace(0.5, largest, _STEPS)
    share = np.array([_reached(room, radius, air) for radius in radii])
    return Pores(
        diameter=tuple((2.0 * voxel * radii).tolist()),
        share=tuple(share.tolist()),
        # shares fall with the radius
        median=float(2.0 * voxel * np.interp(0.5, share[::-1], radii[::-1])),
        largest=2.0 * voxel * largest,
        bubble_point=2.0 * voxel * _passing(room),
    )


def _reached(room: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]", radius: float, air: Solid) -> float:
    """Share of the air within spheres of a radius [voxel] that fit."""
    middles = room >= radius
    if not middles.any():
        return 0.0
    # a voxel is reached if the sphere, which ends half a voxel before the solid's middles, meets it
    return float((distance_transform_edt(~middles) <= radius + 0.5)[air].mean())


def _passing(room: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]") -> float:
    """Radius of the largest sphere [voxel] whose middle finds a way through along z, by halving."""
    low, high = 0.0, float(min(room[:, :, 0].max(), room[:, :, -1].max()))
    if not _leads_through(room >= 0.25):
        return 0.0
    while high - low > 0.05:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _leads_through(room >= middle) else (low, middle)
    return low


def _leads_through(open_to: Solid) -> bool:
    parts, _ = label(open_to)
    entered = np.unique(parts[:, :, 0])
    return bool(np.isin(entered[entered > 0], parts[:, :, -1]).any())
