"""Creeping flow through a duct."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats
from pipeline.solve.stokes.kept import KeptIterations, KeptSolve
from pipeline.solve.stokes.krylov import gmres
from pipeline.solve.stokes.system import DuctFlow, IterationProgress, System

_STALLED = 0.5  # a run whose residual fell by less than this over `_PATIENCE` looks has stalled
_PATIENCE = 15


def creep(
    system: System,
    tolerance: float,
    most: int,
    progress: IterationProgress,
    start: DuctFlow | None = None,
    memory: KeptIterations | None = None,
) -> DuctFlow:
    """Solve for the creeping flow through a duct.

    Parameters
    ----------
    system : System
        Without inertia.
    tolerance : float
        Relative error of the pressure drop at which the iterations end, once the forces balance too.
    most : int
        Iterations after which it is given up.
    progress : callable
        Takes the iterations so far, the pressure drop and its relative change.
    start : DuctFlow, optional
        A flow through the same duct to start from.
    memory : KeptIterations, optional
        Of a run that may have been stopped.

    Returns
    -------
    DuctFlow

    Raises
    ------
    StageError
        If the iterations stall.

    Notes
    -----
    The error is known from the sharper drop of each iterate (Becker & Rannacher 2001).
    """
    memory = memory or KeptIterations(KeptSolve(), "")
    history, residuals = memory.history, memory.residuals
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
                "too flat for it; raise tetmesh.tetwild.passes where fTetWild made it, or take another tetmesh.engine"
            )
        return state["error"] < tolerance and look.balanced

    found, _, done = gmres(
        system.times,
        system.precondition,
        system.right,
        system.iterate(start),
        settled,
        most=most,
        memory=memory,
        team=system.team,
    )
    return system.result(found, state["error"], tuple(history), done)
