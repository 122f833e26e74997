r"""What inertia adds to a flow: the momentum that the air carries, on Taylor-Hood elements.

In the form that keeps momentum: against a function :math:`\varphi` of the velocity it is
:math:`-\mathrm{Re} \int u \, (u \cdot \nabla \varphi)`, and what crosses the planes where the air enters and leaves.
The functions sum to 1, so forces and the momentum's fluxes through those planes balance to what the iterations leave.

Compiled by numba: imported only where a flow is solved.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.patches import INLET, OUTLET
from pipeline.solve.stokes.conditions import triangle_rule
from pipeline.solve.stokes.duct import Duct
from pipeline.solve.stokes.elements import Indices, inverse_of, place_of, rule, shape

Blocks = npt.NDArray[np.float32]


@compiled
def _gather(velocity: Floats, unknown: Indices, own: Floats) -> None:
    """Put the velocity at the ten nodes of a cell into `own`."""
    for k in range(10):
        for a in range(3):
            own[k, a] = velocity[unknown[k], a]


@compiled
def _interpolate(values: Floats, own: Floats, u: Floats) -> None:
    """Put the velocity at a point into `u`: the sum of the ten functions' values there times those at the nodes."""
    u[:] = 0.0
    for k in range(10):
        for a in range(3):
            u[a] += values[k] * own[k, a]


@compiled
def _add_force(
    positions: Floats, cells: Ints, unknown: Indices, velocity: Floats, weights: Floats, values: Floats,
    slopes: Floats, force: Floats,
) -> None:  # fmt: skip
    """Add each cell's momentum force at a Reynolds number of 1 to an (unknowns, 3) array."""
    jacobian, inverse, slope = np.empty((3, 3)), np.empty((3, 3)), np.empty((10, 3))
    local, own, u = np.empty((10, 3)), np.empty((10, 3)), np.empty(3)
    for cell in range(len(cells)):
        local[:] = 0.0
        _gather(velocity, unknown[cell], own)
        for q in range(len(weights)):
            weight = _slopes_at(positions, cells[cell], slopes[q], jacobian, inverse, slope) * weights[q]
            _interpolate(values[q], own, u)
            for k in range(10):
                along = weight * (u[0] * slope[k, 0] + u[1] * slope[k, 1] + u[2] * slope[k, 2])
                for a in range(3):
                    local[k, a] -= along * u[a]
        for k in range(10):
            for a in range(3):
                force[unknown[cell, k], a] += local[k, a]


@compiled
def _add_change(
    positions: Floats, cells: Ints, unknown: Indices, velocity: Floats, weights: Floats, values: Floats,
    slopes: Floats, both: bool, start: Ints, column: Indices, carried: Blocks, bent: Blocks,
) -> None:  # fmt: skip
    """Add what each cell's momentum force changes by with the velocity, at a Reynolds number of 1.

    `carried`, (k,) values, is for the velocity that is carried; `bent`, (k, 3, 3), for the one that carries, if `both`.
    """
    jacobian, inverse, slope = np.empty((3, 3)), np.empty((3, 3)), np.empty((10, 3))
    own, u = np.empty((10, 3)), np.empty(3)
    local, local_bent = np.empty((10, 10)), np.empty((10, 10, 3, 3))
    for cell in range(len(cells)):
        local[:], local_bent[:] = 0.0, 0.0
        _gather(velocity, unknown[cell], own)
        for q in range(len(weights)):
            weight = _slopes_at(positions, cells[cell], slopes[q], jacobian, inverse, slope) * weights[q]
            _interpolate(values[q], own, u)
            for k in range(10):
                along = weight * (u[0] * slope[k, 0] + u[1] * slope[k, 1] + u[2] * slope[k, 2])
                for m in range(10):
                    local[k, m] -= along * values[q, m]
                    if both:
                        by = weight * values[q, m]
                        for a in range(3):
                            for b in range(3):
                                local_bent[k, m, a, b] -= by * u[a] * slope[k, b]
        for k in range(10):
            row = unknown[cell, k]
            for m in range(10):
                place = place_of(start, column, row, unknown[cell, m])
                carried[place] += local[k, m]
                if both:
                    for a in range(3):
                        for b in range(3):
                            bent[place, a, b] += local_bent[k, m, a, b]


