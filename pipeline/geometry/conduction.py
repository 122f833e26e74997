"""Steady conduction through voxels that are open in part: Laplace's equation by finite volumes."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.parts import parts
from pipeline.geometry.triangles import Floats

_TOLERANCE = 1e-6
_SMALL = 100  # unknowns below which a level of multigrid is solved directly


def open_faces(room: Floats, axis: int, periodic: bool) -> Floats:
    r"""Give the open share of the faces between neighboring voxels.

    Parameters
    ----------
    room : (x, y, z) array [voxel]
        Signed distance from each voxel's middle to the solid, negative within it.
    axis : int
        Which the faces lie across.
    periodic : bool
        Whether the last voxel's neighbor is the first one; else there is a face less than there are voxels.

    Returns
    -------
    array [-]

    Notes
    -----
    A plane wall at the distance :math:`\phi` from the face's middle, of the normal :math:`n`, leaves about
    :math:`\tfrac12 + \phi / (|n_u| + |n_v|)` of it open, between 0 and 1, with :math:`n_u, n_v` along the face.
    """
    width = _between(_width(room, [each for each in range(3) if each != axis]), axis, periodic)
    return _open(_between(room, axis, periodic), width)


def open_volumes(room: Floats) -> Floats:
    """Give the open share of voxels, as `open_faces` does of faces, (x, y, z) array [-]."""
    return _open(room, _width(room, [0, 1, 2]))


def _open(room: Floats, width: Floats) -> Floats:
    return np.asarray(np.clip(0.5 + room / np.maximum(width, 0.1), 0.0, 1.0))


def _width(room: Floats, axes: list[int]) -> Floats:
    """Sum of the normal's parts along some axes, without their signs."""
    # a single layer goes on as it is
    parts = [
        np.abs(np.gradient(room, axis=axis)) if room.shape[axis] > 1 else np.zeros(room.shape) for axis in range(3)
    ]
    size = np.sqrt(sum((part**2 for part in parts), np.zeros(room.shape)))
    return np.asarray(sum((parts[axis] for axis in axes), np.zeros(room.shape)) / np.maximum(size, 1e-12))


def _between(values: Floats, axis: int, periodic: bool) -> Floats:
    following = np.roll(values, -1, axis)
    mean = 0.5 * (values + following)
    return mean if periodic else np.take(mean, np.arange(values.shape[axis] - 1), axis)


def conductance_through(conductivity: Floats, room: Floats, periodic: bool) -> float:
    """Give what flows along z through voxels between ends that differ by 1.

    Parameters
    ----------
    conductivity : (x, y, z) array
        Of what is open of each voxel; 0 where nothing passes.
    room : (x, y, z) array [voxel]
        Signed distance from each voxel's middle to the solid.
    periodic : bool
        Whether x and y wrap; else nothing passes the sides.

    Returns
    -------
    float
        Times a voxel's edge; 0 where nothing leads through.
    """
    import pyamg
    from scipy.sparse import csr_matrix

    nz = room.shape[2]
    number = np.arange(room.size).reshape(room.shape)
    one, two, through = [], [], []
    for axis in range(3):
        wraps = periodic and axis < 2
        here = number if wraps else np.take(number, np.arange(room.shape[axis] - 1), axis)
        there = np.roll(number, -1, axis) if wraps else np.take(number, np.arange(1, room.shape[axis]), axis)
        a, b = conductivity.flat[here], conductivity.flat[there]
        # two halves of a way, one after the other
        share = open_faces(room, axis, wraps) * 2.0 * a * b / np.maximum(a + b, 1e-300)
        kept = share > 0.0
        one.append(here[kept])
        two.append(there[kept])
        through.append(share[kept])
    first, second, value = np.concatenate(one), np.concatenate(two), np.concatenate(through)
    part = parts(first, second, room.size)[1].reshape(room.shape)
    open_end = _open(room, _width(room, [0, 1]))
    ends = [2.0 * conductivity[:, :, k] * open_end[:, :, k] for k in (0, nz - 1)]
    leads = np.intersect1d(part[:, :, 0][ends[0] > 0], part[:, :, -1][ends[1] > 0])
    inside = np.flatnonzero(np.isin(part, leads))
    if len(leads) == 0:
        return 0.0
    place = np.full(room.size, -1)
    place[inside] = np.arange(len(inside))
    # both ends of a face belong to one part
    kept = place[first] >= 0
    first, second, value = place[first[kept]], place[second[kept]], value[kept]
    end = np.zeros(room.shape)
    end[:, :, 0] += ends[0]
    source = end.copy().ravel()[inside]
    end[:, :, -1] += ends[1]
    count = len(inside)
    diagonal = np.bincount(first, value, count) + np.bincount(second, value, count) + end.ravel()[inside]
    everyone = np.arange(count)
    matrix = csr_matrix(
        (
            np.concatenate([-value, -value, diagonal]),
            (np.concatenate([first, second, everyone]), np.concatenate([second, first, everyone])),
        ),
        shape=(count, count),
    )
    levels = pyamg.ruge_stuben_solver(matrix, max_coarse=_SMALL, coarse_solver="splu")
    start = np.broadcast_to(1.0 - (np.arange(nz) + 0.5) / nz, room.shape).ravel()[inside]
    found = levels.solve(source, x0=start, tol=_TOLERANCE, accel="cg")
    return float((source * (1.0 - found)).sum())
