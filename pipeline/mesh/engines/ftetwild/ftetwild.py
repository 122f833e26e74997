"""From the air's closed surface to tetrahedra by fTetWild: scale, run, find the patches, make the planes flat."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
from scipy.spatial import cKDTree

from pipeline.child_process import Limits
from pipeline.geometry.box import Box
from pipeline.geometry.faces import compacted
from pipeline.geometry.tets import boundary
from pipeline.geometry.triangles import area_vectors
from pipeline.machine import memory_allowed
from pipeline.mesh.boundary import assign, blunted_edges, flattened, planes
from pipeline.mesh.engines.flawed import FlawedMeshError
from pipeline.mesh.engines.ftetwild.engine import TetwildSettings
from pipeline.mesh.engines.ftetwild.running import Meshed, run_mesher
from pipeline.mesh.engines.ftetwild.size_field import size_field
from pipeline.mesh.freedom import Freedom
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.working_mesh import WorkingMesh
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh_measures import MeshingCost
from pipeline.nouns.patches import FIBERS
from pipeline.progress import Progress

_OFF = 0.5  # envelopes that improving may move a vertex off a fiber
_BESIDE = 1.0  # diameters: points of a fiber's surface are 0.6 apart, and too thin air beside it ends within that
_PLANE_ERROR = 0.01  # of a plane's area; rounding of the fibers' cuts takes a few thousandths


def tetrahedralized(
    domain: FluidDomain, settings: TetmeshSettings, unit: float, progress: Progress
) -> tuple[WorkingMesh, MeshingCost]:
    """Fill the air with tetrahedra by fTetWild.

    The mesh differs a little from run to run: fTetWild draws from the system's own randomness.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    unit : float [m]
        Mean fiber diameter.
    progress : Progress

    Returns
    -------
    WorkingMesh, MeshingCost

    Raises
    ------
    StageError
        If the mesher fails or exceeds a limit; FlawedMeshError where it loses part of a plane.
    """
    # fTetWild compares an area with 1e-8 of a length: only geometry of order one survives that
    middle = 0.5 * (np.array(domain.box.lower) + np.array(domain.box.upper))
    own = settings.own(TetwildSettings)
    envelope = own.envelope * 2.0 * float(domain.radius.min())
    raw = _run((domain.points - middle) / unit, domain, settings, progress)
    progress("finding the patches")
    points, tets = compacted(raw.points * unit + middle, raw.tets)
    faces, _ = boundary(tets)
    # two envelopes: the mesher bounds the distance to the surface, not the distance along the plane's normal
    patch = assign(points, faces, domain.box, tolerance=2.0 * envelope)
    plane = blunted_edges(points, faces, domain.box, 2.0 * envelope)
    blunt = np.flatnonzero(plane >= 0)
    blunt = blunt[_off_fibers(points, faces[blunt], domain) > _BESIDE * domain.mean_diameter]
    patch[blunt] = plane[blunt]
    points = flattened(points, faces, patch, domain.box)
    tets = _without_flat_sides(points, tets, domain.box)
    lost = lost_part(points, tets, domain)
    if lost is not None:
        raise FlawedMeshError(
            f"fTetWild lost part of the patch {lost[0]}, whose area is off by {lost[1]:+.2%} "
            f"(allowed: {_PLANE_ERROR:.0%}); raise tetmesh.tetwild.passes (now {own.passes}) "
            "or tetmesh.tetwild.envelope, or lower surface.sides"
        )
    freedom = Freedom.of(domain, _OFF * own.envelope, settings.edge)
    return WorkingMesh.of(points, tets, freedom), MeshingCost(raw.seconds, raw.peak_memory)


def lost_part(points: Floats, tets: Ints, domain: FluidDomain) -> tuple[str, float] | None:
    """Find the plane of the duct that a mesh does not keep, and the relative error of its area; None where all are.

    fTetWild may leave triangles of its input out, by chance: a dent in a plane then counts as fiber, which the fibers'
    volume, fitted afterwards, does not show, and which raised a drag by half. Beside a fiber that touches a side the
    sharp air between them is filled, as everywhere within the envelope: that is no dent.

    Parameters
    ----------
    points : (n, 3) array [m]
    tets : (m, 4) int array
        Flat on the planes.
    domain : FluidDomain
    """
    errors = _plane_errors(points, tets, domain)
    worst = max(errors, key=lambda name: abs(errors[name]))
    if abs(errors[worst]) <= _PLANE_ERROR:
        return None
    plane = _area(domain.points, domain.triangles[domain.patch == domain.patches.index(worst)])
    if errors[worst] < 0.0 and _area_off_fibers(points, tets, domain) <= _PLANE_ERROR * plane:
        return None
    return worst, errors[worst]


def _area_off_fibers(points: Floats, tets: Ints, domain: FluidDomain) -> float:
    """Area of walls [m2] farther from the fibers' surface than sharp air beside them reaches."""
    faces, _ = boundary(tets)
    walls = faces[assign(points, faces, domain.box, tolerance=0.0) == domain.patches.index(FIBERS)]
    return _area(points, walls[_off_fibers(points, walls, domain) > _BESIDE * domain.mean_diameter])


