"""The room between solid voxels, for the spheres that fit in."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

from scipy.ndimage import distance_transform_edt

from pipeline.structure.voxels import MOST, Room
from pipeline.tomography.solid import Solid


def room_between(solid: Solid, voxel: float) -> Room:
    """Measure the distance to the solid of voxels.

    Parameters
    ----------
    solid : (x, y, z) bool array
    voxel : float [m]

    Returns
    -------
    Room
        To about half a voxel: from the middle of a voxel of air to that of the nearest solid one, less half a voxel,
        and the other way round within the solid. Of a large window every second voxel, or fewer.
    """
    step = math.ceil((solid.size / MOST) ** (1 / 3))
    solid = solid[(slice(step // 2, None, step),) * 3]
    outside, inside = distance_transform_edt(~solid), distance_transform_edt(solid)
    return Room(outside - inside + (0.5 * solid - 0.5 * ~solid), step * voxel)
