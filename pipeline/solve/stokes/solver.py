"""The engine `stokes`: from a mesh of a duct and its fibers to the pressure drop, the drags and the flow."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import time

import numpy as np
import psutil

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT, knudsen, regime
from pipeline.errors import StageError
from pipeline.geometry.triangles import area_vectors
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Pieces
from pipeline.nouns.flow import Flow, Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS
from pipeline.progress import Progress
from pipeline.solve.bed import Bed
from pipeline.solve.settings import StokesSettings
from pipeline.solve.stokes.creeping import Creep, Duct, creep
from pipeline.solve.stokes.passage import refuse_blocked

MOST_REYNOLDS = 0.5
"""Fiber Reynolds number up to which the drag of creeping flow is right within .5 %."""
_NODE_MEMORY = 2600  # bytes per node at the peak, by the sizes of its arrays at 38,000 to 150,000 cells
_MEMORY_SHARE = 0.85
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
) -> tuple[Solution, FlowField]:
    """Solve for the creeping flow through a meshed duct, with the wall that the case has and with the other one.

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

    Returns
    -------
    Solution
    FlowField

    Raises
    ------
    StageError
        If the mesh is not of tetrahedra or lets no air through, the flow is not creeping, the air does not slip but
        fly, the memory is too small, or the iterations stall.
    """
    began = time.monotonic()
    unit = 2.0 * float(domain.radius.mean())
    reynolds = flow.density * flow.face_velocity * unit / flow.viscosity
    length = SLIP_COEFFICIENT * flow.mean_free_path
    _refuse_flow(flow, reynolds, length, unit, solidity, fiber_wall)
    progress("solve: preparing the elements")
    duct = _duct(mesh, domain, unit, sides)
    _refuse_memory(duct.nodes.count, settings)
    scale = flow.viscosity * flow.face_velocity / unit
    found: dict[str, Creep] = {}
    # without slip first: it is a good start for the one with slip
    for wall in ("no_slip", "slip") if fiber_wall == "slip" or length < unit else ("no_slip",):

        def settling(iterations: int, drop: float, error: float, wall: str = wall) -> None:
            # an error that falls from 1 to the tolerance, in even steps on a logarithmic scale
            share = math.log(min(max(error, settings.tolerance), 1.0)) / math.log(settings.tolerance)
            known = f", changed by {100 * error:.2g} %" if math.isfinite(error) else ""
            progress(
                f"solve: {wall.replace('_', ' ')}, iteration {iterations}, pressure drop {drop * scale:.5g} Pa{known}",
                max(share, 0.0),
            )

        found[wall] = creep(
            duct,
            length / unit if wall == "slip" else 0.0,
            settings.tolerance,
            settings.max_iterations,
            settling,
            found.get("no_slip"),
        )
    this = found[fiber_wall]
    other = found.get(_OTHER[fiber_wall])
    drop, drags = this.drop * scale, _drags(duct, this, mesh.fiber) * flow.viscosity * flow.face_velocity * unit
    drag = float(drags.sum())
    flow_rate = flow.face_velocity * duct.area * unit**2
    kn = float(knudsen(flow.mean_free_path, unit))
    solution = Solution(
        pressure_drop=drop,
        flow_rate=flow_rate,
        drag=drag,
        permeability=bed.permeability(flow, drop),
        force_balance_error=drag / (drop * duct.area * unit**2) - 1.0,
        mass_balance_error=this.leak,
        iterations=this.iterations,
        converged=this.settled,
        seconds=time.monotonic() - began,
        cores=1,
        effective_fiber_diameter=bed.effective_diameter(flow, drop),
        f_star=bed.f_star(flow, drag),
        engine="stokes",
        fiber_wall=fiber_wall,
        pressure_drop_error=this.error,
        pressure_drop_no_slip=found["no_slip"].drop * scale,
        pressure_drop_slip=found["slip"].drop * scale if "slip" in found else None,
        other_wall="second solve on the same mesh" if other is not None else None,
        drag_per_fiber=tuple(drags.tolist()),
        reynolds=reynolds,
        knudsen=kn,
        regime=regime(kn),
        wall_edges=duct.walls.edges,
        straight_wall_edges=duct.walls.straight,
    )
    field = FlowField(
        positions=duct.walls.positions * unit + np.array(domain.box.lower),
        cells=duct.nodes.cells,
        velocity=this.velocity[duct.unknown] * flow.face_velocity,
        pressure=this.pressure[duct.unknown[: duct.nodes.vertices]] * scale,
        curved=duct.walls.curved,
        slip_length=length if fiber_wall == "slip" else 0.0,
    )
    return solution, field


def _duct(mesh: FaceMesh, domain: FluidDomain, unit: float, sides: str) -> Duct:
    if not mesh.tetrahedral:
        raise StageError(
            "the engine stokes takes tetrahedra, and this mesh has other cells: take a tetmesh.engine that makes "
            'tetrahedra, or set solve.engine to "openfoam"'
        )
    lower = np.array(domain.box.lower)
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


def _refuse_flow(flow: Flow, reynolds: float, length: float, unit: float, solidity: float, wall: str) -> None:
    if reynolds > MOST_REYNOLDS:
        raise StageError(
            f"the fibers' Reynolds number is {reynolds:.3g}: above {MOST_REYNOLDS} inertia counts, "
            'which the engine stokes leaves out; set solve.engine to "openfoam", or lower flow.face_velocity'
        )
    gap = unit * (math.sqrt(math.pi / (4.0 * solidity)) - 1.0)
    if wall == "slip" and length > gap:
        kn = float(knudsen(flow.mean_free_path, unit))
        raise StageError(
            f"the slip length, {1e9 * length:.4g} nm, is beyond the gap between fibers, {1e9 * gap:.4g} nm "
            f"(Knudsen number {kn:.3g}, {regime(kn)} flow): molecules fly from fiber to fiber, and no flow equation "
            'holds; raise flow.pressure or the fiber diameter, or set flow.fiber_wall to "no_slip" for an upper bound'
        )


def _refuse_memory(nodes: int, settings: StokesSettings) -> None:
    needed = nodes * _NODE_MEMORY
    allowed = settings.memory_limit or _MEMORY_SHARE * psutil.virtual_memory().available
    if needed > allowed:
        raise StageError(
            f"the flow on {nodes:,} nodes takes about {needed / 1e9:.1f} GB, and {allowed / 1e9:.1f} GB may be used: "
            "raise tetmesh.edge, free memory, or raise solve.stokes.memory_limit"
        )


def _drags(duct: Duct, flow: Creep, fiber: Ints) -> Floats:
    """Drag of each fiber along the flow; what holds a node counts to the fibers of the faces around it, by area."""
    triangles = duct.triangles[FIBERS]
    around = duct.unknown[duct.nodes.of_triangles(triangles)]
    area = np.broadcast_to(np.linalg.norm(area_vectors(duct.points, triangles), axis=1)[:, None], around.shape)
    whole = np.bincount(around.ravel(), area.ravel(), len(flow.force))
    drag = -(area / whole[around] * flow.force[around, 2]).sum(axis=1)
    known = fiber >= 0
    drags: Floats = np.bincount(fiber[known], drag[known], len(duct.radius)).astype(np.float64)
    return drags
