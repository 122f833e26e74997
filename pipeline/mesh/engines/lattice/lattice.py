"""The air in tetrahedra from a body-centered cubic lattice that the fibers' surface cuts."""

# SPDX-License-Identifier: GPL-3.0-or-later

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.errors import StageError
from pipeline.geometry.tets import boundary, volumes
from pipeline.geometry.triangles import area_vectors
from pipeline.machine import peak_memory
from pipeline.mesh.distance import fiber_distance
from pipeline.mesh.engines.limits import memory_allowed
from pipeline.mesh.engines.raw import RawMesh
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance

_SNAP = 0.25  # cube edges between a vertex and the surface up to which the vertex moves onto it
_LEASH = 2.0  # distances from the surface that a vertex may move, when it has to stay on a plane of the duct
_WALL_LEASH = 0.02  # fiber diameters that mending may move a vertex of a wall
_OFFSETS = 2  # rounds: the second finds the fibers' volume right to some thousandths
_LEAST = 1e-3  # volume of a tetrahedron whose vertices have moved, in smallest cubes; there are 12 to a cube
_LEVELS = 2  # doublings of the cubes' edge
_BYTES = 40  # of memory for each lattice point, when the tetrahedra are made of a lattice that is mostly at its finest


def stuffed(domain: FluidDomain, settings: TetmeshSettings, unit: float, tell: Progress) -> RawMesh:
    """Fill the air with tetrahedra, whose vertices at the fibers lie on the true cylinders.

    Cubes at the fibers have the edge `settings.edge`; away from them it doubles where `settings.growth` and
    `settings.largest_edge` allow. Vertices near the surface move onto it, tetrahedra that still cross it are cut, and
    what lies in the air is kept. The same case always gives the same mesh.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    unit : float [m]
        Mean fiber diameter.
    tell : Progress

    Returns
    -------
    RawMesh

    Raises
    ------
    StageError
        If the lattice does not fit into memory.

    Notes
    -----
    After Labelle & Shewchuk, Isosurface Stuffing, ACM Transactions on Graphics 26:57 (2007), with the exact distance
    to the fibers in place of a sampled one, and vertices moved to the nearest point of the surface instead of along an
    edge: no edge is then cut nearer to its end than a vertex may move.
    """
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.mesh.engines.lattice.cubes import lattice_tets
    from pipeline.mesh.engines.lattice.octree import octree

    began = time.monotonic()
    lower, upper = np.array(domain.box.lower), np.array(domain.box.upper)
    size = (upper - lower) / unit
    counts = np.maximum(1, np.rint(size / settings.edge)).astype(np.int64)
    _check_memory(counts, settings)
    edge = float((size / counts).max())
    sizes = _distances(edge, settings)
    tell("measuring the distance to the fibers")
    distance = fiber_distance(domain, unit, 2 * counts, max(sizes, default=0.0) + 2.0 * edge)
    tell("filling the duct with cubes", 0.2)
    tree = octree(distance.on_lattice[1::2, 1::2, 1::2].astype(np.float64), sizes, edge)
    places, tets = lattice_tets(tree)

    tell(f"cutting the fibers out of {len(tets)} tetrahedra", 0.4)
    lattice = Lattice(
        points=places * (size / (2 * counts)),
        plane=np.where(places == 0, -1, np.where(places == 2 * counts, 1, 0)).astype(np.int8),
        tets=tets,
        edge=edge,
        size=size,
    )
    value = distance.on_lattice[tuple(places.T)].astype(np.float64)
    offset = 0.0
    for _ in range(_OFFSETS):
        points, plane, cells = _cut(lattice, value - offset, distance.thicker(offset))
        # chords lie within a circle: the fibers have to be a little thicker for their volume to be right
        offset += (volumes(points, cells).sum() - domain.volume / unit**3) / _wall_area(points, cells, plane)
    in_meters = np.where(plane < 0, lower, np.where(plane > 0, upper, points * unit + lower))
    return RawMesh(in_meters, cells, _WALL_LEASH * unit, time.monotonic() - began, peak_memory())


