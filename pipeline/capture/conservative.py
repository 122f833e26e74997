r"""A velocity that loses no air: exactly free of divergence in each cell, with one flux through each face.

A velocity by Taylor-Hood elements conserves air in the mean of a cell's surroundings only: streamlines of it end on
walls that no air crosses, which is what interception counts. Here it is corrected cell by cell in the reference
tetrahedron, by Piola's transform, where a flux is a flux whatever the cell's shape:

1. the flux density :math:`\hat u = \det(J)\,J^{-1} u` at the ten nodes, continuous through faces in its normal part;
2. on each inner face the flux that its cells lack (of Raviart and Thomas' lowest order), the least that will do;
3. in each cell the part of Brezzi, Douglas and Marini's second order that no face sees, until no divergence is left.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import NamedTuple

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.arrays import Bools, Floats, Ints

EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
"""Ends of the edge that nodes 4 to 9 of a tetrahedron stand on, as VTK orders them."""

_CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
_PLACES = np.vstack([_CORNERS, _CORNERS[EDGES].mean(axis=1)])
_ALONG = _CORNERS[EDGES[:, 1]] - _CORNERS[EDGES[:, 0]]
# face k lies against vertex k; its area vector points outward
_AREAS = 0.5 * np.array([[1.0, 1, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]])
_MIDDLES = np.array([[4 + e for e in range(6) if k not in EDGES[e]] for k in range(4)])
_SHARES = np.column_stack([1.0 - _PLACES.sum(axis=1), _PLACES])
_BY_PLACE = np.array([[-1.0, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
_CHUNK = 50_000
_ROUNDING = 1e-12


def _slopes(shares: Floats) -> Floats:
    """Give the derivatives of the ten functions at places by their barycentric coordinates, (places, 10, 3)."""
    corner = (4.0 * shares - 1.0)[:, :, None] * _BY_PLACE
    one, two = EDGES.T
    edge = 4.0 * (shares[:, one, None] * _BY_PLACE[two] + shares[:, two, None] * _BY_PLACE[one])
    return np.concatenate([corner, edge], axis=1)


_SLOPES = _slopes(_SHARES)


class Conserved(NamedTuple):
    """A velocity that loses no air.

    Parameters
    ----------
    flux : (m, 10, 3) array [m3/s]
        Flux density in each cell's reference tetrahedron, at its ten nodes: det(J) J^-1 u, of second order between.
    lost : float [-]
        What the faces lacked: the root mean square of the flux put in over that of the fluxes.
    changed : float [-]
        How much the velocity at the nodes was changed: root mean square over that of the velocity.
    """

    flux: Floats
    lost: float
    changed: float


def conserved(
    nodes: Ints,
    position: Floats,
    velocity: Floats,
    neighbor: Ints,
    opening: Bools,
    wall: Bools,
    through: Floats | None = None,
) -> Conserved:
    """Correct a velocity of second order until it loses no air anywhere.

    Parameters
    ----------
    nodes : (m, 10) int array
    position, velocity : (n, 3) arrays [m], [m/s]
        At the nodes.
    neighbor : (m, 4) int array
        Cell behind the face against each vertex, -1 at the boundary.
    opening : (m, 4) bool array
        Faces of the boundary whose flux is free, as an outlet's is; on others, as an inlet's, it stays.
    wall : (m, 4) bool array
        Faces that let no air through, which a slip condition keeps to in the mean only.
    through : (m, 4) array [m3/s], optional
        Flux out of each face where it is known, as a solver on finite volumes knows it.

    Returns
    -------
    Conserved

    Raises
    ------
    StageError
        If air is lost that no opening can take.
    """
    flux = np.concatenate(
        [_densities(position[part], velocity[part]) for part in np.split(nodes, range(_CHUNK, len(nodes), _CHUNK))]
    )
    before = flux.copy()
    outward = _outward(flux)
    put = _missing(outward, neighbor, opening, wall) if through is None else through - outward
    # of Raviart and Thomas: 2 (place - opposite vertex) has a flux of 1 through its face and none through others
    flux += np.einsum("mk,nkx->mnx", put, 2.0 * (_PLACES[:, None] - _CORNERS))
    divergence = np.einsum("mnx,vnx->mv", flux, _SLOPES[:4])
    one, two = EDGES.T
    flux[:, 4:] -= ((divergence[:, one] - divergence[:, two]) / 16.0)[:, :, None] * _ALONG
    return Conserved(flux, _ratio(put, outward), _ratio(flux - before, before))


def _ratio(part: Floats, whole: Floats) -> float:
    size = float(np.linalg.norm(whole))
    return float(np.linalg.norm(part)) / size if size else 0.0


def _densities(position: Floats, velocity: Floats) -> Floats:
    # columns of J are the derivatives of the place; the rows of det(J) J^-1 are their cross products
    x, y, z = (np.einsum("mnx,vn->mvx", position, _SLOPES[:, :, axis]) for axis in range(3))
    found: Floats = np.stack(
        [np.einsum("mvx,mvx->mv", np.cross(*pair), velocity) for pair in ((y, z), (z, x), (x, y))], axis=2
    )
    return found


def _outward(flux: Floats) -> Floats:
    """Flux out of each face of each cell, (m, 4): that of a quadratic is its mean over the middles of the edges."""
    found: Floats = np.einsum("mkex,kx->mk", flux[:, _MIDDLES], _AREAS / 3.0)
    return found


def _missing(outward: Floats, neighbor: Ints, opening: Bools, wall: Bools) -> Floats:
    """Least fluxes to put through faces so that every cell lets out what it lets in."""
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import cg

    cells = len(outward)
    stopped = np.where(wall, -outward, 0.0)
    left = -(outward + stopped).sum(axis=1)
    cell, face = np.nonzero(neighbor >= 0)
    other = neighbor[cell, face]
    open_cell = np.nonzero(opening)[0]
    rows = np.concatenate([cell, cell, open_cell])
    columns = np.concatenate([cell, other, open_cell])
    values = np.concatenate([np.ones(len(cell)), -np.ones(len(cell)), np.ones(len(open_cell))])
    matrix = coo_array((values, (rows, columns)), shape=(cells, cells)).tocsr()
    size = float(np.abs(left).max(initial=0.0))
    if size <= _ROUNDING * float(np.abs(outward).max(initial=0.0)):
        return stopped
    diagonal = matrix.diagonal()
    if not opening.any() or (diagonal == 0).any():
        raise StageError("air is lost in the flow and no opening takes it; solve the flow again with --force solve")
    scale = 1.0 / np.sqrt(diagonal)
    scaled = coo_array((values * scale[rows] * scale[columns], (rows, columns)), shape=(cells, cells)).tocsr()
    found, failed = cg(scaled, left / size * scale, rtol=1e-9, atol=0.0, maxiter=20_000)
    if failed:
        raise StageError("the fluxes of the flow could not be balanced: parts of the mesh hang together by no face")
    potential = found * scale * size
    put = np.where(neighbor >= 0, potential[:, None] - potential[neighbor], 0.0)
    put[opening] = potential[open_cell]
    return put + stopped
