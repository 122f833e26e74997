"""What air does to particles of one size, and which of it a run is asked to look at."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Collection

from pipeline.analytics.models.single_fiber import SingleFiberModel, aerosol
from pipeline.capture.langevin import Motion
from pipeline.capture.settings import Mechanism
from pipeline.nouns.flow import Flow

_DIRECTIONS = {"across": (1.0, 0.0, 0.0), "with": (0.0, 0.0, 1.0), "against": (0.0, 0.0, -1.0), "none": (0.0, 0.0, 0.0)}


def motion_of(
    diameter: float,
    density: float,
    flow: Flow,
    model: SingleFiberModel,
    mechanisms: Collection[Mechanism],
    gravity: str,
) -> Motion:
    """Work out how a particle moves: by slip correction, diffusivity and relaxation time of the single-fiber model.

    Parameters
    ----------
    diameter : float [m]
    density : float [kg/m3]
    flow : Flow
    model : SingleFiberModel
        Says which slip correction and which constant of Boltzmann.
    mechanisms : collection of str
        What is left out is switched off: without interception particles are points, without inertia they follow the
        air at once, without gravity and diffusion nothing else moves them.
    gravity : {"across", "with", "against", "none"}
        Its direction to the flow; across is along x.

    Returns
    -------
    Motion

    Examples
    --------
    >>> from pipeline.analytics.models.single_fiber import preset
    >>> air = Flow(0.05, 293.0, 1.813e-5, 1.205, 65.3e-9)
    >>> motion = motion_of(300e-9, 1000.0, air, preset("paper"), ("diffusion",), "across")
    >>> f"{motion.diffusivity:.2e} {motion.contact}"
    '1.22e-10 0.0'
    """
    of_size = aerosol(model, flow, diameter, density)
    falling = float(of_size.settling_velocity) if "gravity" in mechanisms else 0.0
    x, y, z = (falling * part for part in _DIRECTIONS[gravity])
    return Motion(
        contact=0.5 * diameter if "interception" in mechanisms else 0.0,
        relaxation=float(of_size.relaxation_time) if "inertia" in mechanisms else 0.0,
        diffusivity=float(of_size.diffusivity) if "diffusion" in mechanisms else 0.0,
        settling_x=x,
        settling_y=y,
        settling_z=z,
    )
