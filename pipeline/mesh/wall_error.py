"""Measure where the walls of a mesh stand against the true fibers, fiber by fiber."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools

import numpy as np

from pipeline.geometry.sections import fan
from pipeline.geometry.triangles import area_vectors
from pipeline.mesh.distance import fiber_distance
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fidelity import NEAREST, FiberWalls, Fidelity
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS

_STEP = 0.25  # of its diameters between the places on a fiber's axis that are looked at


def fidelity(mesh: FaceMesh, domain: FluidDomain) -> Fidelity:
    """Measure the walls of a mesh against the fibers.

    Walls are sampled at three points of every triangle, by the rule that integrates quadratics exactly: how far each
    is from the nearest fiber, in that one's diameters, counts to the fiber of its face. A fiber's axis is sampled
    every quarter of its diameter.

    Parameters
    ----------
    mesh : FaceMesh
        Whose wall faces name their fiber.
    domain : FluidDomain
        What it was made of.

    Returns
    -------
    Fidelity
    """
    diameter = 2.0 * domain.radius
    if len(domain.pieces) == 0:
        points, triangles, _ = _walls_of(mesh)
        return _beside_surface(*_samples(points, triangles), domain)
    points, triangles, fiber, own, area = _sampled(mesh, domain)
    away = np.abs(own)
    in_air = _axis_in_air(points, triangles, domain)
    # the samples of each fiber stand together, nearest first
    order = np.lexsort((away, fiber))
    starts = np.searchsorted(fiber[order], np.arange(len(diameter) + 1))
    return Fidelity(
        mean_deviation=float(away @ area / area.sum()),
        typical_deviation=_within(away, area, 0.99),
        largest_deviation=float(away.max()),
        fibers=tuple(
            _walls(k, diameter[k], own[order[begin:end]], area[order[begin:end]], in_air[k])
            for k, (begin, end) in enumerate(itertools.pairwise(starts))
        ),
    )


def wall_deviation(mesh: FaceMesh, domain: FluidDomain) -> tuple[float, float, float]:
    """Give how far the walls of a mesh, or of a part of one, stand off the fibers, each in their own diameters.

    Parameters
    ----------
    mesh : FaceMesh
        Whose wall faces name their fiber.
    domain : FluidDomain
        Whose fibers have axes.

    Returns
    -------
    mean, typical, largest : float [-]
        As in `Fidelity`; 0 without walls.
    """
    _, triangles, _, own, area = _sampled(mesh, domain)
    if not len(triangles):
        return 0.0, 0.0, 0.0
    away = np.abs(own)
    return float(away @ area / area.sum()), _within(away, area, 0.99), float(away.max())


def _sampled(mesh: FaceMesh, domain: FluidDomain) -> tuple[Floats, Ints, Ints, Floats, Floats]:
    """Sample the walls: their points and triangles; fiber, distance in diameters, and area [m2] of each sample."""
    diameter = 2.0 * domain.radius
    points, triangles, face = _walls_of(mesh)
    places, area = _samples(points, triangles)
    distance = fiber_distance(domain, NEAREST * diameter)
    off, piece = distance.with_piece(places)
    own = np.where(piece >= 0, off / diameter[distance.field[2][piece]], NEAREST)
    return points, triangles, np.repeat(mesh.fiber[face], 3), own, area


def _walls_of(mesh: FaceMesh) -> tuple[Floats, Ints, Ints]:
    """Points and triangles of the walls, and the face of the patch that each triangle is of."""
    which = mesh.patch(FIBERS)
    points, triangles, _, face = fan(mesh.points, mesh.corners, mesh.offsets[which.start : which.stop + 1])
    return points, triangles, face


def _samples(points: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """Three places on each triangle, (k, 3) [m], and the area that each stands for, (k,) [m2]."""
    corners = points[triangles]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    return middles.reshape(-1, 3), np.repeat(np.linalg.norm(area_vectors(points, triangles), axis=1) / 3.0, 3)


def _walls(fiber: int, diameter: float, off: Floats, area: Floats, in_air: float) -> FiberWalls:
    if not len(off):
        return FiberWalls(fiber, float(diameter), 0.0, 0.0, 0.0, 0.0, float(in_air))
    away, total = np.abs(off), float(area.sum())
    return FiberWalls(
        fiber=fiber,
        diameter=float(diameter),
        area=total / float(diameter) ** 2,
        mean_deviation=float(away @ area / total),
        typical_deviation=_within(away, area, 0.99),
        radius_error=float(2.0 * (off @ area) / total),
        in_air=float(in_air),
    )


def _within(away: Floats, area: Floats, share: float) -> float:
    """Distance within which a share of the area lies."""
    order = np.argsort(away)
    reached = np.cumsum(area[order]) / area.sum()
    return float(away[order][min(int(np.searchsorted(reached, share)), len(away) - 1)])


def _axis_in_air(points: Floats, walls: Ints, domain: FluidDomain) -> Floats:
    """Share of each fiber's axis within the duct that lies outside of the walls, (fibers,) array."""
    from pipeline.geometry.rays import crossings_above

    pieces = domain.pieces
    lengths = np.linalg.norm(pieces.end - pieces.start, axis=1)
    parts = np.maximum(1, np.ceil(lengths / (_STEP * 2.0 * domain.radius[pieces.fiber]))).astype(np.int64)
    piece = np.repeat(np.arange(len(pieces)), parts)
    number = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    share = (number + 0.5) / parts[piece]
    places = pieces.start[piece] + share[:, None] * (pieces.end - pieces.start)[piece]
    fiber = pieces.fiber[piece]
    # a fiber whose axis runs along a side is cut in half there, and the rim of a flat end is rounded by cells as large
    # as the fiber: what lies less than half a radius inside either does not count
    margin = 0.5 * domain.radius[fiber]
    lower, upper = np.array(domain.box.lower), np.array(domain.box.upper)
    inside = ((places > lower + margin[:, None]) & (places < upper - margin[:, None])).all(axis=1)
    along, beyond = share * lengths[piece], (1.0 - share) * lengths[piece]
    inside &= ~(pieces.flat[piece, 0] & (along < margin)) & ~(pieces.flat[piece, 1] & (beyond < margin))
    places, fiber = places[inside], fiber[inside]
    # beside the axis by a hair, since in a regular array a ray would meet edges and vertices
    places = places + 1e-3 * domain.radius[fiber][:, None] * np.array([0.618, 0.377, 0.0])
    # the duct's outlet is air: a ray that meets an even number of walls on its way there began in air
    in_air = crossings_above(points, walls, places) % 2 == 0
    count = np.bincount(fiber, minlength=len(domain.radius))
    found: Floats = np.bincount(fiber, in_air, len(domain.radius)) / np.maximum(count, 1)
    return found


def _beside_surface(places: Floats, area: Floats, domain: FluidDomain) -> Fidelity:
    """Measure walls against the surface itself, where nobody knows the fibers' axes."""
    import pyvista as pv

    diameter = domain.mean_diameter
    # VTK's tolerances are absolute: work at size one
    walls = pv.PolyData.from_regular_faces(domain.points / diameter, domain.triangles[domain.fiber >= 0])
    implicit = pv.PolyData(places / diameter).compute_implicit_distance(walls)["implicit_distance"]
    # the air's surface points out of the air, into the fibers: what lies outside of a fiber has a negative distance
    off = -np.asarray(implicit, np.float64)
    return Fidelity(
        mean_deviation=float(np.abs(off) @ area / area.sum()),
        typical_deviation=_within(np.abs(off), area, 0.99),
        largest_deviation=float(np.abs(off).max()),
        fibers=(_walls(0, diameter, off, area, 0.0),),
    )
