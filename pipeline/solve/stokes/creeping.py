"""Creeping flow through a duct: the system, its solution, and its forces by the consistent residual.

All in the unit system of the mesh's length, the face velocity and the viscosity.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pipeline.errors import StageError
from pipeline.geometry.triangles import area_vectors
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.patches import FIBERS, INLET, OUTLET, SIDES
from pipeline.solve.stokes import sweeps
from pipeline.solve.stokes.conditions import Conditions, fixed_sides, no_slip, slip
from pipeline.solve.stokes.elements import Matrices, assemble, div_entries
from pipeline.solve.stokes.krylov import gmres
from pipeline.solve.stokes.multigrid import VelocityCycle, pressure_scale
from pipeline.solve.stokes.nodes import Nodes, number_nodes
from pipeline.solve.stokes.unknowns import unknown_of_nodes
from pipeline.solve.stokes.walls import Walls, curve_walls

BALANCE = 1e-6
"""Share of the pressure's force by which the forces may miss each other once a flow has settled."""
LOST = 1e-5
"""Share of the air that may be lost between inlet and outlet once a flow has settled."""
_STALLED = 0.5  # a run whose residual fell by less than this over `_PATIENCE` looks has stalled
_PATIENCE = 15
_WEIGHT = 10.0  # of the divergence beside the forces in what the iterations make small

Tell = Callable[[int, float, float], None]
"""Told the iterations, the pressure drop and its error."""


