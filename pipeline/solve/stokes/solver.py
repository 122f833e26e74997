"""The engine `stokes`: from a mesh of a duct and its fibers to the pressure drop, the drags and the flow."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT, knudsen, regime
from pipeline.errors import StageError
from pipeline.geometry.triangles import area_vectors
from pipeline.machine import memory_allowed
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.flow import Curve, Flow, Settling, Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS
from pipeline.progress import Progress
from pipeline.solve.bed import Bed
from pipeline.solve.regime import mach, refuse_compressed, refuse_regime, reynolds
from pipeline.solve.settings import StokesSettings
from pipeline.solve.stokes.creeping import creep
from pipeline.solve.stokes.duct import Duct
from pipeline.solve.stokes.inertia import with_inertia
from pipeline.solve.stokes.kept import KeptIterations, KeptSolve, keep_flow, kept_flow
from pipeline.solve.stokes.passage import refuse_blocked
from pipeline.solve.stokes.sharing import Team, team
from pipeline.solve.stokes.system import DuctFlow, IterationProgress, System

CREEPING_REYNOLDS = 0.1
"""Fiber Reynolds number below which inertia is left out: it changes no drop that was measured by .5 % there."""
_NODE_MEMORY = 3400  # bytes per node at the peak, measured at 210,000 cells beyond what the program itself takes
_INERTIA_MEMORY = 1300  # bytes per node more, for what changes with the velocity
_OTHER = {"slip": "no_slip", "no_slip": "slip"}


def solve_stokes(
    mesh: FaceMesh,
    domain: FluidDomain,
    flow: Flow,
    bed: Bed,
    solidity: float,
    fiber_wall: str,
    sides: str,
    settings: StokesSettings,
    progress: Progress,
    cores: int = 1,
    kept: KeptSolve | None = None,
) -> tuple[Solution, FlowField, Settling]:
    """Solve for the steady flow through a meshed duct, with the wall that the case has and with the other one.

    Parameters
    ----------
    mesh : FaceMesh
        Of tetrahedra, whose wall faces name their fiber.
    domain : FluidDomain
        What it was made of.
    flow : Flow
    bed : Bed
    solidity : float [-]
        Of the mat.
    fiber_wall : "slip" or "no_slip"
    sides : "symmetry", "slip" or "cyclic"
    settings : StokesSettings
    progress : Progress
        Told the iteration, the pressure drop and its error.
    cores : int
        That share the work; what is found does not depend on it.
    kept : KeptSolve, optional
        What a run of the same flow left that was stopped, and where this one leaves its own.

    Returns
    -------
    Solution
        With inertia where the Reynolds number is above `CREEPING_REYNOLDS`.
    FlowField
    Settling

    Raises
    ------
    StageError
        If the mesh is not of tetrahedra or lets no air through, the air is compressed, does not flow steadily or does
        not slip but fly, the memory is too small, or the iterations stall.
    """
    unit = 2.0 * float(domain.radius.mean())
    length = SLIP_COEFFICIENT * flow.mean_free_path
    refuse_regime(flow, unit, solidity, fiber_wall)
    number = reynolds(flow, unit)
    progress("solve: preparing the elements")
    duct = duct_of(mesh, domain, sides)
    _refuse_memory(duct.nodes.count, number > CREEPING_REYNOLDS, settings)
    scale = flow.viscosity * flow.face_velocity / unit
    creeping: dict[str, DuctFlow] = {}
    carried: dict[str, DuctFlow] = {}
    with team(cores) as threads:
        # without slip first: it is a good start for the one with slip
        for wall in ("no_slip", "slip") if fiber_wall == "slip" or length < unit else ("no_slip",):
            told = _telling(wall.replace("_", " "), scale, settings.tolerance, progress)
            # on its own: what one wall took is let go before the other is solved
            creeping[wall], after = _solved(
                duct, length / unit if wall == "slip" else 0.0, threads, number, settings, told,
                creeping.get("no_slip"), kept or KeptSolve(), wall,
            )  # fmt: skip
            if after is not None:
                carried[wall] = after
    found = {**creeping, **carried}
    field = _field(duct, found[fiber_wall], domain, flow, length if fiber_wall == "slip" else 0.0)
    refuse_compressed(flow, float(np.linalg.norm(field.velocity, axis=1).max()))
    before = creeping[fiber_wall].drop * scale if fiber_wall in carried else None
    curves = tuple(
        Curve(wall, tuple(at for at, _ in flown.history), tuple(scale * drop for _, drop in flown.history))
        for wall, flown in found.items()
    )
    return _solution(duct, found, before, mesh, domain, flow, bed, fiber_wall), field, Settling(curves)


def _telling(way: str, scale: float, tolerance: float, progress: Progress) -> IterationProgress:
    """Give the function that iterations tell of, with the wall's name and in Pa."""

    def told(iterations: int, drop: float, error: float) -> None:
        # an error that falls from 1 to the tolerance, in even steps on a logarithmic scale
        share = math.log(min(max(error, tolerance), 1.0)) / math.log(tolerance)
        known = f", changed by {100 * error:.2g} %" if math.isfinite(error) else ""
        progress(f"solve: {way}, iteration {iterations}, pressure drop {drop * scale:.5g} Pa{known}", max(0.0, share))

    return told