@dataclass(frozen=True, eq=False, slots=True)
class Lattice:
    """Tetrahedra that fill the duct; lengths are in fiber diameters from its lower corner.

    Parameters
    ----------
    points : (n, 3) array
    plane : (n, 3) int8 array
        Along each axis: -1 on the duct's lower plane, 1 on its upper plane, 0 between.
    tets : (m, 4) int array
    edge : float
        Of the smallest cubes.
    size : (3,) array
        Of the duct.
    """

    points: Floats
    plane: npt.NDArray[np.int8]
    tets: Ints
    edge: float
    size: Floats


def _cut(lattice: Lattice, value: Floats, distance: "FiberDistance") -> tuple[Floats, npt.NDArray[np.int8], Ints]:
    """Move vertices near the surface onto it, cut what still crosses it, and keep what lies in the air."""
    from pipeline.mesh.engines.lattice.stuffing import crossed_edges, kept

    points, plane = lattice.points.copy(), lattice.plane
    near = np.flatnonzero(np.abs(value) < _SNAP * lattice.edge)
    free = (plane[near] == 0).astype(np.float64)
    moved, done = distance.snapped(points[near], free, _LEASH * _SNAP * lattice.edge)
    on_surface = np.zeros(len(points), dtype=bool)
    on_surface[near] = done
    places = points.copy()
    places[near] = moved
    touched = lattice.tets[on_surface[lattice.tets].any(axis=1)]
    least = _LEAST * lattice.edge**3
    while True:
        # on a plane of the duct a vertex may have to go far to meet the surface, and turn a tetrahedron inside out
        flat = touched[volumes(places, touched) < least]
        back = np.unique(flat[on_surface[flat]])
        if not len(back):
            break
        on_surface[back] = False
        places[back] = points[back]
    points = places
    side = np.sign(value).astype(np.int8)
    side[near] = np.where(on_surface[near], 0, np.where(distance.at(points[near]) > 0.0, 1, -1))
    edges = crossed_edges(lattice.tets, side)
    crossings = distance.crossings(points[edges[:, 0]], points[edges[:, 1]])
    points = np.concatenate([points, crossings])
    ends = plane[edges[:, 0]], plane[edges[:, 1]]
    plane = np.concatenate([plane, np.where(ends[0] == ends[1], ends[0], np.int8(0))])
    points = np.where(plane < 0, 0.0, np.where(plane > 0, lattice.size, points))
    return points, plane, kept(points, lattice.tets, side, edges, value)


def _wall_area(points: Floats, tets: Ints, plane: npt.NDArray[np.int8]) -> float:
    """Area of the boundary that lies on no plane of the duct."""
    faces, _ = boundary(tets)
    on_plane = [(plane[faces][:, :, axis] == end).all(axis=1) for axis in range(3) for end in (-1, 1)]
    walls = faces[~np.logical_or.reduce(on_plane)]
    return float(np.linalg.norm(area_vectors(points, walls), axis=1).sum())


def _distances(edge: float, settings: TetmeshSettings) -> tuple[float, ...]:
    """Distance from the fibers from which on the edge may be 2, 4, ... times that at the fibers."""
    if settings.growth == 0.0:
        return ()
    factors = [1 << level for level in range(1, _LEVELS + 1)]
    return tuple(edge * (f - 1) / settings.growth for f in factors if f * edge <= 1.01 * settings.largest_edge)


def _check_memory(counts: Ints, settings: TetmeshSettings) -> None:
    limit = memory_allowed(settings.memory_limit)
    points = float(np.prod(2.0 * counts + 1.0))
    if _BYTES * points > limit:
        x, y, z = counts.tolist()
        raise StageError(
            f"a lattice of {x} x {y} x {z} cubes takes about {_BYTES * points / 2**20:,.0f} MiB of memory, over "
            f"the limit of {limit / 2**20:,.0f} MiB; raise tetmesh.edge (now {settings.edge:g} diameters) or "
            "tetmesh.memory_limit"
        )
