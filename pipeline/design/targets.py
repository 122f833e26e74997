"""What was measured on a filter and shall be met."""

# SPDX-License-Identifier: GPL-3.0-or-later

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter, ValidationError

from pipeline.errors import CaseError
from pipeline.units import FROM_FILE, Fraction, Length, PositiveRatio, Pressure

_KINDS: dict[str, Any] = {
    "solidity": Fraction,
    "thickness": Length,
    "coverage": PositiveRatio,
    "pressure_drop": Pressure,
    "efficiency": Fraction,
}
QUANTITIES = tuple(_KINDS)
"""The quantities that a mat can be tuned to."""


@dataclass(frozen=True, slots=True)
class Target:
    """A quantity of a filter and the value it shall have [SI]."""

    quantity: str
    value: float

    def __str__(self) -> str:
        """Give the target in the units people use."""
        return f"{self.quantity} = {readable(self.quantity, self.value)}"


def readable(quantity: str, value: float) -> str:
    """Give a value in the units people use.

    Examples
    --------
    >>> readable("thickness", 5e-5), readable("solidity", 0.08), readable("efficiency", 0.99975)
    ('50 um', '8 %', '99.975 %')
    """
    match quantity:
        case "thickness" | "spacing" | "fiber_diameter":
            return f"{value * 1e6:.4g} um"
        case "solidity":
            return f"{value * 100:.4g} %"
        case "efficiency":
            # a good filter's efficiency is all nines: its digits are those of what it lets through
            digits = max(2, 3 - int(f"{max(1.0 - value, 1e-12) * 100:.0e}"[2:]))
            return f"{value * 100:.{digits}f}".rstrip("0").rstrip(".") + " %"
        case "pressure_drop":
            return f"{value:.4g} Pa"
        case "basis_weight":
            return f"{value * 1e3:.4g} g/m^2"
    return f"{value:.4g}"


def read_targets(texts: Iterable[str]) -> tuple[Target, ...]:
    """Read targets like ``thickness=50 um``.

    Parameters
    ----------
    texts : iterable of str
        ``quantity=value``, with one of `QUANTITIES`; each quantity once.

    Returns
    -------
    tuple of Target
        One or two.

    Raises
    ------
    CaseError
        With one line per mistake; also for more than two targets, because a mat of given fibers has no third freedom.

    Examples
    --------
    >>> [str(target) for target in read_targets(["solidity=8 %", "thickness=50 um"])]
    ['solidity = 8 %', 'thickness = 50 um']
    """
    targets: dict[str, Target] = {}
    mistakes = []
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or name not in _KINDS:
            near = difflib.get_close_matches(name, QUANTITIES, n=1)
            advice = f"did you mean {near[0]}?" if near and equals else f"write one of {', '.join(QUANTITIES)} = value"
            mistakes.append(f"--target {text!r}: {advice}")
        elif name in targets:
            mistakes.append(f"--target {text!r}: {name} is given twice")
        else:
            try:
                number = TypeAdapter(_KINDS[name]).validate_python(value, context=FROM_FILE)
                targets[name] = Target(name, float(number))
            except ValidationError as problem:
                reason = problem.errors()[0]["msg"].removeprefix("Value error, ")
                mistakes.append(f"--target {text!r}: {reason[:1].lower()}{reason[1:]}")
    if not targets and not mistakes:
        mistakes.append('give at least one target, like --target solidity=0.08 --target thickness="50 um"')
    if len(targets) > 2:
        mistakes.append(
            f"{' and '.join(targets)} cannot be met all at once: solidity x thickness = coverage x pi d / 4, and the "
            "models predict from these; give the two that you trust most"
        )
    if mistakes:
        raise CaseError("\n".join(mistakes))
    return tuple(targets.values())