@dataclass(frozen=True, eq=False)
class Duct:
    """A meshed duct, ready for a flow.

    Parameters
    ----------
    points : (n, 3) array
        Vertices in mean fiber diameters from the duct's lower corner.
    tets : (m, 4) int array
    triangles : dict of (b, 3) int array
        Outward, by patch.
    pieces : Pieces
        The true fibers.
    radius : (fibers,) array
    upper : (3,) array
        The duct's upper corner.
    cyclic : bool
        Whether opposite sides are one; else they are planes that no air crosses.
    """

    points: Floats
    tets: Ints
    triangles: dict[str, Ints]
    pieces: Pieces
    radius: Floats
    upper: Floats
    cyclic: bool = False

    @cached_property
    def nodes(self) -> Nodes:
        """Vertices and the middles of edges."""
        return number_nodes(self.tets, len(self.points))

    @cached_property
    def unknown(self) -> Ints:
        """Unknown at each node."""
        return unknown_of_nodes(self.points, self.nodes, self.triangles, self.cyclic)

    @cached_property
    def walls(self) -> Walls:
        """The nodes where the true fibers want them."""
        return curve_walls(
            self.points, self.nodes, self.triangles[FIBERS], self.pieces, self.radius, np.zeros(3), self.upper
        )

    @cached_property
    def matrices(self) -> Matrices:
        """Stiffness, divergence and mass."""
        return assemble(self.walls.positions, self.nodes.cells, self.unknown[self.nodes.cells], self.walls.curved)

    @cached_property
    def area(self) -> float:
        """Area of the inlet."""
        return float(np.linalg.norm(area_vectors(self.points, self.triangles[INLET]).sum(axis=0)))

    def conditions(self, slip_length: float) -> Conditions:
        """Hold the flow on the boundary; on the fibers by Navier's slip, or without slip at a length of 0."""
        planes = {} if self.cyclic else {name: SIDES.index(name) // 2 for name in SIDES if name in self.triangles}
        fixed, given = fixed_sides(self.nodes, self.unknown, self.triangles, planes, INLET)
        if slip_length == 0.0:
            return no_slip(fixed, given, self.unknown[self.walls.wall])
        return slip(fixed, given, self.nodes, self.unknown, self.walls, self.triangles[FIBERS], slip_length)


@dataclass(frozen=True, eq=False, slots=True)
class Creep:
    """A creeping flow, at the unknowns of a duct.

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
        Drag on the fibers over the drop's force on the inlet, less 1.
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


def creep(
    duct: Duct, slip_length: float, tolerance: float, most: int, progress: Tell, start: Creep | None = None
) -> Creep:
    """Solve for the creeping flow through a duct.

    Parameters
    ----------
    duct : Duct
    slip_length : float
        On the fibers, in the mesh's unit; 0 for none.
    tolerance : float
        Relative error of the pressure drop at which the iterations end, once the forces balance too.
    most : int
        Iterations after which it is given up.
    tell : callable
    start : Creep, optional
        A flow through the same duct to start from.

    Returns
    -------
    Creep

    Raises
    ------
    StageError
        If the iterations stall.

    Notes
    -----
    The system is symmetric and its right side is the drop's own functional, so the drop of an iterate less the
    product of iterate and residual, the sharper one, is wrong by the square of the iterate's error only
    (Becker & Rannacher 2001).
    """
    system = _System(duct, duct.conditions(slip_length))
    history: list[tuple[int, float]] = []
    residuals: list[float] = []
    state: dict[str, float] = {"error": np.inf}

    def settled(iterations: int, x: Floats) -> bool:
        look = system.look(x)
        before = history[-1][1] if history else np.inf
        history.append((iterations, look.sharper))
        residuals.append(look.size)
        change = max(abs(look.sharper - before), abs(look.drop - look.sharper))
        state["error"] = change / abs(look.sharper) if look.sharper else np.inf
        progress(iterations, look.sharper, state["error"])
        if len(residuals) > _PATIENCE and residuals[-1] > _STALLED * residuals[-1 - _PATIENCE]:
            raise StageError(
                f"the flow stalls after {iterations} iterations (residual {look.size:.1e}): the mesh has cells "
                "too flat for it; raise tetmesh.passes, or take another tetmesh.engine"
            )
        return state["error"] < tolerance and abs(look.balance) < BALANCE and abs(look.lost) < LOST

    first = system.start(start)
    found, _, done = gmres(system.times, system.precondition, system.right, first, settled, most=most)
    return system.result(found, state["error"], tuple(history), done)


class _System:
    """The matrix of a flow over its unknowns in a row: velocities, then pressures."""

    def __init__(self, duct: Duct, conditions: Conditions) -> None:
        self.duct, self.conditions, self.matrices = duct, conditions, duct.matrices
        self.div = self.matrices.div
        if conditions.through is not None:
            self.div = self.div + div_entries(self.matrices, *conditions.through)
        self.split = 3 * self.matrices.unknowns
        middle = duct.unknown[duct.nodes.vertices :]
        ends = np.empty((self.matrices.unknowns - self.matrices.vertices, 2), np.int64)
        ends[middle - self.matrices.vertices] = duct.unknown[duct.nodes.ends]
        self.cycle = VelocityCycle(self.matrices, ends, conditions)
        self.scale_pressure = pressure_scale(self.matrices)
        self.wall = np.unique(duct.unknown[duct.walls.wall])
        self.entrance = np.unique(duct.unknown[duct.nodes.of_triangles(duct.triangles[INLET])])
        force, divergence = self.full(conditions.given, np.zeros(self.matrices.vertices))
        conditions.project(force)
        self.right = np.concatenate([-force.ravel(), -_WEIGHT * divergence])
        self.scale = float(np.linalg.norm(self.right))

    def full(self, velocity: Floats, pressure: Floats, div: Floats | None = None) -> tuple[Floats, Floats]:
        """Force and divergence of a flow before the boundary takes its part."""
        m = self.matrices
        div = m.div if div is None else div
        force, divergence = np.empty_like(velocity), np.empty(m.vertices)
        sweeps.times(m.start, m.column, m.stiff, velocity, force)
        sweeps.add_gradient(m.div_start, m.div_column, div, pressure, force)
        sweeps.divergence(m.div_start, m.div_column, div, velocity, divergence)
        return force, divergence

    def times(self, x: Floats) -> Floats:
        velocity = x[: self.split].reshape(-1, 3)
        force, divergence = self.full(velocity, x[self.split :], self.div)
        if self.conditions.friction is not None:
            force += (self.conditions.friction @ x[: self.split]).reshape(-1, 3)
        self.conditions.project(force)
        return np.concatenate([force.ravel(), _WEIGHT * divergence])

    def precondition(self, x: Floats) -> Floats:
        """Block-triangular: the pressure by its mass, then the velocity by a cycle of multigrid."""
        m = self.matrices
        pressure = -self.scale_pressure * x[self.split :] / _WEIGHT
        force = np.zeros((m.unknowns, 3))
        sweeps.add_gradient(m.div_start, m.div_column, self.div, -pressure, force)
        force += x[: self.split].reshape(-1, 3)
        self.conditions.project(force)
        velocity = self.cycle(force)
        self.conditions.project(velocity)
        return np.concatenate([velocity.ravel(), pressure])

    def start(self, flow: Creep | None) -> Floats:
        if flow is None:
            return np.zeros_like(self.right)
        velocity = flow.velocity - self.conditions.given
        self.conditions.project(velocity)
        return np.concatenate([velocity.ravel(), flow.pressure])

    def look(self, x: Floats) -> "_Look":
        """Tell what an iterate is worth."""
        rest = self.right - self.times(x)
        rest[self.split :] /= _WEIGHT
        force, _ = self.full(x[: self.split].reshape(-1, 3) + self.conditions.given, x[self.split :])
        inlet, drag = float(force[self.entrance, 2].sum()), -float(force[self.wall, 2].sum())
        # the pressure's functions sum to 1: the sum of their residuals is the air that is lost
        lost = float(rest[self.split :].sum())
        area = self.duct.area
        return _Look(
            drop=inlet / area,
            sharper=(inlet - float(x @ rest)) / area,
            balance=drag / inlet - 1.0,
            lost=lost / area,
            size=float(np.linalg.norm(rest)) / self.scale,
        )

    def result(self, x: Floats, error: float, history: tuple[tuple[int, float], ...], settled: bool) -> Creep:
        velocity = x[: self.split].reshape(-1, 3) + self.conditions.given
        pressure = x[self.split :].copy()
        force, _ = self.full(velocity, pressure)
        look = self.look(x)
        out = _passing(self.duct, velocity, OUTLET) / self.duct.area
        return Creep(velocity, pressure, force, look.drop, error, look.balance, out - 1.0, history, settled)


@dataclass(frozen=True, slots=True)
class _Look:
    """What an iterate is worth: its drop, plain and sharper, how far forces and air miss each other, its residual."""

    drop: float
    sharper: float
    balance: float
    lost: float
    size: float


def _passing(duct: Duct, velocity: Floats, patch: str) -> float:
    """Air that leaves through a plane patch."""
    triangles = duct.triangles[patch]
    middles = duct.unknown[duct.nodes.of_triangles(triangles)[:, 3:]]
    # the mean of a quadratic on a triangle is that of the middles of its sides
    return float(np.einsum("fa,fa->", area_vectors(duct.points, triangles), velocity[middles].mean(axis=1)))