def _solved(
    duct: Duct,
    slip_length: float,
    threads: Team,
    number: float,
    settings: StokesSettings,
    told: IterationProgress,
    start: DuctFlow | None,
    kept: KeptSolve,
    wall: str,
) -> tuple[DuctFlow, DuctFlow | None]:
    """Solve for the creeping flow, and for the one with inertia where that counts; what is kept is not solved again."""
    limits = settings.tolerance, settings.max_iterations, told
    size = duct.matrices.unknowns, duct.matrices.vertices
    system: System | None = None
    creeping = kept_flow(kept, wall, *size)
    if creeping is None:
        system = System(duct, slip_length, threads)
        creeping = creep(system, *limits, start, KeptIterations(kept, wall))
        keep_flow(kept, wall, creeping)
    if number <= CREEPING_REYNOLDS or not creeping.settled:
        return creeping, None
    name = f"{wall}_with_inertia"
    carried = kept_flow(kept, name, *size)
    if carried is None:
        carried = with_inertia(system or System(duct, slip_length, threads), number, *limits, creeping, kept, name)
        keep_flow(kept, name, carried)
    return creeping, carried


def _solution(
    duct: Duct,
    found: dict[str, DuctFlow],
    creeping: float | None,
    mesh: FaceMesh,
    domain: FluidDomain,
    flow: Flow,
    bed: Bed,
    fiber_wall: str,
) -> Solution:
    """Give what was found with each wall in SI; `creeping` is the drop [Pa] without inertia, where it was solved."""
    unit = 2.0 * float(domain.radius.mean())
    scale, force = flow.viscosity * flow.face_velocity / unit, flow.viscosity * flow.face_velocity * unit
    this = found[fiber_wall]
    drop, drags = this.drop * scale, _drags(duct, this, mesh.fiber) * force
    drag = float(drags.sum())
    kn = float(knudsen(flow.mean_free_path, unit))
    return Solution(
        pressure_drop=drop,
        flow_rate=flow.face_velocity * duct.area * unit**2,
        drag=drag,
        permeability=bed.permeability(flow, drop),
        force_balance_error=this.balance,
        mass_balance_error=this.leak,
        iterations=this.iterations,
        converged=this.settled,
        effective_fiber_diameter=bed.effective_diameter(flow, drop),
        f_star=bed.f_star(flow, drag),
        engine="stokes",
        fiber_wall=fiber_wall,
        pressure_drop_error=this.error,
        pressure_drop_no_slip=found["no_slip"].drop * scale,
        pressure_drop_slip=found["slip"].drop * scale if "slip" in found else None,
        other_wall="second solve on the same mesh" if _OTHER[fiber_wall] in found else None,
        inertia=creeping is not None,
        pressure_drop_creeping=creeping,
        drag_per_fiber=tuple(drags.tolist()),
        reynolds=reynolds(flow, unit),
        mach=mach(flow, flow.face_velocity),
        knudsen=kn,
        regime=regime(kn),
        wall_edges=duct.walls.edges,
        straight_wall_edges=duct.walls.straight,
    )


def _field(duct: Duct, found: DuctFlow, domain: FluidDomain, flow: Flow, slip_length: float) -> FlowField:
    unit = 2.0 * float(domain.radius.mean())
    return FlowField(
        positions=duct.walls.positions * unit + np.array(domain.box.lower),
        cells=duct.nodes.cells,
        velocity=found.velocity[duct.unknown] * flow.face_velocity,
        pressure=found.pressure[duct.unknown[: duct.nodes.vertices]] * flow.viscosity * flow.face_velocity / unit,
        curved=duct.walls.curved,
        slip_length=slip_length,
    )


def duct_of(mesh: FaceMesh, domain: FluidDomain, sides: str) -> Duct:
    """Make a mesh ready for a flow, in mean fiber diameters.

    Parameters
    ----------
    mesh, domain, sides
        As in `solve_stokes`.

    Raises
    ------
    StageError
        If the mesh is not of tetrahedra or lets no air through.
    """
    if not mesh.tetrahedral:
        raise StageError(
            "the engine stokes takes tetrahedra, and this mesh has other cells: take a tetmesh.engine that makes "
            'tetrahedra, or set solve.engine to "openfoam"'
        )
    unit, lower = 2.0 * float(domain.radius.mean()), np.array(domain.box.lower)
    points, tets, pieces = (mesh.points - lower) / unit, mesh.tets(), domain.pieces
    triangles = {patch.name: mesh.triangles()[mesh.patch(patch.name)] for patch in mesh.patches}
    refuse_blocked(points, tets, triangles, unit, lower)
    return Duct(
        points=points,
        tets=tets,
        triangles=triangles,
        pieces=Pieces((pieces.start - lower) / unit, (pieces.end - lower) / unit, pieces.fiber, pieces.flat),
        radius=domain.radius / unit,
        upper=(np.array(domain.box.upper) - lower) / unit,
        cyclic=sides == "cyclic",
    )


def _refuse_memory(nodes: int, inertia: bool, settings: StokesSettings) -> None:
    needed = nodes * (_NODE_MEMORY + (_INERTIA_MEMORY if inertia else 0))
    allowed = memory_allowed(settings.memory_limit)
    if needed > allowed:
        raise StageError(
            f"the flow on {nodes:,} nodes takes about {needed / 1e9:.1f} GB, and {allowed / 1e9:.1f} GB may be used: "
            "raise tetmesh.edge, free memory, or raise solve.stokes.memory_limit"
        )


def _drags(duct: Duct, flow: DuctFlow, fiber: Ints) -> Floats:
    """Drag of each fiber along the flow; what holds a node counts to the fibers of the faces around it, by area."""
    triangles = duct.triangles[FIBERS]
    around = duct.unknown[duct.nodes.of_triangles(triangles)]
    area = np.broadcast_to(np.linalg.norm(area_vectors(duct.points, triangles), axis=1)[:, None], around.shape)
    whole = np.bincount(around.ravel(), area.ravel(), len(flow.force))
    drag = -(area / whole[around] * flow.force[around, 2]).sum(axis=1)
    known = fiber >= 0
    drags: Floats = np.bincount(fiber[known], drag[known], len(duct.radius)).astype(np.float64)
    return drags
