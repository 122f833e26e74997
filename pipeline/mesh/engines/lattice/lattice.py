"""The air in tetrahedra from a body-centered cubic lattice that the fibers' surface cuts."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.errors import StageError
from pipeline.geometry.tets import Cells
from pipeline.machine import peak_memory
from pipeline.mesh.distance import fiber_distance
from pipeline.mesh.engines.lattice.engine import estimate_for
from pipeline.mesh.estimate import slenderness, too_large
from pipeline.mesh.freedom import Freedom
from pipeline.mesh.settings import TetmeshSettings
from pipeline.mesh.working_mesh import WorkingMesh
from pipeline.nouns.arrays import Bools, Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh_measures import MeshingCost
from pipeline.progress import Progress

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance
    from pipeline.geometry.keys import KeyTable
    from pipeline.mesh.engines.lattice.octree import Demand, Octree
    from pipeline.mesh.engines.lattice.sizes import Grid

_SNAP = 0.25  # cube edges between a vertex and the surface up to which the vertex moves onto it
_OFF = 0.02  # of its diameter that improving may move a vertex off a fiber
_FARTHEST = 2.0  # distances from the surface that a vertex may move, when it has to stay on a plane of the duct
_LEAST = 1e-3  # volume of a tetrahedron whose vertices have moved, in cubes; there are 12 to a cube
_SHORTEST = 0.1  # diameters; a shorter fiber gets no smaller cubes
_CELLS = 12.0  # of the mesh for each cube: measured 11.4 to 13.3
_AIR = 0.02  # cubes between the surface and the center of a tetrahedron that is kept though all its corners lie there
_THROUGH = 0.1  # cubes that the middle of its edges may lie in a fiber: chords do
_THICK = 0.01  # volume of such a tetrahedron, in cubes
FINER = (1, 2)
"""Levels of smaller cubes where air is narrow, and those where that leaves the fibers' volume off by too much."""
_NARROW = 0.75  # cubes between walls that face each other


