"""What a filter is worth: figure of merit in both senses in use, and the HEPA requirement (Eqs. 3, A34)."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass

import numpy as np

from pipeline.analytics.formulas.numbers import Numbers
from pipeline.nouns.arrays import Floats

HEPA_EFFICIENCY = 0.9997
HEPA_PARTICLE = 300e-9
"""Particle diameter of the HEPA test [m]."""

HEPA_VELOCITY = 0.025
"""Face velocity of the HEPA test [m/s]."""

HEPA_PRESSURE_DROP = 320.0
"""Largest pressure drop at that velocity [Pa]."""


def figure_of_merit(depth: Numbers, pressure_drop: Numbers) -> Floats:
    r"""Quality factor, Eqs. 3 and A34: :math:`-\ln(P_F)/\Delta p` [1/Pa].

    Layers of one medium share it, whatever their number.

    Parameters
    ----------
    depth : float or array [-]
        :math:`-\ln P_F`, see `single_fiber.capture_depth`.
    pressure_drop : float or array [Pa]

    Returns
    -------
    array [1/Pa]

    Notes
    -----
    Erratum: no figure of merit that the paper prints is this; see `efficiency_per_pascal`.

    Examples
    --------
    >>> round(float(figure_of_merit(1.738, 326.5)), 5)
    0.00532
    """
    value: Floats = np.asarray(depth) / pressure_drop
    return value


def efficiency_per_pascal(efficiency: Numbers, pressure_drop: Numbers) -> Floats:
    r"""Efficiency per pressure drop, the paper's figure of merit in Figs. 10 to 12: :math:`E_F/\Delta p` [1/Pa].

    Parameters
    ----------
    efficiency : float or array [-]
    pressure_drop : float or array [Pa]

    Returns
    -------
    array [1/Pa]

    Notes
    -----
    Erratum: Table A6 prints :math:`1/\Delta p` for it, which is this with efficiency 1.

    Examples
    --------
    >>> round(float(efficiency_per_pascal(0.45, 21.2)), 4)
    0.0212
    """
    value: Floats = np.asarray(efficiency) / pressure_drop
    return value


@dataclass(frozen=True, slots=True)
class HepaCheck:
    """Whether a filter meets the HEPA requirement as the paper states it (Section 5.2).

    Parameters
    ----------
    efficiency : float [-]
        At 300 nm and 2.5 cm/s; at least 0.9997.
    pressure_drop : float [Pa]
        At 2.5 cm/s; at most 320 Pa.
    """

    efficiency: float
    pressure_drop: float

    @property
    def efficient(self) -> bool:
        """Whether it holds back enough."""
        return self.efficiency >= HEPA_EFFICIENCY

    @property
    def permeable(self) -> bool:
        """Whether it resists little enough."""
        return self.pressure_drop <= HEPA_PRESSURE_DROP

    @property
    def passes(self) -> bool:
        """Whether both hold."""
        return self.efficient and self.permeable