@compiled
def _slopes_at(
    positions: Floats, nodes: Ints, slopes: Floats, jacobian: Floats, inverse: Floats, slope: Floats
) -> float:
    """Put the derivatives by place of one cell's functions at one point into `slope`; give six times the volume."""
    jacobian[:] = 0.0
    for k in range(10):
        for a in range(3):
            for b in range(3):
                jacobian[a, b] += positions[nodes[k], a] * slopes[k, b]
    determinant = inverse_of(jacobian, inverse)
    for k in range(10):
        for a in range(3):
            slope[k, a] = slopes[k, 0] * inverse[0, a] + slopes[k, 1] * inverse[1, a] + slopes[k, 2] * inverse[2, a]
    return determinant


class Convection:
    """The momentum's force in a duct at a Reynolds number, and its change with the velocity.

    Parameters
    ----------
    duct : Duct
    reynolds : float
        Density x face velocity x the mesh's unit over viscosity.
    """

    def __init__(self, duct: Duct, reynolds: float) -> None:
        self.duct, self.reynolds = duct, reynolds
        self.unknown = np.ascontiguousarray(duct.unknown[duct.nodes.cells], np.int32)
        # degree 5, which products of two velocities and a slope have on straight cells
        places, self.weights = rule(True)
        self.values, self.slopes = shape(places)
        self.planes = [_plane(duct, name) for name in (INLET, OUTLET)]

    def force(self, velocity: Floats) -> Floats:
        """Force of the momentum at each unknown, (unknowns, 3) array."""
        found = np.zeros_like(velocity)
        _add_force(
            self.duct.walls.positions, self.duct.nodes.cells, self.unknown, velocity, self.weights, self.values,
            self.slopes, found,
        )  # fmt: skip
        for six, weight, values, normal in self.planes:
            u = np.einsum("qk,fka->fqa", values, velocity[six])
            by = np.einsum("fq,fqa,fa->fq", weight, u, normal)
            np.add.at(found, six, np.einsum("fq,fqa,qk->fka", by, u, values))
        return self.reynolds * found

    def flux(self, velocity: Floats) -> float:
        """Momentum along the flow that leaves the duct less what enters it."""
        total = 0.0
        for six, weight, values, normal in self.planes:
            u = np.einsum("qk,fka->fqa", values, velocity[six])
            total += float(np.einsum("fq,fqa,fa,fq->", weight, u, normal, u[:, :, 2]))
        return self.reynolds * total

    def change(self, velocity: Floats, both: bool) -> tuple[Blocks, Blocks]:
        """Change of the force with the velocity, at the places of the stiffness.

        Parameters
        ----------
        velocity : (unknowns, 3) array
        both : bool
            With the velocity that carries too (Newton), and not only with the one that is carried (Picard).

        Returns
        -------
        carried : (k,) float32 array
            The same for each component.
        bent : (k, 3, 3) or (0, 3, 3) float32 array
        """
        m = self.duct.matrices
        carried = np.zeros(len(m.column), np.float32)
        bent = np.zeros((len(m.column) if both else 0, 3, 3), np.float32)
        _add_change(
            self.duct.walls.positions, self.duct.nodes.cells, self.unknown, velocity, self.weights, self.values,
            self.slopes, both, m.start, m.column, carried, bent,
        )  # fmt: skip
        for six, weight, values, normal in self.planes:
            u = np.einsum("qk,fka->fqa", values, velocity[six])
            place = _places(m.start, m.column, six)
            by = np.einsum("fq,fqa,fa->fq", weight, u, normal)
            np.add.at(carried, place, np.einsum("fq,qk,qm->fkm", by, values, values))
            if both:
                np.add.at(bent, place, np.einsum("fq,fqa,fb,qk,qm->fkmab", weight, u, normal, values, values))
        carried *= self.reynolds
        bent *= self.reynolds
        return carried, bent


def _plane(duct: Duct, name: str) -> tuple[Ints, Floats, Floats, Floats]:
    """Unknowns, weights, functions at the points, and unit normals of the triangles of a plane patch."""
    triangles = duct.triangles[name]
    area = duct.face_areas(name)
    size = np.linalg.norm(area, axis=1)
    _, weights, values, _ = triangle_rule()
    six = duct.unknown[duct.nodes.of_triangles(triangles)]
    return six, 2.0 * size[:, None] * weights, values, area / size[:, None]


def _places(start: Ints, column: Indices, six: Ints) -> Ints:
    """Places in a pattern of the pairs of unknowns of each triangle, (f, 6, 6) array."""
    return _find(start, column, six)


@compiled
def _find(start: Ints, column: Indices, six: Ints) -> Ints:
    found = np.empty((len(six), 6, 6), np.int64)
    for face in range(len(six)):
        for k in range(6):
            for m in range(6):
                found[face, k, m] = place_of(start, column, six[face, k], six[face, m])
    return found