def lattice_mesh(
    domain: FluidDomain, settings: TetmeshSettings, progress: Progress, finer: int = FINER[0]
) -> tuple[WorkingMesh, MeshingCost]:
    """Fill the air with tetrahedra, whose vertices at the fibers lie on the true cylinders.

    Cubes at a fiber have the edge `settings.edge` times its own diameter; away from it they double where
    `settings.growth` and `settings.largest_edge` allow. Vertices near the surface move onto it, tetrahedra that still
    cross it are cut, and what lies in the air is kept. The same case always gives the same mesh.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    progress : Progress
    finer : int
        How often cubes are halved where air is narrow.

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
    progress("filling the duct with cubes", 0.1)
    tree, edge = _cubes(domain, settings, finer)
    distance = fiber_distance(domain, 2.0 * wanted_edges(domain, settings))
    progress("measuring the distance to the fibers", 0.2)
    lattice, value = _filled(domain, tree, edge, distance)
    progress(f"cutting the fibers out of {len(lattice.tets)} tetrahedra", 0.4)
    crossed = _crossed(lattice, value, distance)
    cells = crossed.in_air(np.ones(len(crossed.tets), dtype=bool))
    if lattice.cyclic:
        cells = _matching_parts(cells, crossed.numbers(), crossed.plane)
    mesh = WorkingMesh.of(crossed.points, cells, freedom_of(domain, settings))
    return mesh, MeshingCost(time.monotonic() - began, peak_memory())


def freedom_of(domain: FluidDomain, settings: TetmeshSettings) -> Freedom:
    """Give how far the vertices of a lattice may move."""
    return Freedom.of(domain, _OFF, settings.edge)


@dataclass(frozen=True, eq=False, slots=True)
class LatticePart:
    """Tetrahedra of a part of the duct, the same ones that the whole lattice has there.

    Parameters
    ----------
    points : (n, 3) array [m]
    names : (n, 2) int array
        Of each vertex in the whole lattice: its number and -1, or those of the ends of the edge that it lies on.
    tets : (m, 4) int32 array
    group : (m,) int array
        What each belongs to.
    """

    points: Floats
    names: Ints
    tets: "Cells"
    group: Ints


def lattice_part(
    domain: FluidDomain, settings: TetmeshSettings, low: Floats, high: Floats, group_of: Callable[[Floats], Ints]
) -> LatticePart:
    """Give the lattice's tetrahedra in a part of the duct, before they are repaired.

    Parameters
    ----------
    domain : FluidDomain
        Whose sides are not cyclic.
    settings : TetmeshSettings
    low, high : (3,) arrays [m]
        Corners of the part; around it twice the largest cube is looked at.
    group_of : callable
        Tells by the (k, 3) centers [m] of uncut tetrahedra what each belongs to; those below 0 are left out.

    Returns
    -------
    LatticePart
    """
    lower = np.array(domain.box.lower)
    counts, edge, largest = cubes_of(domain, settings)
    around = 4 * largest
    window = (
        np.maximum(np.floor((low - lower) / edge).astype(np.int64) - around, 0),
        np.minimum(np.ceil((high - lower) / edge).astype(np.int64) + around, counts),
    )
    tree, edge = _cubes(domain, settings, FINER[0], window)
    size = np.int64(1) << tree.level
    near = (tree.low < window[1] - around // 2) | (window[1] == counts)
    near &= (tree.low + size[:, None] > window[0] + around // 2) | (window[0] == 0)
    chosen = near.all(axis=1)
    tree = replace(tree, low=tree.low[chosen], level=tree.level[chosen])
    distance = fiber_distance(domain, 2.0 * wanted_edges(domain, settings))
    lattice, value = _filled(domain, tree, edge, distance)
    crossed = _crossed(lattice, value, distance)
    # by where the vertices stood at first: one that moved onto a fiber says nothing of the lattice
    group = group_of(lattice.points[crossed.tets].mean(axis=1))
    chosen = [(each, crossed.in_air(group == each)) for each in np.unique(group[group >= 0]).tolist()]
    cells = np.concatenate([cells for _, cells in chosen]) if chosen else np.empty((0, 4), np.int32)
    groups = np.repeat([each for each, _ in chosen], [len(cells) for _, cells in chosen]).astype(np.int64)
    return LatticePart(crossed.points, crossed.names(), cells, groups)


def _filled(domain: FluidDomain, tree: "Octree", edge: Floats, distance: "FiberDistance") -> "tuple[Lattice, Floats]":
    """Fill cubes with tetrahedra: the lattice, and the distance of each vertex from the fibers [m]."""
    # numba takes half a second to load, which no refused case file should cost
    from pipeline.mesh.engines.lattice.tetrahedra import lattice_tetrahedra, lattice_vertices

    lower, upper = np.array(domain.box.lower), np.array(domain.box.upper)
    vertices = lattice_vertices(tree)
    ends = 2 * tree.counts
    plane = np.where(vertices.places == 0, -1, np.where(vertices.places == ends, 1, 0)).astype(np.int8)
    points: Floats = np.where(plane > 0, upper, lower + vertices.places * (0.5 * edge))
    value = distance.at(points)
    tets = lattice_tetrahedra(tree, vertices, value)
    # vertices opposite to each other on cyclic sides are one
    ends[2] += 1
    twins = vertices.places % ends if domain.cyclic else vertices.places
    number = np.ravel_multi_index(tuple(twins.T), tuple((ends + 1).tolist()))
    width = np.asarray(vertices.width * edge.max(), np.float64)
    return Lattice(points, plane, width, tets, lower, upper, number, domain.cyclic), value


def wanted_edges(domain: FluidDomain, settings: TetmeshSettings) -> Floats:
    """Largest edge of a cube at each fiber, (fibers,) array [m]; one shorter than thick asks for smaller ones."""
    pieces = domain.pieces
    lengths = np.linalg.norm(pieces.end - pieces.start, axis=1)
    length = np.bincount(pieces.fiber, lengths, len(domain.radius))
    diameter = 2.0 * domain.radius
    wanted: Floats = np.asarray(settings.edge * np.clip(length, _SHORTEST * diameter, diameter), np.float64)
    return wanted


def cubes_of(domain: FluidDomain, settings: TetmeshSettings) -> tuple[Ints, Floats, int]:
    """Give the smallest cubes along each axis, their extents [m], and how many of them the largest cube spans."""
    _, cubes, largest = _demand(domain, settings, FINER[0])
    return cubes.counts, cubes.edge, 1 << max(0, int(np.floor(np.log2(1.001 * largest / cubes.edge.max()))))


def _cubes(
    domain: FluidDomain, settings: TetmeshSettings, finer: int, window: tuple[Ints, Ints] | None = None
) -> tuple["Octree", Floats]:
    """Cut the duct, or a window of it, into cubes: the tree, and the smallest cube's extent along each axis [m]."""
    from pipeline.mesh.engines.lattice.octree import octree

    demand, cubes, _ = _demand(domain, settings, finer)
    wrapped = np.array([domain.cyclic, domain.cyclic, False])
    slender, parts = slenderness(domain), window is None and not domain.cyclic

    def refuse(count: int) -> None:
        expected = estimate_for(_CELLS * count)
        if (reason := too_large(expected, slender, settings, parts=parts)) is not None:
            raise StageError(reason)

    return octree(demand, cubes.counts, cubes.edge, _NARROW, wrapped, refuse, window), cubes.edge


