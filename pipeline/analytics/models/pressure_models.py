"""All pressure-drop models by name: what each stands for, where it comes from, and where it holds."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

import numpy as np

from pipeline.analytics.formulas import pressure_drop as formulas
from pipeline.analytics.formulas import slip
from pipeline.analytics.formulas.numbers import Numbers
from pipeline.errors import CaseError
from pipeline.nouns.arrays import Floats

Structure = Literal["measured pads", "layers across the flow", "all directions", "parallel cylinders across the flow"]

MAX_REYNOLDS = 0.05
"""Fiber Reynolds number up to which the paper neglects inertia (Appendix A.2)."""


@dataclass(frozen=True, slots=True)
class PressureModel:
    r"""A pressure-drop model, :math:`f(\alpha)` or :math:`f(\alpha, s)`, and what is known about it.

    Parameters
    ----------
    title : str
        Author and year.
    structure : str
        What kind of medium it describes.
    low, high : float [-]
        Solidity between which it holds.
    reason : str
        Why it holds there.
    coefficient : callable
        f of solidity and slip length over fiber radius.
    slips : bool
        Whether the air slips along the fibers in it.
    """

    title: str
    structure: Structure
    low: float
    high: float
    reason: str
    coefficient: Callable[[Numbers, Numbers], Numbers]
    slips: bool = False

    def notes(self, solidity: float, knudsen: float, reynolds: float) -> tuple[str, ...]:
        """Tell what is outside the model's range, in words; nothing where all is well.

        Parameters
        ----------
        solidity : float [-]
        knudsen, reynolds : float [-]
            Of the fiber.

        Returns
        -------
        tuple of str
        """
        notes = []
        if not self.low <= solidity <= self.high:
            notes.append(f"solidity {solidity:.3g} outside {self.low:g} to {self.high:g} ({self.reason})")
        if self.slips and knudsen >= slip.SLIP_LIMIT:
            notes.append(f"Kn {knudsen:.3g}: {slip.regime(knudsen)} flow, beyond slip (Kn below {slip.SLIP_LIMIT:g})")
        if not self.slips and self.structure != "measured pads" and knudsen >= slip.CONTINUUM_LIMIT:
            stuck = float(slip.kuwabara_slip(solidity, 0.0))
            excess = stuck / float(slip.kuwabara_slip(solidity, slip.slip_length(knudsen))) - 1.0
            notes.append(f"no slip: about {excess:.0%} high at Kn {knudsen:.3g}")
        if reynolds > MAX_REYNOLDS:
            notes.append(f"Re {reynolds:.3g} above {MAX_REYNOLDS:g}: inertia is neglected")
        return tuple(notes)


def _stuck(function: Callable[[Floats], Floats]) -> Callable[[Numbers, Numbers], Numbers]:
    def coefficient(solidity: Numbers, slip_length: Numbers) -> Numbers:
        return function(np.asarray(solidity, np.float64))

    return coefficient


def _layers(solidity: Numbers, slip_length: Numbers) -> Numbers:
    # imported when asked for: every case file's settings import this module, and scipy takes a tenth of a second
    from pipeline.analytics.formulas.spielman_goren import spielman_goren_layers

    return spielman_goren_layers(solidity, slip_length)


def _isotropic(solidity: Numbers, slip_length: Numbers) -> Numbers:
    from pipeline.analytics.formulas.spielman_goren import spielman_goren_isotropic

    return spielman_goren_isotropic(solidity, slip_length)


def _without_slip(coefficient: Callable[[Numbers, Numbers], Numbers]) -> Callable[[Numbers, Numbers], Numbers]:
    def stuck(solidity: Numbers, slip_length: Numbers) -> Numbers:
        return coefficient(solidity, 0.0)

    return stuck


_FIT = "a polynomial; within 10 % of the exact hexagonal array there"
_BRINKMAN = "mean-field closure for dilute media; unchecked beyond"

MODELS = MappingProxyType(
    {
        "davies": PressureModel(
            "Davies (1952)", "measured pads", 0.006, 0.3, "the pads he measured", _stuck(formulas.davies)
        ),
        "kuwabara": PressureModel(
            "Kuwabara (1959)",
            "parallel cylinders across the flow",
            0.0,
            0.3,
            "within 0.4 % of the exact hexagonal array",
            _stuck(formulas.kuwabara),
        ),
        "happel": PressureModel(
            "Happel (1959)",
            "parallel cylinders across the flow",
            0.0,
            0.3,
            "8 to 30 % below the exact hexagonal array; unchecked beyond",
            _stuck(formulas.happel),
        ),
        "henry_ariman": PressureModel(
            "Henry and Ariman (1983)",
            "parallel cylinders across the flow",
            0.015,
            0.26,
            _FIT,
            _stuck(formulas.henry_ariman),
        ),
        "rao_faghri": PressureModel(
            "Rao and Faghri (1988)",
            "parallel cylinders across the flow",
            0.02,
            0.29,
            _FIT,
            _stuck(formulas.rao_faghri),
        ),
        "spielman_goren_layers": PressureModel(
            "Spielman and Goren (1968), case 1",
            "layers across the flow",
            0.0,
            0.1,
            _BRINKMAN,
            _without_slip(_layers),
        ),
        "spielman_goren_isotropic": PressureModel(
            "Spielman and Goren (1968), case 4",
            "all directions",
            0.0,
            0.1,
            _BRINKMAN,
            _without_slip(_isotropic),
        ),
        "drummond_tahir_square": PressureModel(
            "Drummond and Tahir (1984), square array",
            "parallel cylinders across the flow",
            0.0,
            0.3,
            "series; 2.3 % off the exact array at 0.3",
            _stuck(formulas.drummond_tahir_square),
        ),
        "drummond_tahir_hexagonal": PressureModel(
            "Drummond and Tahir (1984), hexagonal array",
            "parallel cylinders across the flow",
            0.0,
            0.3,
            "series; 0.3 % off the exact array at 0.3",
            _stuck(formulas.drummond_tahir_hexagonal),
        ),
        "jackson_james": PressureModel(
            "Jackson and James (1986)",
            "all directions",
            0.0,
            0.05,
            "dilute limit; terms left out reach 5 %",
            _stuck(formulas.jackson_james),
        ),
        "kuwabara_slip": PressureModel(
            "Kuwabara's cell with slip",
            "parallel cylinders across the flow",
            0.0,
            0.3,
            "as Kuwabara's",
            slip.kuwabara_slip,
            slips=True,
        ),
        "spielman_goren_layers_slip": PressureModel(
            "Spielman and Goren, case 1, with slip",
            "layers across the flow",
            0.0,
            0.1,
            _BRINKMAN,
            _layers,
            slips=True,
        ),
        "spielman_goren_isotropic_slip": PressureModel(
            "Spielman and Goren, case 4, with slip",
            "all directions",
            0.0,
            0.1,
            _BRINKMAN,
            _isotropic,
            slips=True,
        ),
    }
)
"""The models, in the order in which tables list them."""

if TYPE_CHECKING:
    PressureModelName = str
else:
    # a model that is added to the table is a name that a case file may have
    PressureModelName = Literal[tuple(MODELS)]


def pressure_model(name: str) -> PressureModel:
    """Give the named model.

    Raises
    ------
    CaseError
        If there is no model of that name.

    Examples
    --------
    >>> pressure_model("davies").title
    'Davies (1952)'
    """
    if name not in MODELS:
        raise CaseError(f"no pressure-drop model {name!r}; write one of {', '.join(MODELS)}")
    return MODELS[name]
