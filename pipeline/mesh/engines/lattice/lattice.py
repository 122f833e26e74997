"""The air in tetrahedra from a body-centered cubic lattice that the fibers' surface cuts."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.geometry.tets import Cells
from pipeline.machine import peak_memory
from pipeline.mesh.distance import fiber_distance
from pipeline.mesh.engines.limits import memory_allowed
from pipeline.mesh.freedom import Freedom
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.working_mesh import WorkingMesh
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh_measures import MeshingCost
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance
    from pipeline.mesh.engines.lattice.octree import Octree

_SNAP = 0.25  # cube edges between a vertex and the surface up to which the vertex moves onto it
_OFF = 0.02  # of its diameter that improving may move a vertex off a fiber
_FARTHEST = 2.0  # distances from the surface that a vertex may move, when it has to stay on a plane of the duct
_LEAST = 1e-3  # volume of a tetrahedron whose vertices have moved, in cubes; there are 12 to a cube
_SHORTEST = 0.1  # diameters; a shorter fiber gets no smaller cubes
_BYTES = 8000  # of memory for each cube: ten tetrahedra, of which a million took 0.8 GiB at the peak
_AIR = 0.02  # cubes between the surface and the center of a tetrahedron that is kept though all its corners lie there
_THROUGH = 0.1  # cubes that the middle of its edges may lie in a fiber: chords do
_THICK = 0.01  # volume of such a tetrahedron, in cubes
_FINER = 1  # levels of smaller cubes where air is narrow
_NARROW = 0.75  # cubes between walls that face each other


def lattice_mesh(domain: FluidDomain, settings: TetmeshSettings, progress: Progress) -> tuple[WorkingMesh, MeshingCost]:
    """Fill the air with tetrahedra, whose vertices at the fibers lie on the true cylinders.

    Cubes at a fiber have the edge `settings.edge` times its own diameter; away from it they double where
    `settings.growth` and `settings.largest_edge` allow. Vertices near the surface move onto it, tetrahedra that still
    cross it are cut, and what lies in the air is kept. The same case always gives the same mesh.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    progress : Progress

    Returns
    -------
    WorkingMesh, MeshingCost

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
    began = time.monotonic()
    lower, upper = np.array(domain.box.lower), np.array(domain.box.upper)
    progress("filling the duct with cubes", 0.1)
    tree, edge = _cubes(domain, settings)
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.mesh.engines.lattice.tetrahedra import lattice_tetrahedra, lattice_vertices

    progress("measuring the distance to the fibers", 0.2)
    vertices = lattice_vertices(tree)
    distance = fiber_distance(domain, 2.0 * wanted_edges(domain, settings))
    ends = 2 * tree.counts
    plane = np.where(vertices.places == 0, -1, np.where(vertices.places == ends, 1, 0)).astype(np.int8)
    points: Floats = np.where(plane > 0, upper, lower + vertices.places * (0.5 * edge))
    value = distance.at(points)
    tets = lattice_tetrahedra(tree, vertices, value)

    progress(f"cutting the fibers out of {len(tets)} tetrahedra", 0.4)
    # vertices opposite to each other on cyclic sides are one
    ends[2] += 1
    twins = vertices.places % ends if domain.cyclic else vertices.places
    number = np.ravel_multi_index(tuple(twins.T), tuple((ends + 1).tolist()))
    lattice = Lattice(
        points, plane, np.asarray(vertices.width * edge.max(), np.float64), tets, lower, upper, number, domain.cyclic
    )
    points, cells = _cut(lattice, value, distance)
    mesh = WorkingMesh.of(points, cells, Freedom.of(domain, _OFF, settings.edge))
    return mesh, MeshingCost(time.monotonic() - began, peak_memory())


def wanted_edges(domain: FluidDomain, settings: TetmeshSettings) -> Floats:
    """Largest edge of a cube at each fiber, (fibers,) array [m]; one shorter than thick asks for smaller ones."""
    pieces = domain.pieces
    lengths = np.linalg.norm(pieces.end - pieces.start, axis=1)
    length = np.bincount(pieces.fiber, lengths, len(domain.radius))
    diameter = 2.0 * domain.radius
    wanted: Floats = np.asarray(settings.edge * np.clip(length, _SHORTEST * diameter, diameter), np.float64)
    return wanted


def _cubes(domain: FluidDomain, settings: TetmeshSettings) -> tuple["Octree", Floats]:
    """Cut the duct into cubes: the tree, and the extent of the smallest cube along each axis [m]."""
    from pipeline.geometry.cylinders import table
    from pipeline.mesh.engines.lattice.octree import Demand, octree
    from pipeline.mesh.engines.lattice.sizes import allowed, grid

    lower, upper = np.array(domain.box.lower), np.array(domain.box.upper)
    pieces = domain.pieces
    there = np.unique(pieces.fiber)
    wanted = wanted_edges(domain, settings)[there]
    lengths = np.bincount(pieces.fiber, np.linalg.norm(pieces.end - pieces.start, axis=1), len(domain.radius))
    largest = domain.mean_diameter * max(settings.largest_edge, settings.edge)
    if settings.growth == 0.0:
        largest = float(wanted.min())
    wrapped = np.array([domain.cyclic, domain.cyclic, False])
    cubes = grid(upper - lower, wanted, (lengths * domain.radius)[there], _FINER, largest, wrapped)
    demand = Demand(
        table(pieces.start - lower, pieces.end - lower, domain.radius[pieces.fiber]),
        pieces.flat,
        pieces.fiber,
        allowed(wanted)[np.searchsorted(there, pieces.fiber)],
        settings.growth,
        largest,
        0.5**_FINER,
    )
    limit = memory_allowed(settings.memory_limit)
    return octree(demand, cubes.counts, cubes.edge, _NARROW, wrapped, limit / _BYTES), cubes.edge


