"""One center line becomes closed tubes: rings of points on the cylinder, mitred at bends, closed at both ends."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.geometry.solids import Body
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


@dataclass(frozen=True, slots=True)
class Ends:
    """How the two ends of a center line are closed: ``flat`` or ``hemisphere``."""

    start: str
    stop: str


def tubes(nodes: Floats, radius: float, ends: Ends, settings: SurfaceSettings) -> list[Body]:
    """Build the closed tubes whose union is one fiber.

    Parameters
    ----------
    nodes : (n, 3) array [m]
        The center line.
    radius : float [m]
    ends : Ends
    settings : SurfaceSettings

    Returns
    -------
    list of (points, triangles)
        One tube where every bend can be mitred, else one per stretch between spherical joints; each is closed,
        outward and does not cut itself between neighboring rings.
    """
    breaks = _breaks(nodes, radius, settings)
    stops = [*breaks, len(nodes) - 1]
    starts = [0, *breaks]
    return [
        _tube(
            nodes[start : stop + 1],
            radius,
            # the ball on a bend belongs to the stretch before it; the next stretch begins flat inside that ball
            Ends(
                ends.start if start == 0 else "flat",
                ends.stop if stop == len(nodes) - 1 else "hemisphere",
            ),
            settings,
        )
        for start, stop in zip(starts, stops, strict=True)
    ]


def _directions(nodes: Floats) -> tuple[Floats, Floats]:
    step = np.diff(nodes, axis=0)
    length = np.linalg.norm(step, axis=1)
    return step / length[:, None], length


def _frames(direction: Floats) -> tuple[Floats, Floats]:
    # carried from piece to piece by the smallest rotation: corners stay on their own line through every bend
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


def _breaks(nodes: Floats, radius: float, settings: SurfaceSettings) -> list[int]:
    """Find the inner nodes that need a sphere."""
    inner = np.arange(1, len(nodes) - 1)
    if settings.joint == "sphere":
        return [int(k) for k in inner]
    direction, length = _directions(nodes)
    cosine = np.clip(np.einsum("ij,ij->i", direction[:-1], direction[1:]), -1.0, 1.0)
    broken = np.zeros(len(nodes), dtype=bool)
    broken[inner] = cosine < math.cos(SHARPEST_MITER)
    u, v = _frames(direction)
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


def _tube(nodes: Floats, radius: float, ends: Ends, settings: SurfaceSettings) -> Body:
    sides = settings.sides
    reach = polygon_radius(radius, sides)
    direction, length = _directions(nodes)
    u, v = _frames(direction)
    rings = np.maximum(1, np.rint(length / (settings.ring_spacing * 2.0 * radius))).astype(np.int64)

    piece = np.append(np.repeat(np.arange(len(length)), rings), len(length) - 1)
    share = np.append(np.concatenate([np.arange(count) / count for count in rings]), 1.0)
    half = np.arange(len(piece)) % 2
    angle = (np.arange(sides)[None, :] + 0.5 * half[:, None]) * (2.0 * math.pi / sides)
    corner = reach * (np.cos(angle)[..., None] * u[piece][:, None, :] + np.sin(angle)[..., None] * v[piece][:, None, :])
    begin, end = _runs(direction, corner, piece)
    along = (1.0 - share[:, None]) * begin + share[:, None] * (length[piece][:, None] + end)
    points = nodes[piece][:, None, :] + corner + along[..., None] * direction[piece][:, None, :]

    stacked = [points.reshape(-1, 3)]
    triangles = [_between_rings(len(piece), sides)]
    for forward, how in ((False, ends.start), (True, ends.stop)):
        ring = (len(piece) - 1 if forward else 0) * sides + np.arange(sides)
        k = -1 if forward else 0
        axis = direction[k] if forward else -direction[k]
        count = sum(len(part) for part in stacked)
        cap_points, cap = _cap(ring, points[k], nodes[k], axis, reach, how, count)
        stacked.append(cap_points)
        triangles.append(cap if forward else cap[:, ::-1])
    return np.concatenate(stacked), np.concatenate(triangles)


def _runs(direction: Floats, corner: Floats, piece: Ints) -> tuple[Floats, Floats]:
    """Give the miter offsets at both ends of the piece that each ring lies on, for that ring's own corners."""
    begin = np.zeros(corner.shape[:2])
    end = np.zeros(corner.shape[:2])
    last = len(direction) - 1
    for offset, neighbor, has in ((begin, piece - 1, piece > 0), (end, piece + 1, piece < last)):
        own = direction[piece[has]]
        plane = own + direction[neighbor[has]]
        offset[has] = -np.einsum("ikj,ij->ik", corner[has], plane) / np.einsum("ij,ij->i", own, plane)[:, None]
    return begin, end


def _between_rings(rings: int, sides: int) -> Ints:
    """Triangles of the bands between successive rings, every second ring turned by half a corner."""
    j = np.arange(sides)
    k = (j + 1) % sides
    even = np.concatenate([np.stack([j, k, j + sides], axis=1), np.stack([k, k + sides, j + sides], axis=1)])
    odd = np.concatenate([np.stack([j, k + sides, j + sides], axis=1), np.stack([j, k, k + sides], axis=1)])
    bands = np.where((np.arange(rings - 1) % 2 == 0)[:, None, None], even[None], odd[None])
    triangles: Ints = (bands + sides * np.arange(rings - 1)[:, None, None]).reshape(-1, 3)
    return triangles


def _cap(
    ring: Ints, rim: Floats, center: Floats, axis: Floats, reach: float, how: str, count: int
) -> tuple[Floats, Ints]:
    """Close a ring, counterclockwise about `axis`, with a disc or half ball; its points are numbered from `count`."""
    sides = len(ring)
    following = np.roll(ring, -1)
    if how == "flat":
        apex = np.full(sides, count)
        return center[None, :], np.stack([ring, following, apex], axis=1)
    # latitudes as far apart as the corners, each turned by half a corner against the one below
    levels = max(2, round(sides / 4))
    radial = rim - center
    between = radial + np.roll(radial, -1, axis=0)
    between *= reach / np.linalg.norm(between, axis=1)[:, None]
    points = []
    for level in range(1, levels):
        latitude = 0.5 * math.pi * level / levels
        outward = between if level % 2 else radial
        points.append(center + math.cos(latitude) * outward + math.sin(latitude) * reach * axis)
    points.append((center + reach * axis)[None, :])
    j = np.arange(sides)
    k = (j + 1) % sides
    label = np.concatenate([ring, count + np.arange((levels - 1) * sides)])
    bands = _between_rings(levels, sides)
    top = (levels - 1) * sides
    apex = np.full(sides, count + top)
    crown = np.stack([label[top + j], label[top + k], apex], axis=1)
    return np.concatenate(points), np.concatenate([label[bands], crown])
