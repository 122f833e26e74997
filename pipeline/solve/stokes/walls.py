"""The walls of a quadratic mesh on the true fibers: vertices and the middles of edges moved, and their true normals."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pipeline.geometry.tets import volumes
from pipeline.nouns.arrays import Bools, Floats, Ints
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.flow_field import EDGES
from pipeline.solve.stokes.elements import rule, shape
from pipeline.solve.stokes.nodes import Nodes

if TYPE_CHECKING:
    from pipeline.geometry.fibers import FiberDistance

_REACH = 1.5  # mean fiber diameters; no wall is that far from every fiber
_LEASH = 0.3  # how far a node may move, in lengths of its shortest edge
_THINNEST = 0.2  # of a straight cell's volume: the least that a node's move, or a curved cell's Jacobian, may leave
_ROUNDS = 4  # of letting edges near a wall follow it
_LEAST_BEND = 0.1  # share of its bend below which an edge is straight
_ON_FIBER = 1e-3  # mean fiber diameters; a node nearer than this lies on its fiber


@dataclass(frozen=True, eq=False, slots=True)
class Walls:
    """Where the nodes of a mesh are once its walls follow the fibers.

    Parameters
    ----------
    positions : (nodes, 3) array
    curved : (m,) bool array
        Which tetrahedra have a curved edge.
    wall : (w,) int array
        Nodes on the walls.
    normal : (w, 3) array
        Out of the air, of the true fiber where a node lies on one; zero elsewhere.
    radius : (w,) array
        Of the fiber.
    axis : (w, 3) array
        Its direction.
    straight : int
        Edges on the walls that are not bent all the way, since a cell would turn inside out or no fiber is near.
    edges : int
        Edges on the walls.
    """

    positions: Floats
    curved: Bools
    wall: Ints
    normal: Floats
    radius: Floats
    axis: Floats
    straight: int
    edges: int


def curve_walls(
    points: Floats, nodes: Nodes, faces: Ints, pieces: Pieces, radius: Floats, lower: Floats, upper: Floats
) -> Walls:
    """Move the walls of a mesh onto the fibers, wherever every cell keeps a positive Jacobian.

    Parameters
    ----------
    points : (n, 3) array
        Of the straight mesh, in mean fiber diameters from the duct's lower corner.
    nodes : Nodes
    faces : (b, 3) int array
        Triangles of the fibers' patch.
    pieces : Pieces
        The fibers, in the same unit.
    radius : (fibers,) array
    lower, upper : (3,) arrays
        The duct: what lies on one of its planes stays on it.

    Returns
    -------
    Walls
    """
    if len(pieces) == 0:
        return _straight_walls(points, nodes, faces, radius)
    # numba takes half a second to load
    from pipeline.geometry.fibers import FiberDistance

    reach = np.full(len(pieces), _REACH)
    distance = FiberDistance.about(
        pieces.start, pieces.end, radius[pieces.fiber], pieces.flat, pieces.fiber, reach, lower, upper
    )
    free = ~(np.isclose(points, lower, atol=1e-7) | np.isclose(points, upper, atol=1e-7))
    length = np.linalg.norm(points[nodes.ends[:, 0]] - points[nodes.ends[:, 1]], axis=1)
    corners = np.unique(faces)
    moved = _moved_vertices(points, nodes, corners, distance, free, length)
    edge = np.unique(nodes.of_triangles(faces)[:, 3:]) - nodes.vertices
    middle = nodes.middles(moved)
    ends = nodes.ends[edge]
    bent, near = distance.on_surface(
        middle[edge], (free[ends[:, 0]] | free[ends[:, 1]]).astype(np.float64), _LEASH * length[edge]
    )
    offset = np.zeros_like(middle)
    offset[edge] = np.where(near[:, None], bent - middle[edge], 0.0)
    held = np.zeros(len(middle), bool)
    held[edge] = True
    both = (free[nodes.ends[:, 0]] | free[nodes.ends[:, 1]]).astype(np.float64)
    wanted = offset[edge]
    offset, curved = _straightened(moved, nodes, middle, _spread(nodes, offset, held, both))
    positions = np.concatenate([moved, middle + offset])
    wall = np.concatenate([corners, nodes.vertices + edge])
    fiber, normal, axis = _true_normals(positions[wall], distance, pieces, radius)
    bent_fully = (offset[edge] == wanted).all(axis=1) & near
    return Walls(positions, curved, wall, normal, radius[fiber], axis, int((~bent_fully).sum()), len(edge))


def _straight_walls(points: Floats, nodes: Nodes, faces: Ints, radius: Floats) -> Walls:
    """Leave the walls of a body as the mesh has them: nobody knows its axes, so no place on it has a fiber's normal."""
    six = nodes.of_triangles(faces)
    wall, edges = np.unique(six), len(np.unique(six[:, 3:]))
    return Walls(
        positions=np.concatenate([points, nodes.middles(points)]),
        curved=np.zeros(len(nodes.cells), bool),
        wall=wall,
        normal=np.zeros((len(wall), 3)),
        radius=np.full(len(wall), float(radius.mean())),
        axis=np.zeros((len(wall), 3)),
        straight=edges,
        edges=edges,
    )


