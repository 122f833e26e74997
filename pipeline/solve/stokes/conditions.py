"""What holds a flow on the boundary: fixed velocities, planes it may not cross, and friction where it slips."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.nouns.arrays import Floats, Ints
from pipeline.solve.stokes.nodes import Nodes
from pipeline.solve.stokes.walls import Walls

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_SAME_WAY = 0.9  # cosine between a true normal and that of the faces above which they are of one wall
_CREASE = 0.6  # cosine between the normals of faces at a node below which it lies on a crease
_NO_WAY_LEFT = 0.2  # what has to be left of a normal for it to bind a direction of its own


@dataclass(frozen=True, eq=False, slots=True)
class Conditions:
    """The boundary's part in a flow.

    Parameters
    ----------
    fixed : (unknowns, 3) uint8 array
        Components that are given.
    given : (unknowns, 3) array
        Their values; zero elsewhere.
    bound : (b,) int array
        Unknowns that may move along some directions only.
    allowed : (b, 3, 3) array
        Projection of each on those directions.
    friction : (3 unknowns, 3 unknowns) matrix or None
        Of walls where the air slips.
    rub : (unknowns, unknowns) matrix or None
        The same for one component by itself, as a preconditioner takes it.
    through : tuple of (k,) int, (k,) int and (k, 3) arrays, or None
        Vertex, unknown and value of the flux through walls where the air slips: along a facet it is not quite along
        the wall, and what would leak so is taken out of the divergence.
    """

    fixed: npt.NDArray[np.uint8]
    given: Floats
    bound: Ints
    allowed: Floats
    friction: "csr_array | None"
    rub: "csr_array | None"
    through: tuple[Ints, Ints, Floats] | None = None

    def project(self, velocity: Floats) -> None:
        """Take out of an (unknowns, 3) array, in place, what the boundary does not let move."""
        velocity[self.fixed != 0] = 0.0
        if len(self.bound):
            velocity[self.bound] = np.einsum("nij,nj->ni", self.allowed, velocity[self.bound])


def fixed_sides(
    nodes: Nodes, unknown: Ints, triangles: dict[str, Ints], planes: dict[str, int], inlet: str
) -> tuple[npt.NDArray[np.uint8], Floats]:
    """Fix the velocity on the inlet to 1 along z, and across each plane to 0; (unknowns, 3) flags and values."""
    count = int(unknown.max()) + 1
    fixed, given = np.zeros((count, 3), np.uint8), np.zeros((count, 3))
    for name, axis in planes.items():
        fixed[unknown[nodes.of_triangles(triangles[name])], axis] = 1
    entrance = unknown[np.unique(nodes.of_triangles(triangles[inlet]))]
    fixed[entrance] = 1
    given[entrance, 2] = 1.0
    return fixed, given


def no_slip(fixed: npt.NDArray[np.uint8], given: Floats, wall: Ints) -> Conditions:
    """Hold the air on the unknowns of the wall."""
    held = fixed.copy()
    held[wall] = 1
    return Conditions(held, given, np.empty(0, np.int64), np.empty((0, 3, 3)), None, None)


def slip(
    fixed: npt.NDArray[np.uint8], given: Floats, nodes: Nodes, unknown: Ints, walls: Walls, faces: Ints, length: float
) -> Conditions:
    r"""Let the air slip along the wall by Navier's condition.

    Parameters
    ----------
    fixed, given : arrays
        Of the other patches.
    nodes : Nodes
    unknown : (nodes,) int array
    walls : Walls
    faces : (b, 3) int array
        Triangles of the wall, outward.
    length : float
        Slip length, in the mesh's unit.

    Notes
    -----
    In the form with the whole gradient of the velocity the traction along the wall is
    :math:`\partial u_t/\partial n = -u_t/\ell + u \cdot \partial_t n` (:math:`n` out of the air): around a fiber
    of radius r the friction is :math:`1/\ell + 1/r`, along it :math:`1/\ell`. The velocity across the wall is
    taken out at every node with the normal of the true fiber, so straight facets cannot lock.
    """
    from scipy.sparse import coo_array

    six = nodes.of_triangles(faces)
    places, weights, values, slopes = triangle_rule()
    at = walls.positions[six]
    along = np.einsum("fka,qkb->fqab", at, slopes)
    area = np.cross(along[..., 0], along[..., 1])
    size = np.linalg.norm(area, axis=2)
    normal = area / size[..., None]
    axis, curvature = _fiber_of_faces(nodes, faces, walls)
    around = np.cross(normal, axis[:, None, :])
    around /= np.maximum(np.linalg.norm(around, axis=2, keepdims=True), 1e-300)
    tensor = (np.eye(3) - normal[..., :, None] * normal[..., None, :]) / length
    tensor += curvature[:, None, None, None] * around[..., :, None] * around[..., None, :]
    weight = size * weights
    local = np.einsum("fq,qi,qj,fqab->fiajb", weight, values, values, tensor, optimize=True)
    count = len(fixed)
    number = 3 * unknown[six][:, :, None] + np.arange(3)
    rows = np.broadcast_to(number[:, :, :, None, None], local.shape)
    columns = np.broadcast_to(number[:, None, None, :, :], local.shape)
    friction = coo_array((local.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * count, 3 * count)).tocsr()
    single = np.einsum("fq,qi,qj->fij", weight, values, values) * (1.0 / length + curvature)[:, None, None]
    one = unknown[six]
    rub = coo_array(
        (single.ravel(), (np.repeat(one, 6, axis=1).ravel(), np.tile(one, (1, 6)).ravel())), shape=(count, count)
    ).tocsr()
    bound, allowed = _allowed(fixed, nodes, unknown, walls, six, area, weights)
    flux = np.einsum("fqa,qi,qv,q->fvia", area, values, places, weights)
    through = (np.repeat(one[:, :3], 6, axis=1).ravel(), np.tile(one, (1, 3)).ravel(), flux.reshape(-1, 3))
    return Conditions(fixed, given, bound, allowed, friction, rub, through)


def triangle_rule() -> tuple[Floats, Floats, Floats, Floats]:
    """Dunavant's rule of 6 points and degree 4 on the triangle, and the quadratic functions and slopes there."""
    a, b = 0.445948490915965, 0.091576213509771
    places = np.array(
        [
            [a, a, 1 - 2 * a],
            [a, 1 - 2 * a, a],
            [1 - 2 * a, a, a],
            [b, b, 1 - 2 * b],
            [b, 1 - 2 * b, b],
            [1 - 2 * b, b, b],
        ]
    )
    weights = 0.5 * np.repeat([0.223381589678011, 0.109951743655322], 3)
    one, two = np.array([[0, 1], [1, 2], [2, 0]]).T
    values = np.hstack([places * (2 * places - 1), 4 * places[:, one] * places[:, two]])
    by_place = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    corner = (4 * places - 1)[:, :, None] * by_place
    edge = 4 * (places[:, one, None] * by_place[two] + places[:, two, None] * by_place[one])
    return places, weights, values, np.concatenate([corner, edge], axis=1)


