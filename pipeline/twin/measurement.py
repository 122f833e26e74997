"""A measured value with its tolerance, as people write it: ``60 um +- 5 %``."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BeforeValidator

from pipeline.units import parse

USUAL = 0.05
"""Tolerance of a value that is given without one, as a share of it."""
_BETWEEN = re.compile(r"\s*(?:\+-|\+/-|±)\s*")
_AT = re.compile(r"\s+at\s+")


@dataclass(frozen=True, slots=True)
class Measurement:
    """A value and how far off it may be, either way [SI].

    Parameters
    ----------
    value : float
        Above 0.
    tolerance : float
        Above 0 and below the value.
    """

    value: float
    tolerance: float

    def __post_init__(self) -> None:
        if not self.value > 0:
            raise ValueError(f"what is measured is above 0, not {self.value:g}")
        if not 0 < self.tolerance < self.value:
            raise ValueError(f"a tolerance is above 0 and below the value {self.value:g}, not {self.tolerance:g}")

    @property
    def low(self) -> float:
        """Least value within the tolerance."""
        return self.value - self.tolerance

    @property
    def high(self) -> float:
        """Largest value within the tolerance."""
        return self.value + self.tolerance

    def miss(self, value: float) -> float:
        """Give by how many tolerances a value is off; from -1 to 1 it is within them."""
        return (value - self.value) / self.tolerance


@dataclass(frozen=True, slots=True)
class MeasuredDrop:
    """A pressure drop [Pa] and the face velocity [m/s] at which it was measured, None where that is told elsewhere."""

    drop: Measurement
    face_velocity: float | None


def read_measurement(text: Any, unit: str) -> Measurement:
    """Read a value and its tolerance.

    Parameters
    ----------
    text : str
        The value with its unit, and its tolerance in the same kind of unit or, in percent, as a share of the value; a
        number is a plain ratio. Without a tolerance it is `USUAL`.
    unit : str
        The SI unit, as for `pipeline.units.parse`.

    Raises
    ------
    ValueError
        If it is none.

    Examples
    --------
    >>> read_measurement("60 um +- 5 %", "m"), read_measurement("8 % ± 5 %", "")
    (Measurement(value=6e-05, tolerance=3e-06), Measurement(value=0.08, tolerance=0.004))
    """
    if not isinstance(text, str):
        if unit or isinstance(text, bool) or not isinstance(text, (int, float)):
            raise ValueError(f'write a value with its unit and tolerance as text, like "60 um +- 5 %", not {text!r}')
        text = f"{text:g}"
    first, *rest = _BETWEEN.split(text.strip())
    if len(rest) > 1:
        raise ValueError(f"{text!r} has two tolerances; write one")
    value = parse(first, unit)
    if not rest:
        return Measurement(value, USUAL * value)
    # a share in percent is one of the value, also where the value is in percent itself
    share = rest[0].rstrip().endswith(("%", "percent"))
    return Measurement(value, float(f"{(value * parse(rest[0], '') if share else parse(rest[0], unit)):.12g}"))


def read_drop(text: Any) -> MeasuredDrop:
    """Read a pressure drop like ``45 Pa at 5.3 cm/s +- 10 %``, the tolerance behind either.

    Raises
    ------
    ValueError
        If it is none.

    Examples
    --------
    >>> read_drop("45 Pa at 5.3 cm/s +- 10 %") == read_drop("45 Pa +- 4.5 Pa at 53 mm/s")
    True
    """
    if not isinstance(text, str):
        raise ValueError(f'write it as text, like "45 Pa at 5.3 cm/s +- 10 %", not {text!r}')
    drop, *rest = _AT.split(text.strip())
    if len(rest) > 1:
        raise ValueError(f'{text!r} has two velocities; write one, like "45 Pa at 5.3 cm/s +- 10 %"')
    if not rest:
        return MeasuredDrop(read_measurement(drop, "Pa"), None)
    velocity, *tolerance = _BETWEEN.split(rest[0], maxsplit=1)
    face_velocity = parse(velocity, "m/s")
    if not face_velocity > 0:
        raise ValueError(f"a face velocity is above 0, not {velocity!r}")
    return MeasuredDrop(read_measurement(" +- ".join([drop, *tolerance]), "Pa"), face_velocity)


def _reader(unit: str) -> BeforeValidator:
    def read(value: Any) -> Measurement:
        return value if isinstance(value, Measurement) else read_measurement(value, unit)

    return BeforeValidator(read)


def _drop(value: Any) -> MeasuredDrop:
    return value if isinstance(value, MeasuredDrop) else read_drop(value)


MeasuredLength = Annotated[Measurement, _reader("m")]
"""A measured length [m]."""
MeasuredShare = Annotated[Measurement, _reader("")]
"""A measured ratio [-]."""
MeasuredWeight = Annotated[Measurement, _reader("kg/m^2")]
"""A measured mass per area [kg/m2]."""
DropAtVelocity = Annotated[MeasuredDrop, BeforeValidator(_drop)]
"""A measured pressure drop, and the face velocity it was measured at."""
