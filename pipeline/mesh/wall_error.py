"""How well the walls of a mesh stand where the true fibers do."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.polyhedra import fanned
from pipeline.geometry.triangles import area_vectors
from pipeline.mesh.distance import fiber_distance
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import Fidelity
from pipeline.nouns.patches import FIBERS

_STEP = 0.35  # of the lattice that finds the nearest fiber, in mean fiber diameters
_REACH = 1.5  # diameters; no wall is that far from every fiber


def fidelity(mesh: FaceMesh, domain: FluidDomain) -> Fidelity:
    """Measure the walls of a mesh against the fibers.

    Walls are sampled at three points of every triangle, by the rule that integrates quadratics exactly.

    Parameters
    ----------
    mesh : FaceMesh
    domain : FluidDomain
        What it was made of.

    Returns
    -------
    Fidelity
    """
    unit = domain.mean_diameter
    which = mesh.patch(FIBERS)
    points, triangles = fanned(mesh.points, mesh.corners, mesh.offsets[which.start : which.stop + 1])
    corners = points[triangles]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    area = np.repeat(np.linalg.norm(area_vectors(points, triangles), axis=1) / 3.0, 3)
    lower, upper = np.array(domain.box.lower), np.array(domain.box.upper)
    counts = np.maximum(1, np.ceil((upper - lower) / unit / _STEP)).astype(np.int64)
    distance = fiber_distance(domain, unit, counts, _REACH)
    off, piece = distance.with_piece((middles.reshape(-1, 3) - lower) / unit)
    away = np.abs(off)
    order = np.argsort(away)
    share = np.cumsum(area[order]) / area.sum()
    fiber = domain.pieces.fiber[distance.source[np.maximum(piece, 0)]]
    count = len(domain.radius)
    known = piece >= 0
    weight = np.bincount(fiber[known], area[known], count)
    standing = np.bincount(fiber[known], (area * off)[known], count) / np.where(weight > 0.0, weight, 1.0)
    return Fidelity(
        mean_deviation=float(away @ area / area.sum()),
        typical_deviation=float(away[order][np.searchsorted(share, 0.99)]),
        largest_deviation=float(away.max()),
        radius_error=tuple((standing * unit / domain.radius).tolist()),
    )
