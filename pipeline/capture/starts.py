"""Where particles enter: evenly over the inlet, more where more air comes in."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.capture.cells import Cells, velocities
from pipeline.capture.random_numbers import uniforms
from pipeline.capture.trajectories import Duct
from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats

_PLASTIC = 1.3247179572447460260
"""Root of x^3 = x + 1."""

_STARTS, _SHIFTS = 2**31, 2**31 + 1
"""Streams of random numbers that no particle's size uses."""

_TRIES = 1000


def starts(first: int, count: int, seed: int, duct: Duct, cells: Cells, fastest: float) -> Floats:
    r"""Places on the inlet of particles `first` to `first` + `count`, with a density that follows the flux.

    Parameters
    ----------
    first, count : int
    seed : int
    duct : Duct
    cells : Cells
    fastest : float [m/s]
        Of `fastest_inflow`.

    Returns
    -------
    (count, 3) array [m]

    Notes
    -----
    Candidates are an additive recurrence in the plane (steps :math:`1/g` and :math:`1/g^2` of the plastic number
    [1]_), shifted by the seed: as even as the plane allows, so that what air alone brings to the fibers hardly
    scatters. A place is refused with the chance that its inflow lacks to the fastest one, and drawn anew then.

    References
    ----------
    .. [1] M. Roberts, The unreasonable effectiveness of quasirandom sequences (2018), after G. Niederreiter's
       criteria for Kronecker sequences (1972).
    """
    shift = uniforms(seed, _SHIFTS, 0, 1, 2, 0)[0]
    number = np.arange(first, first + count, dtype=np.float64)
    share = np.column_stack([number / _PLASTIC + shift[0], number / _PLASTIC**2 + shift[1]]) % 1.0
    places = np.empty((count, 3))
    places[:, 2] = duct.inlet
    missing = np.arange(count)
    for turn in range(_TRIES):
        drawn = uniforms(seed, _STARTS, first, count, 3, 3 * turn)[missing]
        # the even sequence first; where the flux refuses its place, any other
        place = share[missing] if turn == 0 else drawn[:, :2]
        places[missing, 0] = duct.x0 + place[:, 0] * (duct.x1 - duct.x0)
        places[missing, 1] = duct.y0 + place[:, 1] * (duct.y1 - duct.y0)
        missing = missing[drawn[:, 2] * fastest > velocities(places[missing], cells)[:, 2]]
        if not len(missing):
            return places
    raise StageError(f"{len(missing)} of {count} particles found no inflow to start in; is the inlet closed?")


def fastest_inflow(duct: Duct, cells: Cells) -> float:
    """Largest velocity into the duct at the nodes of its inlet [m/s].

    Raises
    ------
    StageError
        If no air comes in.
    """
    straight = ~cells.curved
    at_inlet = np.abs(cells.position[cells.nodes[straight], 2] - duct.inlet) <= 1e-9 * (duct.outlet - duct.inlet)
    fastest = float(cells.flux[straight, :, 2][at_inlet].max(initial=0.0))
    if fastest <= 0.0:
        raise StageError("no air enters through the inlet; run the solve stage again with --force solve")
    return fastest
