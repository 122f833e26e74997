"""Steady flow with inertia: Picard's iterations from the creeping flow, then Newton's."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats
from pipeline.solve.stokes.convection import Convection
from pipeline.solve.stokes.kept import KeptSolve
from pipeline.solve.stokes.krylov import gmres
from pipeline.solve.stokes.system import DuctFlow, IterationProgress, System

_PICARD = 2  # steps before Newton's: from a creeping flow they do not go astray
_EXACT = 0.03  # of the residual that a step may leave of its own linear equations
_SETTLED = 1e-6  # residual, over that of no flow at all, that no settled flow is above
_STEPS = 25
_SHORTEST = 0.1  # share of a step below which it is taken as it is, whatever becomes of the residual
_SHORTER = 0.6


def with_inertia(
    system: System,
    reynolds: float,
    tolerance: float,
    most: int,
    progress: IterationProgress,
    start: DuctFlow,
    kept: KeptSolve | None = None,
    name: str = "flow",
) -> DuctFlow:
    """Solve for the steady flow of air that has inertia.

    Parameters
    ----------
    system : System
        Has inertia from then on.
    reynolds : float
        Density x face velocity x the mesh's unit over viscosity.
    tolerance : float
        Relative change of the pressure drop over a step at which it ends, once the forces balance too.
    most : int
        Iterations of all steps together after which it is given up.
    progress : callable
        Takes the iterations so far, the pressure drop and its relative change.
    start : DuctFlow
        The creeping flow.
    kept : KeptSolve, optional
        Of a run that may have been stopped.
    name : str
        Of this flow, in what is kept.

    Returns
    -------
    DuctFlow

    Raises
    ------
    StageError
        If the steps lead to no steady flow.
    """
    system.carry(Convection(system.duct, reynolds))
    x = system.iterate(start)
    look = system.look(x)
    done, error, history, first = 0, np.inf, list(start.history), 0
    kept = kept or KeptSolve()
    before = kept.read(f"{name}-step", x=x.shape, history=(-1, 2), step=(), done=())
    if before is not None:
        x, first, done = before["x"], int(before["step"]), int(before["done"])
        history = [(int(at), float(drop)) for at, drop in before["history"]]
        kept.took_over(name.replace("_", " "), done)
    for step in range(first, _STEPS):
        rest = system.rest(x)
        system.linearize(x, both=step >= _PICARD)
        size = float(np.linalg.norm(rest))

        def close(iterations: int, change: Floats, rest: Floats = rest, size: float = size) -> bool:
            return float(np.linalg.norm(rest - system.times(change))) < _EXACT * size

        change, used, _ = gmres(
            system.times,
            system.precondition,
            rest,
            np.zeros_like(x),
            close,
            most=max(most - done, 1),
            team=system.team,
        )
        share = 1.0
        while share > _SHORTEST and float(np.linalg.norm(system.rest(x + share * change))) > size:
            share *= _SHORTER
        x, done = x + share * change, done + used
        look = system.look(x)
        error = abs(look.drop - history[-1][1]) / abs(look.drop) if look.drop else np.inf
        history.append((start.iterations + done, look.drop))
        progress(start.iterations + done, look.drop, error)
        if error < tolerance and look.balanced and look.size < _SETTLED:
            return system.result(x, error, tuple(history), True)
        if done >= most:
            return system.result(x, error, tuple(history), False)
        if kept.due:
            kept.write(
                f"{name}-step", x=x, history=np.array(history, dtype=np.float64), step=np.array(step + 1.0),
                done=np.array(float(done)),
            )  # fmt: skip
    raise StageError(
        f"the flow with inertia does not settle (residual {look.size:.1e} after {done} iterations): it may have no "
        "steady state; lower flow.face_velocity, or refine the mesh behind the fibers with tetmesh.edge"
    )
