"""Whether a flow is one that the solvers' equations hold for: air that flows, steady, and not compressed."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT, knudsen, regime
from pipeline.errors import StageError
from pipeline.nouns.flow import Flow

MOST_REYNOLDS = 40.0
"""Reynolds number between the fibers up to which the flow is taken for steady: a single cylinder sheds vortices from 47
on (Williamson 1996), and among others it does so later."""
MOST_MACH = 0.3
"""Mach number below which air is not compressed: its density changes by the half of its square, 4.5 %."""
_HEATS = 1.4  # of air at constant pressure over constant volume
_GAS = 287.05  # J/(kg K), of air


def reynolds(flow: Flow, diameter: float) -> float:
    """Fiber Reynolds number [-] from the face velocity; `diameter` in m."""
    return flow.density * flow.face_velocity * diameter / flow.viscosity


def mach(flow: Flow, speed: float) -> float:
    """Mach number [-] of a speed [m/s] in air of this temperature."""
    return speed / math.sqrt(_HEATS * _GAS * flow.temperature)


def refuse_regime(flow: Flow, diameter: float, solidity: float, fiber_wall: str) -> None:
    """Refuse a flow that no steady equations of an incompressible continuum hold for.

    Parameters
    ----------
    flow : Flow
    diameter : float [m]
        Of the fibers, mean.
    solidity : float [-]
        Of the mat.
    fiber_wall : "slip" or "no_slip"

    Raises
    ------
    StageError
        If air between the fibers is not laminar, is compressed, or does not slip but fly.
    """
    between = flow.face_velocity / (1.0 - solidity)
    number = reynolds(flow, diameter) / (1.0 - solidity)
    if mach(flow, between) > MOST_MACH:
        raise StageError(
            f"the Mach number between the fibers is {mach(flow, between):.3g}: above {MOST_MACH} air is compressed, "
            f"which the flow's equations leave out; lower flow.face_velocity, {flow.face_velocity:.4g} m/s"
        )
    if number > MOST_REYNOLDS:
        raise StageError(
            f"the Reynolds number between the fibers is {number:.3g}: above {MOST_REYNOLDS:g} fibers may shed vortices "
            "and no steady laminar flow is to be trusted; lower flow.face_velocity or mat.fiber_diameter"
        )
    gap = diameter * (math.sqrt(math.pi / (4.0 * solidity)) - 1.0)
    length = SLIP_COEFFICIENT * flow.mean_free_path
    if fiber_wall == "slip" and length > gap:
        kn = float(knudsen(flow.mean_free_path, diameter))
        raise StageError(
            f"the slip length, {1e9 * length:.4g} nm, is beyond the gap between fibers, {1e9 * gap:.4g} nm "
            f"(Knudsen number {kn:.3g}, {regime(kn)} flow): molecules fly from fiber to fiber, and no flow equation "
            'holds; raise flow.pressure or the fiber diameter, or set flow.fiber_wall to "no_slip" for an upper bound'
        )


def refuse_compressed(flow: Flow, fastest: float) -> None:
    """Refuse a solved flow whose fastest air [m/s], in the gaps, is compressed.

    Raises
    ------
    StageError
        If its Mach number is above `MOST_MACH`.
    """
    if mach(flow, fastest) > MOST_MACH:
        raise StageError(
            f"the air reaches {fastest:.4g} m/s in the gaps, a Mach number of {mach(flow, fastest):.3g}: above "
            f"{MOST_MACH} it is compressed, which the flow's equations leave out; lower flow.face_velocity"
        )