def _demand(domain: FluidDomain, settings: TetmeshSettings, finer: int) -> "tuple[Demand, Grid, float]":
    """Tell what the fibers ask for, the smallest cubes that suit it, and the largest edge of any cube [m]."""
    from pipeline.geometry.cylinders import table
    from pipeline.mesh.engines.lattice.octree import Demand
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
    cubes = grid(upper - lower, wanted, (lengths * domain.radius)[there], finer, largest, wrapped)
    demand = Demand(
        table(pieces.start - lower, pieces.end - lower, domain.radius[pieces.fiber]),
        pieces.flat,
        pieces.fiber,
        allowed(wanted)[np.searchsorted(there, pieces.fiber)],
        settings.growth,
        largest,
        0.5**finer,
    )
    return demand, cubes, largest


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


@dataclass(frozen=True, eq=False, slots=True)
class Crossed:
    """A lattice whose vertices near the fibers lie on them, and where its edges still cross them.

    Parameters
    ----------
    points : (n + k, 3) array [m]
        The lattice's vertices, then the crossing on each edge.
    plane : (n + k, 3) int8 array
        As in `Lattice`.
    tets : (m, 4) int32 array
    side : (n,) int8 array
        1 for vertices in the air, 0 on a fiber, -1 in one.
    rank : (n,) int array
        As `cut.in_air` takes it.
    edges : (k, 2) int array
        Outer and inner end of the edges that cross a fiber.
    table : KeyTable
        Row of each.
    kept : (m,) bool array
        Tetrahedra to keep though every vertex lies on a fiber.
    number : (n,) int array
        As in `Lattice`.
    """

    points: Floats
    plane: npt.NDArray[np.int8]
    tets: "Cells"
    side: npt.NDArray[np.int8]
    rank: Ints
    edges: Ints
    table: "KeyTable"
    kept: Bools
    number: Ints

    def in_air(self, chosen: Bools) -> "Cells":
        """Give what the fibers leave of some tetrahedra."""
        from pipeline.mesh.engines.lattice.cut import in_air

        if chosen.all():
            return in_air(self.points, self.tets, self.side, self.rank, self.table, self.kept)
        return in_air(self.points, self.tets[chosen], self.side, self.rank, self.table, self.kept[chosen])

    def names(self) -> Ints:
        """Name each vertex by its number and -1, or by those of the ends of its edge: (n + k, 2) int array."""
        of_lattice = np.column_stack([self.number, np.full(len(self.number), -1)])
        return np.concatenate([of_lattice, self.number[self.edges]])

    def numbers(self) -> Ints:
        """Give the same number to vertices opposite to each other, (n + k,) int array."""
        pairs = np.unique(self.number[self.edges], axis=0, return_inverse=True)[1].ravel()
        return np.concatenate([self.number, self.number.max() + 1 + pairs])


def _crossed(lattice: Lattice, value: Floats, distance: "FiberDistance") -> Crossed:
    """Move vertices near the surface onto it, and find where edges still cross it."""
    from pipeline.geometry.adjacency import cell_volumes
    from pipeline.mesh.engines.lattice.cut import crossed_edges

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
        # by their numbers where two are as far: a part of the lattice is cut as the whole is
        rank[np.lexsort((lattice.number, value))] = np.arange(len(points))
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
    return Crossed(points, plane, tets, side, rank, edges, table, kept, lattice.number)


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
