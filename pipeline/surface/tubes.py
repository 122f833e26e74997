"""One center line becomes closed tubes: rings of points on the cylinder, mitred at bends, closed at both ends."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pipeline.geometry.solids import Body
from pipeline.geometry.triangles import Floats, Ints
from pipeline.surface.joints import directions, frames, miter_offsets, polygon_radius, sharp_bends
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.stretches import stretches


@dataclass(frozen=True, slots=True)
class Ends:
    """How the two ends of a center line are closed: ``flat`` or ``hemisphere``."""

    start: str
    stop: str


@dataclass(frozen=True, eq=False, slots=True)
class _Rings:
    """Rings of corners along a mitred center line.

    Parameters
    ----------
    points : (rings, sides, 3) array [m]
    center : (rings, 3) array [m]
        Where the axis goes through each ring's plane.
    piece : (rings,) int array
        Piece of the center line that the band after each ring lies on.
    direction : (pieces, 3) array [-]
    reach : float [m]
        From the axis to the corners.
    """

    points: Floats
    center: Floats
    piece: Ints
    direction: Floats
    reach: float


class Tube(NamedTuple):
    """A closed tube, and whether it begins within the ball that ends the tube before it."""

    body: Body
    in_ball: bool


def tubes(nodes: Floats, radius: float, ends: Ends, settings: SurfaceSettings) -> list[Tube]:
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
    list of Tube
        One tube, unless bends need balls or the fiber runs into itself: then one per stretch between them. Each is
        closed, outward and does not cut itself; the two on a cut that is no ball share its disc, bit by bit.
    """
    balls = sharp_bends(nodes, radius, settings)
    found: list[Tube] = []
    for start, stop in zip([0, *balls], [*balls, len(nodes) - 1], strict=True):
        # the ball on a bend belongs to the stretch before it; the next stretch begins flat inside that ball
        how = Ends(
            ends.start if start == 0 else "flat",
            ends.stop if stop == len(nodes) - 1 else "hemisphere",
        )
        rings = _rings(nodes[start : stop + 1], radius, settings)
        last = len(rings.center) - 1
        points, triangles, band = _closed(rings, 0, last, how)
        cuts = stretches(points, triangles, band, rings.piece, nodes[start : stop + 1], rings.reach)
        for begin, end in zip([0, *cuts], [*cuts, last], strict=True):
            part = Ends(how.start if begin == 0 else "flat", how.stop if end == last else "flat")
            found.append(Tube(_closed(rings, begin, end, part)[:2], in_ball=start > 0 and begin == 0))
    return found


def _rings(nodes: Floats, radius: float, settings: SurfaceSettings) -> _Rings:
    sides = settings.sides
    reach = polygon_radius(radius, sides)
    direction, length = directions(nodes)
    u, v = frames(direction)
    rings = np.maximum(1, np.rint(length / (settings.ring_spacing * 2.0 * radius))).astype(np.int64)

    piece = np.append(np.repeat(np.arange(len(length)), rings), len(length) - 1)
    share = np.append(np.concatenate([np.arange(count) / count for count in rings]), 1.0)
    half = np.arange(len(piece)) % 2
    angle = (np.arange(sides)[None, :] + 0.5 * half[:, None]) * (2.0 * math.pi / sides)
    corner = reach * (np.cos(angle)[..., None] * u[piece][:, None, :] + np.sin(angle)[..., None] * v[piece][:, None, :])
    begin, end = miter_offsets(direction, corner, piece)
    along = (1.0 - share[:, None]) * begin + share[:, None] * (length[piece][:, None] + end)
    points = nodes[piece][:, None, :] + corner + along[..., None] * direction[piece][:, None, :]
    center = nodes[piece] + (share * length[piece])[:, None] * direction[piece]
    center[[0, -1]] = nodes[[0, -1]]
    return _Rings(points, center, piece, direction, reach)


def _closed(rings: _Rings, begin: int, end: int, ends: Ends) -> tuple[Floats, Ints, Ints]:
    """Close the bands between two rings at both of them; give points, triangles, and the band of each triangle."""
    sides = rings.points.shape[1]
    stacked = [rings.points[begin : end + 1].reshape(-1, 3)]
    triangles = [_between_rings(begin, end, sides)]
    band = [np.repeat(np.arange(end - begin), 2 * sides)]
    for forward, how in ((False, ends.start), (True, ends.stop)):
        at = end if forward else begin
        ring = (at - begin) * sides + np.arange(sides)
        axis = rings.direction[rings.piece[at]] * (1.0 if forward else -1.0)
        count = sum(len(part) for part in stacked)
        cap_points, cap = _cap(ring, rings.points[at], rings.center[at], axis, rings.reach, how, count)
        stacked.append(cap_points)
        triangles.append(cap if forward else cap[:, ::-1])
        band.append(np.full(len(cap), end - begin - 1 if forward else 0))
    return np.concatenate(stacked), np.concatenate(triangles), np.concatenate(band)


def _between_rings(begin: int, end: int, sides: int) -> Ints:
    """Triangles of the bands from one ring to another, every second ring turned by half a corner."""
    j = np.arange(sides)
    k = (j + 1) % sides
    even = np.concatenate([np.stack([j, k, j + sides], axis=1), np.stack([k, k + sides, j + sides], axis=1)])
    odd = np.concatenate([np.stack([j, k + sides, j + sides], axis=1), np.stack([j, k, k + sides], axis=1)])
    bands = np.where((np.arange(begin, end) % 2 == 0)[:, None, None], even[None], odd[None])
    triangles: Ints = (bands + sides * np.arange(end - begin)[:, None, None]).reshape(-1, 3)
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
    bands = _between_rings(0, levels - 1, sides)
    top = (levels - 1) * sides
    apex = np.full(sides, count + top)
    crown = np.stack([label[top + j], label[top + k], apex], axis=1)
    return np.concatenate(points), np.concatenate([label[bands], crown])