def _fiber_of_faces(nodes: Nodes, faces: Ints, walls: Walls) -> tuple[Floats, Floats]:
    """Direction of the fiber under each face, and one over its radius; 0 where a face lies on no fiber."""
    where = np.full(nodes.count, -1)
    where[walls.wall] = np.arange(len(walls.wall))
    corner = where[faces]
    on = (walls.normal[corner] != 0.0).any(axis=2)
    best = corner[np.arange(len(faces)), np.argmax(on, axis=1)]
    curvature: Floats = np.where(on.all(axis=1), 1.0 / walls.radius[best], 0.0)
    return walls.axis[best], curvature


def _allowed(
    fixed: npt.NDArray[np.uint8],
    nodes: Nodes,
    unknown: Ints,
    walls: Walls,
    six: Ints,
    area: Floats,
    weights: Floats,
) -> tuple[Ints, Floats]:
    """Directions in which each unknown on the wall may move: not across any of the walls that meet there."""
    count = len(fixed)
    number = unknown[six]
    unit = np.zeros((count, 3))
    np.add.at(unit, number.ravel(), np.repeat(np.einsum("fqa,q->fa", area, weights), 6, axis=0))
    unit /= np.maximum(np.linalg.norm(unit, axis=1, keepdims=True), 1e-300)
    at, true = unknown[walls.wall], walls.normal
    fits = np.einsum("ij,ij->i", true, unit[at]) > _SAME_WAY
    unit[at[fits]] = true[fits]
    bound = np.unique(at)
    place = np.full(count, -1)
    place[bound] = np.arange(len(bound))
    allowed = np.tile(np.eye(3), (len(bound), 1, 1))
    allowed *= (1.0 - fixed[bound])[:, :, None] * (1.0 - fixed[bound])[:, None, :]
    _take_out(allowed, unit[bound])
    face = area.sum(axis=1)
    face /= np.linalg.norm(face, axis=1, keepdims=True)
    entries = place[number].ravel()
    normals = np.repeat(face, 6, axis=0)
    for _ in range(2):
        cosine = np.einsum("ij,ij->i", normals, unit[number.ravel()])
        left = np.linalg.norm(np.einsum("nij,nj->ni", allowed[entries], normals), axis=1)
        # the face that stands most against those before it
        against = np.where((cosine < _CREASE) & (left > _NO_WAY_LEFT), left, 0.0)
        order = np.argsort(against)
        strongest = np.zeros(len(bound), np.int64)
        strongest[entries[order]] = order
        crease = against[strongest] > 0.0
        _take_out(allowed, np.where(crease[:, None], normals[strongest], 0.0))
    return bound, allowed


def _take_out(allowed: Floats, normal: Floats) -> None:
    left = np.einsum("nij,nj->ni", allowed, normal)
    size = np.linalg.norm(left, axis=1)
    left = np.where((size > _NO_WAY_LEFT)[:, None], left / np.maximum(size, 1e-300)[:, None], 0.0)
    allowed -= left[:, :, None] * left[:, None, :]