def _moved_vertices(
    points: Floats, nodes: Nodes, corners: Ints, distance: "FiberDistance", free: Bools, length: Floats
) -> Floats:
    """Move vertices on the walls onto the fibers where they are off and no cell becomes flat."""
    shortest = np.full(nodes.vertices, np.inf)
    for end in nodes.ends.T:
        np.minimum.at(shortest, end, length)
    onto, near = distance.on_surface(points[corners], free[corners].astype(np.float64), _LEASH * shortest[corners])
    tets, before = nodes.cells[:, :4], volumes(points, nodes.cells[:, :4])
    moved = points.copy()
    moved[corners[near]] = onto[near]
    while True:
        thin = volumes(moved, tets) < _THINNEST * before
        if not thin.any():
            return moved
        back = np.unique(tets[thin])
        moved[back] = points[back]


def _spread(nodes: Nodes, offset: Floats, held: Bools, free: Floats) -> Floats:
    """Let the middles of edges near a wall follow those on it, so that cells over a curved wall are not squeezed.

    `held` are the edges on the wall; `free` has 0 where an edge lies in a plane across that axis.
    """
    edges = nodes.cells[:, 4:] - nodes.vertices
    moved = offset.copy()
    for _ in range(_ROUNDS):
        near = np.flatnonzero((moved != 0.0).any(axis=1)[edges].any(axis=1))
        of_near = edges[near]
        total, count = np.zeros_like(moved), np.zeros(len(moved))
        np.add.at(total, of_near, (moved[of_near].sum(axis=1, keepdims=True) - moved[of_near]) / 5.0)
        np.add.at(count, of_near, 1.0)
        mean = free * total / np.maximum(count, 1.0)[:, None]
        moved = np.where(held[:, None], offset, mean)
    return moved


def _straightened(points: Floats, nodes: Nodes, middle: Floats, offset: Floats) -> tuple[Floats, Bools]:
    """Take the bend out of the edges of cells that would turn inside out, step by step, until none does."""
    edges = nodes.cells[:, 4:] - nodes.vertices
    middles = 0.5 * (np.eye(4)[EDGES[:, 0]] + np.eye(4)[EDGES[:, 1]])
    corners = np.concatenate([np.eye(4), middles, rule(True)[0]])
    slopes = shape(corners)[1]
    straight = 6.0 * volumes(points, nodes.cells[:, :4])
    share = np.ones(len(offset))
    bent = (offset != 0.0).any(axis=1)
    cells = np.flatnonzero(bent[edges].any(axis=1))
    while True:
        at = np.concatenate([points, middle + share[:, None] * offset])[nodes.cells[cells]]
        jacobian = np.linalg.det(np.einsum("cka,qkb->cqab", at, slopes))
        bad = cells[(jacobian < _THINNEST * straight[cells, None]).any(axis=1)]
        if not len(bad):
            break
        share[np.unique(edges[bad])] *= 0.5
        share[share < _LEAST_BEND] = 0.0
        # only what touches an edge that was changed can have become better or worse
        touched = np.zeros(len(offset), bool)
        touched[np.unique(edges[bad])] = True
        cells = np.flatnonzero((touched & bent)[edges].any(axis=1))
    offset = share[:, None] * offset
    curved: Bools = (offset != 0.0).any(axis=1)[edges].any(axis=1)
    return offset, curved


def _true_normals(at: Floats, distance: "FiberDistance", pieces: Pieces, radius: Floats) -> tuple[Ints, Floats, Floats]:
    """Fiber, normal out of the air, and direction of the fiber at places; no normal where a place is on none."""
    off, found = distance.with_piece(at)
    piece = np.maximum(found, 0)
    start, line = pieces.start[piece], pieces.end[piece] - pieces.start[piece]
    length = np.linalg.norm(line, axis=1)
    axis = line / length[:, None]
    along = np.einsum("ij,ij->i", at - start, axis)
    inward = start + np.clip(along, 0.0, length)[:, None] * axis - at
    size = np.linalg.norm(inward, axis=1)
    flat = np.where(along < 0.0, pieces.flat[piece, 0], pieces.flat[piece, 1])
    on = (found >= 0) & (np.abs(off) < _ON_FIBER) & (np.abs(size - radius[pieces.fiber[piece]]) < _ON_FIBER)
    beyond = (along < 0.0) | (along > length)
    on &= ~(beyond & flat)
    normal = np.where(on[:, None], inward / np.maximum(size, 1e-300)[:, None], 0.0)
    return pieces.fiber[piece], normal, axis
