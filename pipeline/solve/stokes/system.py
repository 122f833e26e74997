"""The equations of a flow over the unknowns of a duct, and what an iterate of them is worth.

Forces are those of the consistent residual: what holds the air at each unknown. All in the unit system of the mesh's
length, the face velocity and the viscosity.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pipeline.nouns.arrays import Floats
from pipeline.nouns.patches import INLET, OUTLET
from pipeline.solve.stokes import sweeps
from pipeline.solve.stokes.convection import Convection
from pipeline.solve.stokes.duct import Duct
from pipeline.solve.stokes.elements import div_entries
from pipeline.solve.stokes.multigrid import VelocityCycle, pressure_scale
from pipeline.solve.stokes.sharing import Team

BALANCE = 1e-6
"""Share of the pressure's force by which the forces may miss each other once a flow has settled."""
LOST = 1e-5
"""Share of the air that may be lost between inlet and outlet once a flow has settled."""
DIVERGENCE_WEIGHT = 10.0
"""Of the divergence beside the forces in what the iterations make small."""

IterationProgress = Callable[[int, float, float], None]
"""Told the iterations, the pressure drop and its error."""


@dataclass(frozen=True, eq=False, slots=True)
class DuctFlow:
    """A flow, at the unknowns of a duct.

    Parameters
    ----------
    velocity : (unknowns, 3) array
    pressure : (vertices,) array
    force : (unknowns, 3) array
        What holds the air at each unknown, by the consistent residual: its sum over a fiber's unknowns is what holds
        the fiber, the opposite of its drag.
    drop : float
        Pressure drop: the force on the inlet over its area.
    error : float
        Of the drop, relative, as the iterations know it.
    balance : float
        Drag on the fibers and what the air's momentum gained over the drop's force on the inlet, less 1.
    leak : float
        Flow out over flow in, less 1.
    history : tuple of (int, float)
        Iterations and the drop at each look.
    settled : bool
    """

    velocity: Floats
    pressure: Floats
    force: Floats
    drop: float
    error: float
    balance: float
    leak: float
    history: tuple[tuple[int, float], ...]
    settled: bool

    @property
    def iterations(self) -> int:
        """Iterations that it took."""
        return self.history[-1][0]


@dataclass(frozen=True, slots=True)
class Look:
    """What an iterate is worth: its drop, plain and sharper, how far forces and air miss each other, its residual."""

    drop: float
    sharper: float
    balance: float
    lost: float
    size: float

    @property
    def balanced(self) -> bool:
        """Whether forces and air balance."""
        return abs(self.balance) < BALANCE and abs(self.lost) < LOST


