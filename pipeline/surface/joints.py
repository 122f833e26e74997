"""Where the pieces of a center line meet: frames carried along it, miters at its bends, and bends too sharp for one."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import numpy.typing as npt

from pipeline.geometry.triangles import Floats, Ints
from pipeline.surface.settings import SurfaceSettings

SHARPEST_MITER = 2.0 * math.pi / 3.0
"""Turn [rad] beyond which a bend gets a sphere: there a miter's tip is two radii from the bend."""


def polygon_radius(radius: float, sides: int) -> float:
    r"""Distance from axis to corners so that a tube has the cylinder's volume.

    Successive rings are turned by half a corner, so that the surface between them is an antiprism's. By the
    prismatoid rule its mean cross-section is

    .. math:: \bar A = \tfrac{n}{3} R^2 \sin\tfrac{\pi}{n} \left(1 + 2 \cos\tfrac{\pi}{n}\right),

    one third of the polygon with n corners and two thirds of the one with 2n corners half way.

    Parameters
    ----------
    radius : float [m]
    sides : int
        n, 3 or more.

    Returns
    -------
    float [m]
        :math:`R`.

    Examples
    --------
    >>> round(polygon_radius(1.0, 12), 5)
    1.01736
    """
    angle = math.pi / sides
    return radius * math.sqrt(3.0 * angle / (math.sin(angle) * (1.0 + 2.0 * math.cos(angle))))


def directions(nodes: Floats) -> tuple[Floats, Floats]:
    """Give the unit direction and the length [m] of each piece of a center line."""
    step = np.diff(nodes, axis=0)
    length = np.linalg.norm(step, axis=1)
    return step / length[:, None], length


def frames(direction: Floats) -> tuple[Floats, Floats]:
    """Give two unit vectors across each piece, carried from one to the next by the smallest rotation."""
    # corners stay on their own line through every bend
    first = direction[0]
    across = np.array([-first[1], first[0], 0.0])
    if np.linalg.norm(across) < 1e-6:
        across = np.array([1.0, 0.0, 0.0]) - first[0] * first
    u = np.empty_like(direction)
    u[0] = across / np.linalg.norm(across)
    for k in range(1, len(direction)):
        before, after = direction[k - 1], direction[k]
        both = before + after
        turn = 1.0 + before @ after
        if turn < 1e-6:  # straight back: any frame will do, a sphere sits there
            u[k] = u[k - 1]
        else:
            u[k] = u[k - 1] - (u[k - 1] @ after) / turn * both
        u[k] -= (u[k] @ after) * after
        u[k] /= np.linalg.norm(u[k])
    return u, np.cross(direction, u)


def sharp_bends(nodes: Floats, radius: float, settings: SurfaceSettings) -> list[int]:
    """Find the inner nodes that need a sphere."""
    inner = np.arange(1, len(nodes) - 1)
    if settings.joint == "sphere":
        return [int(k) for k in inner]
    direction, length = directions(nodes)
    cosine = np.clip(np.einsum("ij,ij->i", direction[:-1], direction[1:]), -1.0, 1.0)
    broken = np.zeros(len(nodes), dtype=bool)
    broken[inner] = cosine < math.cos(SHARPEST_MITER)
    u, v = frames(direction)
    angle = np.arange(2 * settings.sides) * math.pi / settings.sides
    corner = polygon_radius(radius, settings.sides) * (
        np.cos(angle)[None, :, None] * u[:, None, :] + np.sin(angle)[None, :, None] * v[:, None, :]
    )
    while True:
        start, stop = _miters(direction, corner, broken)
        # a piece too short for its two miters: they would cross and turn the tube inside out
        crossed = (length[:, None] + stop - start).min(axis=1) < 0.02 * radius
        ends = np.zeros(len(nodes), dtype=bool)
        ends[:-1] |= crossed
        ends[1:] |= crossed
        ends[[0, -1]] = False
        if not (ends & ~broken).any():
            return [int(k) for k in np.flatnonzero(broken)]
        broken |= ends


def _miters(direction: Floats, corner: Floats, broken: npt.NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """How far along its piece each corner line runs past the piece's start and stop, (pieces, corners) each."""
    start = np.zeros(corner.shape[:2])
    stop = np.zeros(corner.shape[:2])
    plane = direction[:-1] + direction[1:]
    mitred = ~broken[1:-1]
    for offset, piece in ((stop[:-1], slice(None, -1)), (start[1:], slice(1, None))):
        along = np.einsum("ij,ij->i", direction[piece], plane)
        run = -np.einsum("ikj,ij->ik", corner[piece], plane) / np.where(mitred, along, 1.0)[:, None]
        offset[mitred] = run[mitred]
    return start, stop


def miter_offsets(direction: Floats, corner: Floats, piece: Ints) -> tuple[Floats, Floats]:
    """Give the miter offsets at both ends of the piece that each ring lies on, for that ring's own corners."""
    begin = np.zeros(corner.shape[:2])
    end = np.zeros(corner.shape[:2])
    last = len(direction) - 1
    for offset, neighbor, has in ((begin, piece - 1, piece > 0), (end, piece + 1, piece < last)):
        own = direction[piece[has]]
        plane = own + direction[neighbor[has]]
        offset[has] = -np.einsum("ikj,ij->ik", corner[has], plane) / np.einsum("ij,ij->i", own, plane)[:, None]
    return begin, end