@dataclass(frozen=True, eq=False, slots=True)
class Lattice:
    """Tetrahedra that fill the duct.

    Parameters
    ----------
    points : (n, 3) array [m]
    plane : (n, 3) int8 array
        Along each axis: -1 on the duct's lower plane, 1 on its upper plane, 0 between.
    width : (n,) array [m]
        Edge of the smallest cube at each vertex.
    tets : (m, 4) int32 array
    lower, upper : (3,) arrays [m]
        Corners of the duct.
    number : (n,) int array
        The same for vertices opposite to each other on cyclic sides, different for all others.
    cyclic : bool
    """

    points: Floats
    plane: npt.NDArray[np.int8]
    width: Floats
    tets: Cells
    lower: Floats
    upper: Floats
    number: Ints
    cyclic: bool


def _cut(lattice: Lattice, value: Floats, distance: "FiberDistance") -> "tuple[Floats, Cells]":
    """Move vertices near the surface onto it, cut what still crosses it, and keep what lies in the air."""
    from pipeline.geometry.adjacency import cell_volumes
    from pipeline.mesh.engines.lattice.cut import crossed_edges, in_air

    points, plane, tets = lattice.points.copy(), lattice.plane, lattice.tets
    near = np.flatnonzero(np.abs(value) < _SNAP * lattice.width)
    free = (plane[near] == 0).astype(np.float64)
    moved, done = distance.on_surface(points[near], free, _FARTHEST * _SNAP * lattice.width[near])
    on_surface = np.zeros(len(points), dtype=bool)
    on_surface[near] = done
    places = points.copy()
    places[near] = moved
    touched = tets[on_surface[tets].any(axis=1)]
    least = _LEAST * lattice.width[touched].min(axis=1) ** 3
    while True:
        # on a plane of the duct a vertex may have to go far to meet the surface, and turn a tetrahedron inside out
        flat = touched[cell_volumes(places, touched) < least]
        back = np.unique(flat[on_surface[flat]])
        if not len(back):
            break
        if lattice.cyclic:
            back = np.flatnonzero(np.isin(lattice.number, lattice.number[back]))
        on_surface[back] = False
        places[back] = points[back]
    points = places
    side = np.where(on_surface, 0, np.where(value > 0.0, 1, -1)).astype(np.int8)
    edges, table = crossed_edges(tets, side)
    crossings = distance.crossings(points[edges[:, 0]], points[edges[:, 1]])
    rank = lattice.number
    if not lattice.cyclic:
        rank = np.empty(len(points), np.int64)
        rank[np.argsort(value, kind="stable")] = np.arange(len(points))
    points = np.concatenate([points, crossings])
    ends = plane[edges[:, 0]], plane[edges[:, 1]]
    plane = np.concatenate([plane, np.where(ends[0] == ends[1], ends[0], np.int8(0))])
    points = np.where(plane < 0, lattice.lower, np.where(plane > 0, lattice.upper, points))
    # where walls meet at an angle, all corners of a tetrahedron may lie on them and air between
    between = np.flatnonzero((side[tets] == 0).all(axis=1))
    width = lattice.width[tets[between]].min(axis=1)
    airy = distance.at(points[tets[between]].mean(axis=1)) > _AIR * width
    # but none of its edges may run through a fiber
    for a, b in itertools.combinations(range(4), 2):
        airy &= distance.at(points[tets[between][:, [a, b]]].mean(axis=1)) > -_THROUGH * width
    thick = cell_volumes(points, tets[between]) > _THICK * width**3
    kept = np.zeros(len(tets), dtype=bool)
    kept[between[airy & thick]] = True
    if lattice.cyclic:
        # a triangle on a side whose corners all lie on walls is the air's on one side and the fiber's on the other
        doubtful = np.zeros(len(tets), dtype=bool)
        for axis, end in itertools.product((0, 1), (-1, 1)):
            doubtful |= ((lattice.plane[tets, axis] == end) & (side[tets] == 0)).sum(axis=1) == 3
        tets, kept = tets[~doubtful], kept[~doubtful]
    cells = in_air(points, tets, side, rank, table, kept)
    if lattice.cyclic:
        pairs = np.unique(lattice.number[edges], axis=0, return_inverse=True)[1].ravel()
        number = np.concatenate([lattice.number, lattice.number.max() + 1 + pairs])
        cells = _matching_parts(cells, number, plane)
    return points, cells


def _matching_parts(cells: Cells, number: Ints, plane: npt.NDArray[np.int8]) -> Cells:
    """Drop what hangs on the largest part by no face, and what lies opposite to it on a cyclic side.

    Parameters
    ----------
    cells : (m, 4) int array
    number : (n,) int array
        The same for vertices opposite to each other.
    plane : (n, 3) int8 array

    Returns
    -------
    (k, 4) int array
    """
    from pipeline.geometry.adjacency import boundary_of, largest_part_of, neighbors

    while True:
        across = neighbors(cells)
        whole = largest_part_of(across)
        if whole.all():
            return cells
        faces, cell = boundary_of(cells, across)
        at_side = np.zeros(len(faces), dtype=bool)
        for axis, end in itertools.product((0, 1), (-1, 1)):
            at_side |= (plane[faces, axis] == end).all(axis=1)
        faces, cell = np.sort(number[faces[at_side]], axis=1), cell[at_side]
        dropped = ~whole
        lost = {tuple(face) for face in faces[dropped[cell]].tolist()}
        dropped[cell[[tuple(face) in lost for face in faces.tolist()]]] = True
        cells = cells[~dropped]
