"""The signed distance to one straight piece of a fiber: a cylinder, round at bends, flat or round at its ends.

Compiled by numba: imported only where a mesh is made. Pieces travel as one table, a row each: start (3), direction (3),
length, radius.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats

Vector = tuple[float, float, float]


def table(start: Floats, end: Floats, radius: Floats) -> Floats:
    """Put pieces into one table: (n, 8) array of start, unit direction, length and radius.

    Parameters
    ----------
    start, end : (n, 3) arrays
        Of the pieces' axes; none has no length.
    radius : (n,) array
    """
    length = np.linalg.norm(end - start, axis=1)
    return np.column_stack([start, (end - start) / length[:, None], length, radius])


@compiled
def distance(x: float, y: float, z: float, pieces: Floats, flat: npt.NDArray[np.bool_], k: int) -> float:
    """Signed distance from a place to piece k, negative inside."""
    px, py, pz = x - pieces[k, 0], y - pieces[k, 1], z - pieces[k, 2]
    ux, uy, uz = pieces[k, 3], pieces[k, 4], pieces[k, 5]
    length, radius = pieces[k, 6], pieces[k, 7]
    along = px * ux + py * uy + pz * uz
    over = max(-along, along - length)  # beyond an end, or minus the distance to the nearer one
    at_flat_end = flat[k, 0] if -along > along - length else flat[k, 1]
    if over > 0.0 and not at_flat_end:
        shift = length if along > length else 0.0
        px, py, pz = px - shift * ux, py - shift * uy, pz - shift * uz
        return float(math.sqrt(px * px + py * py + pz * pz) - radius)
    px, py, pz = px - along * ux, py - along * uy, pz - along * uz
    aside = math.sqrt(px * px + py * py + pz * pz) - radius
    if over > 0.0:
        return float(math.sqrt(max(aside, 0.0) ** 2 + over * over))
    if flat[k, 0]:
        aside = max(aside, -along)
    if flat[k, 1]:
        aside = max(aside, along - length)
    return float(aside)


@compiled
def away(x: float, y: float, z: float, pieces: Floats, flat: npt.NDArray[np.bool_], k: int) -> Vector:
    """Give the unit gradient of the distance to piece k; 0 on its axis."""
    px, py, pz = x - pieces[k, 0], y - pieces[k, 1], z - pieces[k, 2]
    ux, uy, uz = pieces[k, 3], pieces[k, 4], pieces[k, 5]
    length, radius = pieces[k, 6], pieces[k, 7]
    along = px * ux + py * uy + pz * uz
    over = max(-along, along - length)
    sign = -1.0 if -along > along - length else 1.0
    at_flat_end = flat[k, 0] if sign < 0.0 else flat[k, 1]
    foot = along
    if over > 0.0 and not at_flat_end:
        foot = length if along > length else 0.0
    px, py, pz = px - foot * ux, py - foot * uy, pz - foot * uz
    size = math.sqrt(px * px + py * py + pz * pz)
    aside = size - radius
    if at_flat_end and (over > 0.0 or over > aside):
        if aside <= 0.0:
            return (sign * ux, sign * uy, sign * uz)
        # beside the rim of a flat end
        share = aside / size
        px, py, pz = px * share + sign * over * ux, py * share + sign * over * uy, pz * share + sign * over * uz
        size = math.sqrt(px * px + py * py + pz * pz)
    if size == 0.0:
        return (0.0, 0.0, 0.0)
    return (px / size, py / size, pz / size)
