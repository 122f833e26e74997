"""How the solid of a mat is spread over its thickness."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats
from pipeline.nouns.fibers import Mat


def solidity_profile(mat: Mat, share: Floats, layers: int) -> Floats:
    """Give the solidity of each of equally thick layers of the slab, cylinders summed.

    The volume of a long inclined cylinder below a height z is known in closed form: of the cross-section whose middle
    is u radii below z, the share 1/2 + (u sqrt(1 - u^2) + asin u) / pi lies below z, and the mean of that over the
    heights of the axis is a difference of its integral.

    Parameters
    ----------
    mat : Mat
    share : (segments,) array [-]
        Part of each segment that counts.
    layers : int

    Returns
    -------
    (layers,) array [-]
        Its mean is the nominal solidity, less what reaches out of the slab.
    """
    start = mat.segment_starts()
    lengths = mat.segment_lengths()
    radius = mat.radius[mat.segment_fibers()]
    z0, z1 = mat.nodes[start, 2] - mat.slab.lower[2], mat.nodes[start + 1, 2] - mat.slab.lower[2]
    level = np.sqrt(np.maximum(1.0 - ((z1 - z0) / lengths) ** 2, 1e-12))
    volume = share * np.pi * radius**2 * lengths
    thickness = mat.thickness / layers
    below: Floats = np.zeros(layers + 1)
    _fill(z0, z1, radius * level, volume, thickness, below)
    return np.diff(below) / (mat.slab.face_area * thickness)


@compiled
def _fill(z0: Floats, z1: Floats, radius: Floats, volume: Floats, thickness: float, below: Floats) -> None:
    """Add the volume of each segment below each layer's upper side to `below`."""
    for k in range(len(z0)):
        low, high = min(z0[k], z1[k]), max(z0[k], z1[k])
        first = min(max(int(np.floor((low - radius[k]) / thickness)), 0), len(below) - 1)
        for edge in range(first, len(below)):
            upper, lower = (edge * thickness - low) / radius[k], (edge * thickness - high) / radius[k]
            if lower >= 1.0:
                below[edge:] += volume[k]
                break
            if upper - lower < 1e-4:
                part = _part_below(0.5 * (upper + lower))
            else:
                part = (_summed(upper) - _summed(lower)) / (upper - lower)
            below[edge] += part * volume[k]


@compiled
def _part_below(u: float) -> float:
    """Share of a disc below a line u radii above its middle."""
    u = min(max(u, -1.0), 1.0)
    return float(0.5 + (u * np.sqrt(1.0 - u * u) + np.arcsin(u)) / np.pi)


@compiled
def _summed(u: float) -> float:
    """Integral of `_part_below` from -1 to u."""
    if u <= -1.0:
        return 0.0
    if u >= 1.0:
        return u
    root = np.sqrt(1.0 - u * u)
    return float(0.5 * u + (root - root**3 / 3.0 + u * np.arcsin(u)) / np.pi)
