"""Make a mesh fit for a solver: mend its worst cells, fill its crevices, give the fibers their volume, check."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.faces import compacted
from pipeline.geometry.tets import volumes
from pipeline.mesh.boundary import assign, free_axes
from pipeline.mesh.distance import fiber_distance
from pipeline.mesh.engines.flawed import FlawedMeshError
from pipeline.mesh.engines.raw import RawMesh
from pipeline.mesh.improve.fit import fitted
from pipeline.mesh.improve.settle import Reaches, settled
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh, TetMesh
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.nouns.patches import FIBERS
from pipeline.progress import Progress

_FITS = 2  # the second makes good what mending after the first moved
_SLIDE = 0.2  # edges that it may move a vertex along its fiber
_REACH = 3.0  # radii from a fiber beyond which it does not matter


def finished(
    raw: RawMesh, domain: FluidDomain, settings: TetmeshSettings, progress: Progress
) -> tuple[FaceMesh, TetmeshMeasures]:
    """Mend what an engine left, give each fiber its radius back, and check.

    Parameters
    ----------
    raw : RawMesh
    domain : FluidDomain
    settings : TetmeshSettings
    progress : Progress

    Returns
    -------
    FaceMesh, TetmeshMeasures

    Raises
    ------
    FlawedMeshError
        If cells without volume remain.
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.geometry.adjacency import boundary_of, neighbors

    points, tets = compacted(raw.points, raw.tets)
    raw_error = domain.volume_error(float(volumes(points, tets).sum()))
    progress("mending the worst cells", 0.6)
    limits = np.array(domain.box.lower), np.array(domain.box.upper)
    distance = fiber_distance(domain, _REACH * domain.radius)
    reaches = Reaches(distance, 2.0 * domain.radius, raw.leash, _SLIDE * settings.edge)
    filled = 0.0
    for _ in range(_FITS):
        points, tets, faulty, tips = settled(points, tets, domain, reaches)
        filled += tips
        points, tets = compacted(points, tets)
        faces, _ = boundary_of(tets, neighbors(tets))
        walls = faces[assign(points, faces, domain.box, tolerance=0.0) == domain.patches.index(FIBERS)]
        points = fitted(points, tets, walls, free_axes(points, domain.box, domain.cyclic), distance, limits)
    _check_volumes(points, tets, settings)

    faces, _ = boundary_of(tets, neighbors(tets))
    patch = assign(points, faces, domain.box, tolerance=0.0)
    _check_patches(patch, domain, settings)
    mesh = TetMesh(points, tets, faces, patch, domain.patches, domain.slab)
    measures = TetmeshMeasures(
        points=len(points),
        cells=len(tets),
        fluid_volume=mesh.volume,
        volume_error=domain.volume_error(float(volumes(points, tets).sum())),
        raw_volume_error=raw_error,
        filled_volume=filled / domain.volume,
        faulty_cells=faulty,
        mesher_seconds=raw.seconds,
        mesher_peak_memory=raw.peak_memory,
    )
    return mesh.face_mesh(), measures


def _check_patches(patch: Ints, domain: FluidDomain, settings: TetmeshSettings) -> None:
    empty = [name for number, name in enumerate(domain.patches) if not (patch == number).any()]
    if FIBERS in empty:
        thickest = 2.0 * float(domain.radius.max())
        raise FlawedMeshError(
            f"the mesh resolves none of the {len(domain.radius)} fibers, the thickest {thickest * 1e6:.3g} um (fiber "
            f"{int(domain.radius.argmax())} of {len(domain.radius)}), with an edge of {settings.edge:g} diameters; "
            f"{settings.mesher.truer}"
        )
    if empty:
        raise FlawedMeshError(
            f"no air reaches {', '.join(empty)}: the fibers close the duct there; use a larger mat.side"
        )


def _check_volumes(points: Floats, tets: Ints, settings: TetmeshSettings) -> None:
    flat = np.flatnonzero(volumes(points, tets) <= 0.0)
    if len(flat):
        place = points[tets[flat[0]]].mean(axis=0) * 1e6
        raise FlawedMeshError(
            f"{len(flat)} of {len(tets)} tetrahedra have no volume, first at ({place[0]:.3g}, {place[1]:.3g}, "
            f"{place[2]:.3g}) um; {settings.mesher.truer}"
        )
