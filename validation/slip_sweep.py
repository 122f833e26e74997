"""One mesh solved with several slip lengths: what thin air adds to the permeability of a mat."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Sequence

from pipeline.analytics.formulas.slip import slip_length
from pipeline.machine import cores
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.solve.stokes.creeping import creep
from pipeline.solve.stokes.sharing import team
from pipeline.solve.stokes.solver import duct_of
from pipeline.solve.stokes.system import DuctFlow, System

_TOLERANCE = 1e-4
_MOST = 1000


def permeability_gains(mesh: FaceMesh, domain: FluidDomain, sides: str, knudsen: Sequence[float]) -> list[float]:
    """Solve the creeping flow through a mesh without slip and at several Knudsen numbers.

    Parameters
    ----------
    mesh : FaceMesh
        Of tetrahedra.
    domain : FluidDomain
        What it was made of.
    sides : str
        ``enclosure.sides`` of its case.
    knudsen : sequence of float [-]
        Mean free paths over the mean fiber radius.

    Returns
    -------
    list of float [-]
        By how much of itself the permeability grows at each of them.

    Raises
    ------
    StageError
        If the mesh cannot be solved on.
    """
    duct = duct_of(mesh, domain, sides)
    found: dict[float, DuctFlow] = {}
    with team(cores()) as threads:
        # each from the one before it, which has less slip
        start = None
        for kn in (0.0, *sorted(knudsen)):
            # a diameter is the duct's unit, two radii
            system = System(duct, 0.5 * float(slip_length(kn)), threads)
            start = found[kn] = creep(system, _TOLERANCE, _MOST, lambda *_: None, start)
    return [found[0.0].drop / found[kn].drop - 1.0 for kn in knudsen]
