"""Spheres in the air between solid voxels: how large a one reaches each voxel, and how large a one gets there.

Compiled by numba: imported only where pores are measured. Lengths are in voxels. The ends of the medium are across z;
on the sides, across x and y, it goes on, as its mirror image or by periods.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import heapq
import math

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats

_COVERED = 0.1
"""Voxels by which a sphere may stick out of a neighbor's and yet be left out: distances are known to about as much."""


@compiled
def _folded(index: int, count: int, periodic: bool) -> int:
    """Voxel within the medium that one beyond its side stands for."""
    if 0 <= index < count:
        return index
    if periodic:
        return index % count
    index %= 2 * count
    return index if index < count else 2 * count - 1 - index


@compiled
def _matters(room: Floats, x: int, y: int, z: int) -> bool:
    """Whether no neighbor's sphere covers this one."""
    own = room[x, y, z]
    for i in range(max(x - 1, 0), min(x + 2, room.shape[0])):
        for j in range(max(y - 1, 0), min(y + 2, room.shape[1])):
            for k in range(max(z - 1, 0), min(z + 2, room.shape[2])):
                step = math.sqrt((i - x) ** 2 + (j - y) ** 2 + (k - z) ** 2)
                if step > 0.0 and room[i, j, k] >= own + step - _COVERED:
                    return False
    return True


@compiled
def covered_by(room: Floats, value: Floats, periodic: bool) -> Floats:
    """Give each voxel the largest value among the spheres that cover its middle.

    Parameters
    ----------
    room : (x, y, z) array
        Distance from each voxel's middle to the solid, 0 or less within it: the radius of its sphere.
    value : (x, y, z) array
        Of the sphere about each voxel; not above what a sphere that covers this one has.
    periodic : bool
        Whether the medium goes on by periods; else as its mirror image.

    Returns
    -------
    (x, y, z) array
        0 where no sphere reaches.
    """
    nx, ny, nz = room.shape
    found = np.zeros(room.shape)
    for x in range(nx):
        for y in range(ny):
            for z in range(nz):
                radius, own = room[x, y, z], value[x, y, z]
                if radius <= 0.0 or own <= 0.0 or not _matters(room, x, y, z):
                    continue
                reach = int(radius)
                for i in range(-reach, reach + 1):
                    across = int(math.sqrt(radius * radius - i * i))
                    u = _folded(x + i, nx, periodic)
                    for j in range(-across, across + 1):
                        v = _folded(y + j, ny, periodic)
                        half = int(math.sqrt(max(radius * radius - i * i - j * j, 0.0)))
                        for w in range(max(z - half, 0), min(z + half + 1, nz)):
                            if found[u, v, w] < own:
                                found[u, v, w] = own
    return found


@compiled
def widest_way(room: Floats, periodic: bool) -> Floats:
    """Give each voxel the largest sphere whose middle finds a way to it from the end at the lowest z.

    Parameters
    ----------
    room : (x, y, z) array
        Distance from each voxel's middle to the solid, 0 or less within it.
    periodic : bool
        Whether a way leads on from a side to the opposite one.

    Returns
    -------
    (x, y, z) array
        Radius; 0 where there is no way.

    Notes
    -----
    Voxels are taken by falling radius, so each is reached first by its widest way (Dijkstra's algorithm).
    """
    nx, ny, nz = room.shape
    found = np.zeros(room.shape)
    waiting = [(0.0, 0)]
    waiting.clear()
    for x in range(nx):
        for y in range(ny):
            if room[x, y, 0] > 0.0:
                found[x, y, 0] = room[x, y, 0]
                waiting.append((-room[x, y, 0], (x * ny + y) * nz))
    heapq.heapify(waiting)
    while len(waiting) > 0:
        least, place = heapq.heappop(waiting)
        x, y, z = place // (ny * nz), (place // nz) % ny, place % nz
        for i in range(x - 1, x + 2):
            for j in range(y - 1, y + 2):
                if not periodic and (i < 0 or i >= nx or j < 0 or j >= ny):
                    continue
                u, v = i % nx, j % ny
                for w in range(max(z - 1, 0), min(z + 2, nz)):
                    if room[u, v, w] > 0.0 and found[u, v, w] == 0.0:
                        found[u, v, w] = min(-least, room[u, v, w])
                        heapq.heappush(waiting, (-found[u, v, w], (u * ny + v) * nz + w))
    return found
