r"""Trajectories' deterministic twin: convection and diffusion of the concentration, zero where particles touch.

.. math:: u\cdot\nabla c = D\,\nabla^2 c, \qquad c = 1 \text{ at the inlet}, \quad c = 0 \text{ a radius from a fiber}

Linear elements with streamline upwinding on the flow's mesh, every cell split in eight, cut where particles touch.
Particles without inertia and weight; no scatter of counting, so penetrations far below what can be counted.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import NamedTuple

import numpy as np

from pipeline.capture.cells import Cells, velocities
from pipeline.capture.conservative import EDGES
from pipeline.capture.contact import FiberGrid, distances
from pipeline.errors import StageError
from pipeline.geometry.tets import volumes
from pipeline.geometry.triangles import area_vectors
from pipeline.nouns.arrays import Bools, Floats, Ints

# a tetrahedron's corners, and its inner octahedron along one of its diagonals
_EIGHT = np.array(
    [[0, 4, 6, 7], [4, 1, 5, 8], [6, 5, 2, 9], [7, 8, 9, 3], [4, 5, 6, 8], [4, 6, 7, 8], [6, 9, 7, 8], [6, 5, 9, 8]]
)
_SNAP = 0.02  # of an edge: a vertex nearer than this to where particles touch lies on it


class Penetration(NamedTuple):
    """What passes without being caught.

    Parameters
    ----------
    fine, coarse : float [-]
        On cells split in eight, and on the flow's own.
    """

    fine: float
    coarse: float

    @property
    def value(self) -> float:
        """What finer and finer cells would give: the capture depth, -ln of the penetration, errs by their square."""
        fine, coarse = -np.log(self.fine), -np.log(self.coarse)
        return float(min(np.exp(-(4.0 * fine - coarse) / 3.0), 1.0))

    @property
    def error(self) -> float:
        """How far that is from the fine cells' capture depth, relative."""
        depth = -np.log(self.value)
        return float(abs(-np.log(self.fine) / depth - 1.0)) if depth > 0.0 else np.inf


def concentration_penetration(cells: Cells, grid: FiberGrid, contact: float, diffusivity: float) -> Penetration:
    """Solve for the concentration on two meshes, and give the share that passes.

    Parameters
    ----------
    cells : Cells
    grid : FiberGrid
        With a reach beyond `contact`.
    contact : float [m]
        Distance from a fiber at which particles touch it.
    diffusivity : float [m2/s]

    Returns
    -------
    Penetration
    """
    straight = cells.nodes[:, :4]
    split = cells.nodes[:, _EIGHT].reshape(-1, 4)
    fine, coarse = (_passing(cells, tets, grid, contact, diffusivity) for tets in (split, straight))
    return Penetration(fine, coarse)


def _passing(cells: Cells, tets: Ints, grid: FiberGrid, contact: float, diffusivity: float) -> float:
    used, tets = np.unique(tets, return_inverse=True)
    tets, points = tets.reshape(-1, 4), cells.position[used]
    low, high = points[:, 2].min(), points[:, 2].max()
    points, tets, touching = _cut(points, tets, grid, contact)
    velocity = velocities(points, cells)
    velocity[touching] = 0.0
    near = 1e-9 * (high - low)
    inlet, outlet = points[:, 2] <= low + near, points[:, 2] >= high - near
    return _solved(points, tets, velocity, diffusivity, inlet & ~touching, outlet, touching)


def _cut(points: Floats, tets: Ints, grid: FiberGrid, contact: float) -> tuple[Floats, Ints, Bools]:
    """Cut off what is nearer to a fiber than particles can be; which vertices lie on the cut."""
    level = distances(points, grid) - contact
    edge = np.linalg.norm(points[tets[:, 0]] - points[tets[:, 1]], axis=1)
    size = np.zeros(len(points))
    np.maximum.at(size, tets, np.repeat(edge[:, None], 4, axis=1))
    level[np.abs(level) < _SNAP * size] = 0.0
    inside = level[tets] > 0
    count = inside.sum(axis=1)
    tets, count, inside = tets[count > 0], count[count > 0], inside[count > 0]
    crossed = ((level[tets[:, EDGES[:, 0]]] > 0) & (level[tets[:, EDGES[:, 1]]] < 0)) | (
        (level[tets[:, EDGES[:, 0]]] < 0) & (level[tets[:, EDGES[:, 1]]] > 0)
    )
    pairs = np.unique(np.sort(tets[:, EDGES], axis=2)[crossed], axis=0)
    one, two = points[pairs[:, 0]], points[pairs[:, 1]]
    fall = level[pairs[:, 0]] - level[pairs[:, 1]]
    share = level[pairs[:, 0]] / fall
    for _ in range(3):
        # the distance bends between the ends
        at = distances(one + share[:, None] * (two - one), grid) - contact
        share = np.clip(share + at / fall, 0.01, 0.99)
    tets = _split(tets, pairs, len(points))
    points = np.vstack([points, one + share[:, None] * (two - one)])
    level = np.concatenate([level, np.zeros(len(pairs))])
    tets = tets[(level[tets] >= 0).all(axis=1) & (level[tets] > 0).any(axis=1)]
    used, tets = np.unique(tets, return_inverse=True)
    return points[used], tets.reshape(-1, 4), level[used] <= 0


