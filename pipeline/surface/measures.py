"""Figures of a surface, for people and for `surface.json`."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.geometry.crossings import self_intersections
from pipeline.geometry.solids import volume_within
from pipeline.geometry.triangles import area_vectors, connected_pieces, signed_volumes
from pipeline.nouns.fibers import Mat
from pipeline.nouns.surface import Surface
from pipeline.progress import Progress, silent
from pipeline.surface.joints import polygon_radius
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import clipping_box, fiber_bodies


@dataclass(frozen=True, slots=True)
class SurfaceMeasures:
    """What the united fibers are like.

    Parameters
    ----------
    triangles, points : int
    area : float [m2]
        Without the flat cuts on the sides.
    volume : float [m3]
        Of the union, within the plan.
    solidity : float [-]
        Volume over the slab's.
    overlap_volume : float [m3]
        Summed volumes of the fibers' tubes, cut at the plan's sides, less the union's: what fibers share with each
        other and, where one runs into itself, with themselves (but not what the two pieces at a ball share), and what
        clearing the splinters took (a few ten-thousandths). Exact, and negative only where voids were filled.
    radius_error_max, radius_error_min : float [-]
        How far the polygon's corners lie outside the true radius, and the middles of its sides inside, relative.
    components : int
        Parts that share no point.
    genus : int
        Holes through the surface, summed over the parts.
    splinters : int
        Triangles more than 50 times longer than high.
    self_intersections : int
        Triangles that cut another one.
    """

    triangles: int
    points: int
    area: float
    volume: float
    solidity: float
    overlap_volume: float
    radius_error_max: float
    radius_error_min: float
    components: int
    genus: int
    splinters: int
    self_intersections: int


def measure_surface(
    mat: Mat, surface: Surface, settings: SurfaceSettings, progress: Progress = silent
) -> SurfaceMeasures:
    """Measure the surface that `unite` made of a mat with these settings.

    Parameters
    ----------
    mat : Mat
    surface : Surface
    settings : SurfaceSettings
    progress : Progress

    Returns
    -------
    SurfaceMeasures
    """
    points, triangles = surface.points, surface.triangles
    bodies, _, before = fiber_bodies(mat, settings, progress)
    limits = clipping_box(mat, bodies)
    alone = np.array([volume_within([body], limits) for body in bodies])
    single = alone.copy()
    # what two tubes share in the ball on a bend is no overlap
    for k in np.flatnonzero(before >= 0):
        single[k] = volume_within([bodies[before[k]], bodies[k]], limits) - alone[before[k]]
    vectors = area_vectors(points, triangles)
    corners = points[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    with np.errstate(divide="ignore"):
        slenderness = longest**2 / (2.0 * np.linalg.norm(vectors, axis=1))
    pieces = connected_pieces(triangles)
    count = int(pieces.max()) + 1
    # Euler: V - E + F = 2 parts - 2 genus, and three edges for every two triangles
    euler = len(points) - len(triangles) // 2
    reach = polygon_radius(1.0, settings.sides)
    return SurfaceMeasures(
        triangles=len(triangles),
        points=len(points),
        area=surface.free_area,
        volume=surface.volume,
        solidity=surface.solidity,
        overlap_volume=float(np.sum(single) - signed_volumes(points, triangles).sum()),
        radius_error_max=reach - 1.0,
        radius_error_min=float(reach * np.cos(np.pi / settings.sides) - 1.0),
        components=count,
        genus=(2 * count - euler) // 2,
        splinters=int((slenderness > 50.0).sum()),
        self_intersections=len(self_intersections(points, triangles)),
    )
