"""The surface of solid voxels: smooth, closed, flush with the window, and of the voxels' volume.

Marching cubes on the smoothed solid; smoothing shrinks what is convex, so the level is searched at which the surface
encloses as much as the voxels do.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
from scipy.ndimage import gaussian_filter

from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.geometry.solids import unite_within
from pipeline.geometry.triangles import connected_pieces, enclosed_volume, signed_volumes
from pipeline.nouns.arrays import Floats, Ints
from pipeline.tomography.solid import Solid

SMOOTHING = 0.8
"""Standard deviation of the smoothing, in voxels: the steps of voxels are one voxel wide."""
_PAD = 2
_LEVELS = (0.5, 0.44)
"""Levels between which that of the right volume lies, or not far beyond."""
_FEWEST = 4.0
"""Voxels across the mean fiber below which the surface is none of the fiber's."""


def surface_of(solid: Solid, voxel: float) -> tuple[Floats, Ints]:
    """Give the surface of solid voxels.

    Parameters
    ----------
    solid : (x, y, z) bool array
    voxel : float [m]
        Edge of a voxel.

    Returns
    -------
    points : (n, 3) array [m]
        The window reaches from the origin to its size.
    triangles : (m, 3) int array
        Outward, closed; voids that no air reaches are filled.

    Raises
    ------
    CaseError
        If fibers have too few voxels.
    """
    # beyond the window the solid goes on, so that it is cut there and not rounded off
    whole = np.pad(np.pad(solid, _PAD, mode="edge"), 1)
    field = gaussian_filter(whole.astype(np.float32), SMOOTHING)
    limits = Box((0.0, 0.0, 0.0), (solid.shape[0] * voxel, solid.shape[1] * voxel, solid.shape[2] * voxel))

    def at(level: float) -> tuple[Floats, Ints, Ints]:
        points, triangles = _contour(field, level)
        # the middle of the window's first voxel lies half a voxel inside
        return unite_within(_shells((points - (_PAD + 1) + 0.5) * voxel, triangles), limits)

    wanted = float(solid.sum()) * voxel**3
    volumes = [enclosed_volume(*at(level)[:2]) / wanted - 1.0 for level in _LEVELS]
    # nearly a straight line: a voxel's level moves the surface by a fixed part of a voxel
    slope = (volumes[1] - volumes[0]) / (_LEVELS[1] - _LEVELS[0])
    level = min(max(_LEVELS[0] - volumes[0] / slope, 0.2), 0.8) if slope < 0 else 0.5
    cut, faces, origin = at(level)
    corners = cut[faces[origin >= 0]]
    area = (
        float(np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()) / 2
    )
    diameter = 4.0 * enclosed_volume(cut, faces) / area / voxel
    if diameter < _FEWEST:
        raise CaseError(
            f"the mean fiber is {diameter:.1f} voxels thick, and {_FEWEST:g} are the least: take a finer tomogram"
        )
    return cut, faces


def _contour(field: np.ndarray[tuple[int, ...], np.dtype[np.float32]], level: float) -> tuple[Floats, Ints]:
    from skimage.measure import marching_cubes

    points, triangles, _, _ = marching_cubes(field, level, allow_degenerate=False)
    points, triangles = points.astype(np.float64), triangles.astype(np.int64)
    return points, triangles if enclosed_volume(points, triangles) > 0 else triangles[:, ::-1]


def _shells(points: Floats, triangles: Ints) -> list[tuple[Floats, Ints]]:
    """Part a surface into its outer shells; inner ones bound voids, which count as solid."""
    piece = connected_pieces(triangles)
    volume = np.bincount(piece, weights=signed_volumes(points, triangles))
    order = np.argsort(piece, kind="stable")
    starts = np.searchsorted(piece[order], np.arange(len(volume) + 1))
    shells = []
    for k in np.flatnonzero(volume > 0):
        used, index = np.unique(triangles[order[starts[k] : starts[k + 1]]], return_inverse=True)
        shells.append((points[used], index.reshape(-1, 3)))
    return shells