class System:
    """The equations of a flow over its unknowns in a row: velocities, then pressures.

    Parameters
    ----------
    duct : Duct
    slip_length : float
        On the fibers, in the mesh's unit; 0 for none.
    team : Team, optional
        Who shares the work; one core does all where there is none.
    """

    def __init__(self, duct: Duct, slip_length: float, team: Team | None = None) -> None:
        self.duct, self.matrices, self.team = duct, duct.matrices, team or Team()
        self.conditions = conditions = duct.conditions(slip_length)
        self.div, self.grad = self.matrices.div, self.matrices.grad
        if conditions.through is not None:
            self.div = self.div + div_entries(self.matrices, *conditions.through)
            self.grad = self.div[self.matrices.grad_place]
        self.split = 3 * self.matrices.unknowns
        self.cycle = VelocityCycle(self.matrices, duct.ends, conditions, self.team)
        self.scale_pressure = pressure_scale(self.matrices)
        self.wall = duct.held
        self.entrance = np.unique(duct.unknown[duct.nodes.of_triangles(duct.triangles[INLET])])
        self.convection: Convection | None = None
        self.stiff, self.bent = self.matrices.stiff, np.empty((0, 3, 3), np.float32)
        force, divergence = self.forces(conditions.given, np.zeros(self.matrices.vertices))
        conditions.project(force)
        self.right = np.concatenate([-force.ravel(), -DIVERGENCE_WEIGHT * divergence])
        self.scale = float(np.linalg.norm(self.right))

    def carry(self, convection: Convection) -> None:
        """Let the air have inertia: from now on the equations are not linear."""
        self.convection = convection

    def forces(self, velocity: Floats, pressure: Floats) -> tuple[Floats, Floats]:
        """Give what holds the air at each unknown, and its divergence."""
        force, divergence = self._stokes(self.matrices.stiff, self.matrices.div, self.matrices.grad, velocity, pressure)
        if self.convection is not None:
            force += self.convection.force(velocity)
        return force, divergence

    def _stokes(
        self, stiff: Floats, div: Floats, grad: Floats, velocity: Floats, pressure: Floats
    ) -> tuple[Floats, Floats]:
        m = self.matrices
        force, divergence = np.empty_like(velocity), np.empty(m.vertices)
        self.team.over(0, m.unknowns, sweeps.times, m.start, m.column, stiff, velocity, force)
        self._add_gradient(grad, pressure, force)
        self.team.over(0, m.vertices, sweeps.divergence, m.div_start, m.div_column, div, velocity, divergence)
        return force, divergence

    def _add_gradient(self, grad: Floats, pressure: Floats, force: Floats) -> None:
        m = self.matrices
        self.team.over(0, m.unknowns, sweeps.add_gradient, m.grad_start, m.grad_row, grad, pressure, force)

    def linearize(self, x: Floats, both: bool) -> None:
        """Let `times` be the change of the equations about an iterate.

        Parameters
        ----------
        x : (3 unknowns + vertices,) array
        both : bool
            With the change of the velocity that carries (Newton), and not only of the one that is carried (Picard).
        """
        assert self.convection is not None
        carried, self.bent = self.convection.change(self.velocity(x), both)
        self.stiff = self.matrices.stiff + carried
        # the former one is let go before its follower is made
        del self.cycle
        self.cycle = VelocityCycle(
            self.matrices, self.duct.ends, self.conditions, self.team, carried, self.convection.reynolds
        )

    def times(self, x: Floats) -> Floats:
        """Apply the equations' matrix."""
        velocity = x[: self.split].reshape(-1, 3)
        force, divergence = self._stokes(self.stiff, self.div, self.grad, velocity, x[self.split :])
        if len(self.bent):
            m = self.matrices
            self.team.over(0, m.unknowns, sweeps.add_blocks, m.start, m.column, self.bent, velocity, force)
        return self._projected(force, divergence, x)

    def _projected(self, force: Floats, divergence: Floats, x: Floats) -> Floats:
        if self.conditions.friction is not None:
            force += (self.conditions.friction @ x[: self.split]).reshape(-1, 3)
        self.conditions.project(force)
        return np.concatenate([force.ravel(), DIVERGENCE_WEIGHT * divergence])

    def rest(self, x: Floats) -> Floats:
        """Give what is left of the equations at an iterate."""
        velocity = self.velocity(x)
        force, divergence = self._stokes(self.matrices.stiff, self.div, self.grad, velocity, x[self.split :])
        if self.convection is not None:
            force += self.convection.force(velocity)
        return -self._projected(force, divergence, x)

    def precondition(self, x: Floats) -> Floats:
        """Block-triangular: the pressure by its mass, then the velocity by a cycle of multigrid."""
        m = self.matrices
        pressure = -self.scale_pressure * x[self.split :] / DIVERGENCE_WEIGHT
        force = np.zeros((m.unknowns, 3))
        self._add_gradient(self.grad, -pressure, force)
        force += x[: self.split].reshape(-1, 3)
        self.conditions.project(force)
        velocity = self.cycle(force)
        self.conditions.project(velocity)
        return np.concatenate([velocity.ravel(), pressure])

    def velocity(self, x: Floats) -> Floats:
        """Velocity of an iterate, with what is given on the boundary; (unknowns, 3) array."""
        return x[: self.split].reshape(-1, 3) + self.conditions.given

    def iterate(self, flow: DuctFlow | None) -> Floats:
        """Give a flow as an iterate; at rest where there is none."""
        if flow is None:
            return np.zeros_like(self.right)
        velocity = flow.velocity - self.conditions.given
        self.conditions.project(velocity)
        return np.concatenate([velocity.ravel(), flow.pressure])

    def look(self, x: Floats) -> Look:
        """Tell what an iterate is worth.

        Without inertia the system is symmetric and its right side is the drop's own functional: the drop less the
        product of iterate and residual, the sharper one, is wrong by the square of the iterate's error only.
        """
        velocity = self.velocity(x)
        force, divergence = self.forces(velocity, x[self.split :])
        # where air slips, what it may not cross changes the gradient
        same = self.conditions.through is None
        rest = -self._projected(force.copy(), divergence, x) if same else self.rest(x)
        rest[self.split :] /= DIVERGENCE_WEIGHT
        inlet, drag = float(force[self.entrance, 2].sum()), -float(force[self.wall, 2].sum())
        gained = 0.0 if self.convection is None else self.convection.flux(velocity)
        # the pressure's functions sum to 1: the sum of their residuals is the air that is lost
        lost = float(rest[self.split :].sum())
        area = self.duct.area
        return Look(
            drop=inlet / area,
            sharper=(inlet - float(x @ rest)) / area,
            balance=(drag + gained) / inlet - 1.0,
            lost=lost / area,
            size=float(np.linalg.norm(rest)) / self.scale,
        )

    def result(self, x: Floats, error: float, history: tuple[tuple[int, float], ...], settled: bool) -> DuctFlow:
        """Give an iterate as a flow."""
        velocity, pressure = self.velocity(x), x[self.split :].copy()
        force, _ = self.forces(velocity, pressure)
        look = self.look(x)
        out = self.duct.passing(velocity, OUTLET) / self.duct.area
        return DuctFlow(velocity, pressure, force, look.drop, error, look.balance, out - 1.0, history, settled)
