"""The distance to the fibers at the middles of cubes that fill the slab."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np

from pipeline.errors import StageError
from pipeline.geometry.triangles import on_sides
from pipeline.nouns.arrays import Bools, Floats, Ints
from pipeline.nouns.surface import Surface

MOST = 30_000_000
"""Voxels beyond which a medium is refused: about 6 GB."""
_REACH = 8.0  # radii, to begin with; what lies farther from every fiber is looked for again
_SAMPLES = 0.5  # voxels between the points that stand for a surface's triangles


@dataclass(frozen=True, eq=False, slots=True)
class Room:
    """Cubes and how far they are from the solid.

    Parameters
    ----------
    distance : (x, y, z) array [voxel]
        From the middle of each to the nearest solid, negative within it.
    voxel : float [m]
    """

    distance: Floats
    voxel: float


def room_in(surface: Surface, per_diameter: float) -> Room:
    """Measure the distance to the fibers of a slab.

    Parameters
    ----------
    surface : Surface
        Of fibers with known axes, or of a body.
    per_diameter : float [-]
        Voxels to a mean fiber diameter, about: so many fit that x is filled from side to side.

    Returns
    -------
    Room
        Exact for fibers; within a tenth of a voxel for a body's triangles.

    Raises
    ------
    StageError
        If there would be too many voxels.
    """
    size = np.array(surface.slab.size)
    wanted = 2.0 * float(surface.radius.mean()) / per_diameter
    voxel = float(size[0] / max(1, round(size[0] / wanted)))
    counts = np.maximum(1, np.rint(size / voxel)).astype(np.int64)
    total = float(np.prod(counts.astype(np.float64)))
    if total > MOST:
        raise StageError(
            f"the pores would take {total:.3g} voxels, and {MOST:.0e} are the most: set structure.voxels_per_diameter "
            f"to {math.floor(per_diameter * (MOST / total) ** (1 / 3))}, or take a smaller plan"
        )
    first = np.array(surface.slab.lower) + 0.5 * (size - counts * voxel) + 0.5 * voxel
    axes = [first[axis] + voxel * np.arange(counts[axis]) for axis in range(3)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    found = _from_fibers(surface, places) if len(surface.pieces) else _from_triangles(surface, places, voxel)
    return Room((found / voxel).reshape(counts), voxel)


def _from_fibers(surface: Surface, places: Floats) -> Floats:
    # numba takes half a second to load
    from pipeline.geometry.fibers import FAR, FiberDistance

    pieces, radius = surface.pieces, surface.radius
    found = np.full(len(places), FAR)
    reach, left = _REACH * float(radius.mean()), np.arange(len(places))
    while len(left):
        lower, upper = places[left].min(axis=0) - 1e-3 * reach, places[left].max(axis=0) + 1e-3 * reach
        distance = FiberDistance.about(
            pieces.start, pieces.end, radius[pieces.fiber], pieces.flat, pieces.fiber,
            np.full(len(pieces), reach), lower, upper,
        )  # fmt: skip
        found[left] = distance.at(places[left])
        # a distance beyond the reach may be another piece's that the bin lists for places nearer to it
        left = left[found[left] > reach]
        reach *= 2.0
    return found


def _from_triangles(surface: Surface, places: Floats, voxel: float) -> Floats:
    from scipy.spatial import cKDTree

    from pipeline.geometry.rays import crossings_above

    free = ~on_sides(surface.points, surface.triangles, surface.slab.lower, surface.slab.upper)
    samples = _samples(surface.points, surface.triangles[free], _SAMPLES * voxel)
    away = cKDTree(samples).query(places)[0]
    # off the edges that run along x and y, which rounding would decide about
    aside = places + 1e-5 * voxel * np.array([0.61803399, 0.41421356, 0.0])
    inside: Bools = crossings_above(surface.points, surface.triangles, aside) % 2 == 1
    return np.asarray(np.where(inside, -away, away))


def _samples(points: Floats, triangles: Ints, spacing: float) -> Floats:
    """Points on triangles, no farther apart than the spacing along their edges."""
    corners = points[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.maximum(1, np.ceil(longest / spacing)).astype(np.int64)
    found = []
    for count in np.unique(parts):
        i, j = (index.ravel() for index in np.indices((count + 1, count + 1)))
        kept = i + j <= count
        share = np.stack([count - i - j, i, j], axis=1)[kept] / count
        found.append(np.einsum("sc,tcx->tsx", share, corners[parts == count]).reshape(-1, 3))
    return np.concatenate(found)
