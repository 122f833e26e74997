"""The surface of solid voxels: smooth, closed, flush with the window, and of the voxels' volume.

Marching cubes on the smoothed solid, on cells no finer than a surface of fibers needs; smoothing shrinks what is
convex, so the level is searched at which the surface encloses as much as the voxels do.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter

from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.geometry.solids import unite_within
from pipeline.geometry.triangles import connected_pieces, enclosed_volume, signed_volumes
from pipeline.nouns.arrays import Floats, Ints
from pipeline.tomography.solid import Solid

Field = npt.NDArray[np.float32]
SMOOTHING = 0.8
"""Standard deviation of the smoothing, in voxels: the steps of voxels are one voxel wide."""
CELLS = 6.0
"""Cells of the contour to a mean fiber diameter: chords then lie within a hundredth of it, and meshing stays quick."""
_ANTIALIASING = 0.5  # standard deviation of the smoothing in cells, where they are coarser than voxels
_PAD = 2  # cells beyond the window, in which the solid goes on
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
    diameter = _mean_diameter(solid)
    if diameter < _FEWEST:
        raise CaseError(
            f"the mean fiber is {diameter:.1f} voxels thick, and {_FEWEST:g} are the least: take a finer tomogram"
        )
    counts = [max(1, round(count * min(1.0, CELLS / diameter))) for count in solid.shape]
    cell = np.array(solid.shape) / counts
    field = _field(solid, counts)
    limits = Box((0.0, 0.0, 0.0), (solid.shape[0] * voxel, solid.shape[1] * voxel, solid.shape[2] * voxel))

    def at(level: float) -> tuple[Floats, Ints, Ints]:
        points, triangles = _contour(field, level)
        # the middle of the window's first cell lies half a cell inside
        return unite_within(_shells((points - (_PAD + 1) + 0.5) * cell * voxel, triangles), limits)

    wanted = float(solid.sum()) * voxel**3
    volumes = [enclosed_volume(*at(level)[:2]) / wanted - 1.0 for level in _LEVELS]
    # nearly a straight line: a step of the level moves the surface by a fixed part of a cell
    slope = (volumes[1] - volumes[0]) / (_LEVELS[1] - _LEVELS[0])
    level = min(max(_LEVELS[0] - volumes[0] / slope, 0.2), 0.8) if slope < 0 else 0.5
    cut, faces, _ = at(level)
    return cut, faces


def _mean_diameter(solid: Solid) -> float:
    """Four times volume over area [voxel]; voxels show three halves of the area of what lies in all directions."""
    faces = sum(int(np.count_nonzero(np.diff(solid, axis=axis))) for axis in range(3))
    return 4.0 * int(solid.sum()) / max(faces / 1.5, 1e-300)


def _field(solid: Solid, counts: list[int]) -> Field:
    """Smooth the solid and sample it in the middles of cells, two of them beyond the window; there, air begins."""
    widest = max(size / count for size, count in zip(solid.shape, counts, strict=True))
    # so that it is cut at the window's sides and not rounded off
    around = math.ceil((_PAD + 1) * widest)
    whole = np.pad(solid, around, mode="edge").astype(np.float32)
    smooth = gaussian_filter(whole, max(SMOOTHING, _ANTIALIASING * widest if widest > 1.0 else 0.0))
    for axis, count in enumerate(counts):
        at = (np.arange(-_PAD, count + _PAD) + 0.5) * solid.shape[axis] / count - 0.5 + around
        low = np.floor(at).astype(np.int64)
        share = (at - low).astype(np.float32).reshape([-1 if each == axis else 1 for each in range(3)])
        smooth = (1 - share) * np.take(smooth, low, axis) + share * np.take(smooth, low + 1, axis)
    return np.pad(smooth, 1)


def _contour(field: Field, level: float) -> tuple[Floats, Ints]:
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