def _split(tets: Ints, pairs: Ints, vertices: int) -> Ints:
    """Put a vertex onto each of these edges; `pairs` are sorted, and their vertices numbered from `vertices` on.

    Each tetrahedron halves at the first of its edges until none is left. The order is that of the edges and not of the
    cell, so cells that share a face halve it alike.
    """
    known = pairs[:, 0] * vertices + pairs[:, 1]
    while True:
        ends = np.sort(tets[:, EDGES], axis=2)
        old = ends[:, :, 1] < vertices
        number = np.searchsorted(known, ends[:, :, 0] * vertices + ends[:, :, 1])
        number = np.minimum(number, len(known) - 1)
        there = old & (known[number] == ends[:, :, 0] * vertices + ends[:, :, 1]) if len(known) else np.zeros_like(old)
        first = np.where(there, number, len(known)).argmin(axis=1)
        halved = there.any(axis=1)
        if not halved.any():
            return tets
        rows = np.flatnonzero(halved)
        edge = EDGES[first[rows]]
        middle = vertices + number[rows, first[rows]]
        one, two = tets[rows].copy(), tets[rows].copy()
        one[np.arange(len(rows)), edge[:, 0]] = middle
        two[np.arange(len(rows)), edge[:, 1]] = middle
        tets = np.concatenate([tets[~halved], one, two])


def _solved(
    points: Floats, tets: Ints, velocity: Floats, diffusivity: float, inlet: Bools, outlet: Bools, touching: Bools
) -> float:
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import LinearOperator, gmres, spilu

    size = volumes(points, tets)
    tets, size = tets[size > 0], size[size > 0]
    sides = points[tets[:, 1:]] - points[tets[:, :1]]
    inner = np.linalg.inv(np.swapaxes(sides, 1, 2))
    slope = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    at = velocity[tets]
    mean = at.mean(axis=1)
    along = np.einsum("mx,mvx->mv", mean, slope)
    speed = np.linalg.norm(mean, axis=1)
    length = 2.0 * speed / np.maximum(np.abs(along).sum(axis=1), 1e-300)
    number = np.maximum(speed * length / (2.0 * diffusivity), 1e-9)
    # Brooks and Hughes 1982; the optimal share of upwinding, by its series where it cancels
    share = np.where(number < 1e-3, number / 3.0, 1.0 / np.tanh(np.minimum(number, 50.0)) - 1.0 / number)
    delay = np.where(speed > 0, length * share / (2.0 * np.maximum(speed, 1e-300)), 0.0)
    weighted = (at.sum(axis=1, keepdims=True) + at) / 20.0
    values = size[:, None, None] * (
        diffusivity * np.einsum("mix,mjx->mij", slope, slope)
        + np.einsum("mix,mjx->mij", weighted, slope)
        + (delay[:, None, None] * along[:, :, None] * along[:, None, :])
    )
    rows, columns = np.repeat(tets, 4, axis=1), np.tile(tets, (1, 4))
    matrix = coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=(len(points),) * 2).tocsr()
    used = np.zeros(len(points), bool)
    used[tets] = True
    free = used & ~inlet & ~touching
    found = np.where(inlet & ~touching, 1.0, 0.0)
    system, right = matrix[free][:, free].tocsc(), -(matrix @ found)[free]
    factors = spilu(system, drop_tol=1e-4, fill_factor=12.0)
    solved, failed = gmres(
        system, right, rtol=1e-9, maxiter=400, M=LinearOperator(system.shape, factors.solve), restart=40
    )
    if failed:
        raise StageError("the concentration could not be solved for; give capture.concentration = false")
    found[free] = solved
    rest = matrix @ found
    caught, out = -float(rest[touching].sum()), _carried_out(points, tets, velocity[:, 2], found, outlet)
    return out / (out + caught)


def _carried_out(points: Floats, tets: Ints, speed: Floats, concentration: Floats, outlet: Bools) -> float:
    """Integrate what the air takes through the outlet, the product of two linear functions."""
    on = outlet[tets]
    cell, lacking = np.nonzero((on.sum(axis=1) == 3)[:, None] & ~on)
    corners = tets[cell][np.arange(4) != lacking[:, None]].reshape(-1, 3)
    area = np.linalg.norm(area_vectors(points, corners), axis=1)
    c, u = concentration[corners], speed[corners]
    return float((area / 12.0 * (c.sum(axis=1) * u.sum(axis=1) + (c * u).sum(axis=1))).sum())
