"""The surface of fibers that air can meet: their cylinders, without what other fibers cover."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.nouns.arrays import Bools, Floats, Ints
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.structure import SpecificSurface
from pipeline.nouns.surface import Surface

_AROUND = 32
"""Points around a fiber; along it there are four to a radius."""
_COVERED = 1e-6
"""Radii within another fiber from which on a point is covered."""


def specific_surface(surface: Surface, density: float | None) -> SpecificSurface:
    """Give the surface of a slab's fibers.

    Parameters
    ----------
    surface : Surface
        Of fibers with known axes, whose true cylinders count, or of a body, whose triangles do.
    density : float [kg/m3], optional
        Of the fibers' material.

    Returns
    -------
    SpecificSurface
    """
    area = fiber_area(surface) if len(surface.pieces) else surface.free_area
    per_solid = area / surface.volume
    return SpecificSurface(
        per_volume=area / surface.slab.volume,
        per_solid=per_solid,
        per_mass=None if density is None else per_solid / density,
    )


def fiber_area(surface: Surface) -> float:
    """Area of the fibers' cylinders and ends within the plan that no other fiber covers [m2].

    Parameters
    ----------
    surface : Surface
        Of fibers with known axes.

    Returns
    -------
    float [m2]
        Straight pieces meet in miters, whose area is that of the pieces; what fibers cover is known to a share of
        their own surface of about 1 over the points on them. Where a fiber runs into itself, both surfaces count.
    """
    # numba takes half a second to load
    from pipeline.geometry.fibers import FiberDistance

    pieces, radius = surface.pieces, surface.radius[surface.pieces.fiber]
    lower, upper = np.array(surface.slab.lower), np.array(surface.slab.upper)
    places, share, piece = (
        np.concatenate(parts)
        for parts in zip(_sides(pieces, radius, lower, upper), _ends(pieces, radius, lower, upper), strict=True)
    )
    above = np.array([0.0, 0.0, float(radius.max())])
    distance = FiberDistance.about(
        pieces.start, pieces.end, radius, pieces.flat, pieces.fiber, 0.01 * radius, lower - above, upper + above
    )
    depth, nearest = distance.with_piece(places)
    covered = (depth < -_COVERED * radius[piece]) & (pieces.fiber[nearest] != pieces.fiber[piece])
    return float(share[~covered].sum())


def _sides(pieces: Pieces, radius: Floats, lower: Floats, upper: Floats) -> tuple[Floats, Floats, Ints]:
    """Points on the cylinders, the area within the plan that each stands for, and its piece."""
    line = pieces.end - pieces.start
    length = np.linalg.norm(line, axis=1)
    along = line / length[:, None]
    aside = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)])
    aside /= np.linalg.norm(aside, axis=1)[:, None]
    across = np.cross(along, aside)
    rings = np.maximum(1, np.ceil(4.0 * length / radius)).astype(np.int64)
    piece = np.repeat(np.arange(len(pieces)), rings)
    number = np.arange(len(piece)) - np.repeat(np.cumsum(rings) - rings, rings)
    # turned from ring to ring, so that no row of points follows an edge
    angle = 2.0 * math.pi * ((np.arange(_AROUND) + 0.5) / _AROUND + 0.6180339887 * number[:, None])
    spread = np.cos(angle)[..., None] * aside[piece][:, None] + np.sin(angle)[..., None] * across[piece][:, None]
    spread = (radius[piece][:, None, None] * spread).reshape(-1, 3)
    piece, number = np.repeat(piece, _AROUND), np.repeat(number, _AROUND)
    first, last = _within(pieces.start[piece] + spread, line[piece], lower, upper)
    step = 1.0 / rings[piece]
    share = np.clip(np.minimum(last, (number + 1) * step) - np.maximum(first, number * step), 0.0, None) / step
    places = pieces.start[piece] + spread + ((number + 0.5) * step)[:, None] * line[piece]
    area = share * (2.0 * math.pi * radius * length / (rings * _AROUND))[piece]
    kept = area > 0.0
    return places[kept], area[kept], piece[kept]


def _within(start: Floats, line: Floats, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
    """Shares of lines at which they enter and leave the plan; the second below the first where they miss it."""
    first, last = np.zeros(len(start)), np.ones(len(start))
    for axis in (0, 1):
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = ((side[axis] - start[:, axis]) / line[:, axis] for side in (lower, upper))
        level = line[:, axis] == 0.0
        aside = level & ((start[:, axis] < lower[axis]) | (start[:, axis] > upper[axis]))
        first = np.where(level, np.where(aside, 2.0, first), np.maximum(first, np.minimum(one, other)))
        last = np.where(level, last, np.minimum(last, np.maximum(one, other)))
    return first, last


def _ends(pieces: Pieces, radius: Floats, lower: Floats, upper: Floats) -> tuple[Floats, Floats, Ints]:
    """Middles of the fibers' ends within the plan, the area of their caps, and their pieces."""
    ends = np.concatenate([pieces.start, pieces.end])
    _, index, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    inside = ((ends > lower) & (ends < upper))[:, :2].all(axis=1)
    alone: Bools = (count[index.reshape(-1)] == 1) & inside
    piece = np.tile(np.arange(len(pieces)), 2)[alone]
    flat = pieces.flat.T.ravel()[alone]
    return ends[alone], math.pi * radius[piece] ** 2 * np.where(flat, 1.0, 2.0), piece