def _off_fibers(points: Floats, faces: Ints, domain: FluidDomain) -> Floats:
    """Distance [m] of each face's middle from the points of the fibers' surface."""
    on_fibers = domain.points[np.unique(domain.triangles[domain.patch == domain.patches.index(FIBERS)])]
    distance, _ = cKDTree(on_fibers).query(points[faces].mean(axis=1))
    return np.asarray(distance)


def _plane_errors(points: Floats, tets: Ints, domain: FluidDomain) -> dict[str, float]:
    """Relative error of the area of each plane of the duct."""
    faces, _ = boundary(tets)
    patch = assign(points, faces, domain.box, tolerance=0.0)
    return {
        name: _area(points, faces[patch == number]) / _area(domain.points, domain.triangles[domain.patch == number])
        - 1.0
        for number, name in enumerate(domain.patches)
        if name != FIBERS
    }


def _area(points: Floats, faces: Ints) -> float:
    return float(np.linalg.norm(area_vectors(points, faces), axis=1).sum())


def _run(points: Floats, domain: FluidDomain, settings: TetmeshSettings, progress: Progress) -> Meshed:
    own = settings.own(TetwildSettings)
    thinnest = 2.0 * float(domain.radius.min()) / domain.mean_diameter
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    sizes = sizes_wanted(points, domain, settings)
    options = {
        # the field can only shorten the mesher's own edge length
        "edge_length_abs": float(sizes["bg_values"].max()),
        # relative to the diagonal there, to the fiber here: a longer plenum must not loosen the fibers
        "epsilon": own.envelope * thinnest / diagonal,
        "stop_energy": own.stop_energy,
        "num_opt_iter": own.passes,
        "simplify": False,  # the surface is tidy already; its own simplification takes a fifth of the time
        "num_threads": 1,  # a second one saves a tenth of the time
        "vtk_ordering": True,  # else every volume is negative
        "quiet": False,  # the log is what progress is read from
        "loglevel": 3,
    }
    limits = Limits(own.time_limit, memory_allowed(settings.memory_limit))
    return run_mesher(points, domain.triangles, options, sizes, limits, progress)


def sizes_wanted(points: Floats, domain: FluidDomain, settings: TetmeshSettings) -> dict[str, np.ndarray]:
    """Give the background mesh with the edge length wanted at each place; lengths in mean fiber diameters.

    Parameters
    ----------
    points : (n, 3) array
        The domain's, in mean fiber diameters.
    domain : FluidDomain
    settings : TetmeshSettings
    """
    walls = domain.fiber >= 0
    corner, first = np.unique(domain.triangles[walls], return_index=True)
    diameter = 2.0 * domain.radius[np.repeat(domain.fiber[walls], 3)[first]] / domain.mean_diameter
    return size_field(
        points.min(axis=0), points.max(axis=0), points[corner], diameter,
        settings.edge, settings.growth, settings.largest_edge,
    )  # fmt: skip


def _without_flat_sides(points: Floats, tets: Ints, box: Box) -> Ints:
    # a sliver whose four vertices were all within the envelope of one plane is now flat on it: without it the
    # boundary is the same plane
    flat = np.zeros(len(tets), dtype=bool)
    for plane in planes(box):
        flat |= (points[tets, plane.axis] == plane.value).all(axis=1)
    return tets[~flat]
