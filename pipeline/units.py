"""Text with a unit at the door, SI floats inside.

The annotated types below are what a case file's fields are made of. From a file they take text with a unit
("1.4 um") and refuse a bare number, because a bare number is where a factor of a million hides; from Python
they also take an SI float. pint is loaded only when the first text is read.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import re
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema

if TYPE_CHECKING:
    import pint

# A product of one number and one unit: pint would also evaluate formulas, which is no business of a case file, and
# "m^9^9^9^9" would keep it busy for good: each name takes one exponent of at most two digits.
_NAME = r"[A-Za-zµμ°%]{1,24}[0-9]?(?:\s?(?:\^|\*\*)\s?-?\d{1,2})?"
_NUMBER_AND_UNIT = re.compile(
    rf"\s*(?P<number>[-+]?(?:\d{{1,40}}\.?\d{{0,40}}|\.\d{{1,40}})(?:[eE][-+]?\d{{1,4}})?)"
    rf"\s*(?P<unit>{_NAME}(?:\s?[*/ ]\s?{_NAME}){{0,5}}|)\s*",
    re.ASCII,
)

_RATIO_UNITS = ("", "%", "percent")

FROM_FILE = {"source": "file"}
"""Validation context of text that a person wrote: a bare number is refused where a unit belongs."""


@cache
def _registry() -> "pint.UnitRegistry[float]":
    import pint

    # "degC" is an offset unit: let pint turn it into kelvin instead of refusing it.
    registry: pint.UnitRegistry[float] = pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=None)
    # as data sheets write masses per area
    registry.define("m2 = meter ** 2")
    registry.define("gsm = gram / meter ** 2")
    return registry


def parse(text: str, unit: str) -> float:
    """Read a number with a unit and give it in `unit`.

    Parameters
    ----------
    text : str
        For example ``"1.4 um"``, ``"2.5 cm/s"``, ``"20 degC"``, ``"9.6 %"``.
    unit : str
        The SI unit of the answer, as pint spells it; ``""`` for a plain ratio.

    Returns
    -------
    float [unit]

    Raises
    ------
    ValueError
        If the text is no number with a unit, or the unit measures something else.

    Examples
    --------
    >>> parse("1.5 um", "m")
    1.5e-06
    >>> parse("20 degC", "kelvin")
    293.15
    """
    match = _NUMBER_AND_UNIT.fullmatch(text)
    # pint counts "GiB" and "" alike as ratios
    if match is None or (unit == "") != (match["unit"].strip() in _RATIO_UNITS):
        raise ValueError(_advice(text, unit))
    number, name = float(match["number"]), match["unit"].strip()
    value = _common(number, name, unit)
    if value is None:
        value = _by_pint(number, name, unit, text)
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is not a finite number")
    # 1.4 um must become the same float as 1.4e-6, or two spellings of one case would differ
    return float(f"{value:.15g}")


def _common(number: float, name: str, unit: str) -> float | None:
    """Convert what nearly every case file has, which spares loading pint; None for everything else."""
    if unit == "":
        return number / 100.0 if name in ("%", "percent") else number
    if (unit, name) == ("kelvin", "degC"):
        return number + 273.15
    return next((number * size for known, size in _SCALES.get(unit, ()) if known == name), None)


def _by_pint(number: float, name: str, unit: str, text: str) -> float:
    from tokenize import TokenError

    import pint

    try:
        return float(_registry().Quantity(number, name or "dimensionless").to(unit or "dimensionless").magnitude)
    except (pint.PintError, ValueError, TypeError, AttributeError, ArithmeticError, AssertionError, TokenError) as odd:
        raise ValueError(_advice(text, unit)) from odd


_EXAMPLES = {
    "m": "1.4 um",
    "m/s": "2.5 cm/s",
    "kelvin": "20 degC",
    "Pa": "320 Pa",
    "Pa*s": "1.8e-5 Pa*s",
    "kg/m^3": "1.2 kg/m^3",
    "kg/m^2": "8 g/m^2",
    "s": "20 min",
    "byte": "4 GiB",
    "degree": "70 deg",
    "": "9.5 %",
}


def _advice(value: object, unit: str) -> str:
    example = _EXAMPLES.get(unit, f"1 {unit}")
    if unit == "":
        return f'write a plain number or a percentage as text, like 0.095 or "{example}", not {value!r}'
    return f'write a number with a unit as text, like "{example}", not {value!r}'


def quantity_reader(unit: str) -> BeforeValidator:
    """Make the pydantic validator that turns text into an SI float."""

    def read(value: Any, info: ValidationInfo) -> float:
        if isinstance(value, str):
            return parse(value, unit)
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if is_number and (unit == "" or info.context is not FROM_FILE):
            try:
                return float(value)
            except OverflowError:
                raise ValueError("an integer of hundreds of digits is no quantity") from None
        raise ValueError(_advice(value, unit))

    return BeforeValidator(read)


_SCALES: dict[str, tuple[tuple[str, float], ...]] = {
    "m": (("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9)),
    "m/s": (("m/s", 1.0), ("cm/s", 1e-2), ("mm/s", 1e-3)),
    "kelvin": (("K", 1.0),),
    "Pa": (("Pa", 1.0),),
    "Pa*s": (("Pa*s", 1.0),),
    "kg/m^3": (("kg/m^3", 1.0),),
    # as data sheets of media write it
    "kg/m^2": (("kg/m^2", 1.0), ("g/m^2", 1e-3), ("g/m2", 1e-3), ("gsm", 1e-3)),
    "s": (("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3)),
    "byte": (("GiB", 2.0**30), ("MiB", 2.0**20), ("byte", 1.0)),
    "degree": (("deg", 1.0),),
    "": (("", 1.0),),
}


def written(value: float, unit: str) -> str:
    """Write an SI value as a person would in a case file: `parse` reads the same float from it.

    Parameters
    ----------
    value : float [unit]
    unit : str
        The SI unit, as for `parse`.

    Returns
    -------
    str
        With the largest unit of which it is one or more.

    Examples
    --------
    >>> written(1.4e-6, "m"), written(0.025, "m/s"), written(7200.0, "s"), written(0.04, "")
    ('1.4 um', '2.5 cm/s', '2 h', '0.04')
    """
    scales = _SCALES[unit]
    name, size = next((scale for scale in scales if abs(value) >= scale[1] * (1 - 1e-12)), scales[-1])
    return f"{float(f'{value / size:.15g}'):.15g} {name}".strip()


def _schema(unit: str, meaning: str) -> WithJsonSchema:
    # x-unit: what the value is kept in; the case-file reference writes defaults with it
    text = {"type": "string", "description": meaning, "examples": [_EXAMPLES[unit]], "x-unit": unit}
    return WithJsonSchema({"anyOf": [{"type": "number"}, text]} if unit == "" else text)


Length = Annotated[
    float, quantity_reader("m"), Field(gt=0, allow_inf_nan=False), _schema("m", "a length above 0 with its unit")
]
"""A length above 0 [m]."""

Distance = Annotated[
    float, quantity_reader("m"), Field(ge=0, allow_inf_nan=False), _schema("m", "a length of 0 or more with its unit")
]
"""A length of 0 or more [m]."""

Velocity = Annotated[
    float, quantity_reader("m/s"), Field(gt=0, allow_inf_nan=False), _schema("m/s", "a velocity above 0 with its unit")
]
"""A velocity above 0 [m/s]."""

Temperature = Annotated[
    float,
    quantity_reader("kelvin"),
    Field(gt=0, allow_inf_nan=False),
    _schema("kelvin", "a temperature with its unit"),
]
"""An absolute temperature [K]."""

Pressure = Annotated[
    float, quantity_reader("Pa"), Field(gt=0, allow_inf_nan=False), _schema("Pa", "a pressure above 0 with its unit")
]
"""A pressure or pressure difference above 0 [Pa]."""

Viscosity = Annotated[
    float,
    quantity_reader("Pa*s"),
    Field(gt=0, allow_inf_nan=False),
    _schema("Pa*s", "a dynamic viscosity above 0 with its unit"),
]
"""A dynamic viscosity above 0 [Pa s]."""

Density = Annotated[
    float,
    quantity_reader("kg/m^3"),
    Field(gt=0, allow_inf_nan=False),
    _schema("kg/m^3", "a density above 0 with its unit"),
]
"""A density above 0 [kg/m3]."""

Duration = Annotated[
    float, quantity_reader("s"), Field(gt=0, allow_inf_nan=False), _schema("s", "a time above 0 with its unit")
]
"""A time span above 0 [s]."""

Memory = Annotated[
    float, quantity_reader("byte"), Field(gt=0, allow_inf_nan=False), _schema("byte", "an amount of memory")
]
"""An amount of memory above 0 [byte]."""

Angle = Annotated[
    float,
    quantity_reader("degree"),
    Field(gt=0, lt=180, allow_inf_nan=False),
    _schema("degree", "an angle with its unit"),
]
"""An angle between 0 and 180, in degrees as mesh tools count them [degree]."""

Direction = Annotated[
    float,
    quantity_reader("degree"),
    Field(ge=-180, le=180, allow_inf_nan=False),
    _schema("degree", "an angle from -180 to 180 with its unit"),
]
"""A direction in a plane [degree]."""

Fraction = Annotated[
    float, quantity_reader(""), Field(gt=0, lt=1, allow_inf_nan=False), _schema("", "a fraction between 0 and 1")
]
"""A ratio strictly between 0 and 1, as a number or a percentage [-]."""

Ratio = Annotated[
    float, quantity_reader(""), Field(ge=0, allow_inf_nan=False), _schema("", "a plain number of 0 or more")
]
"""A plain number of 0 or more, as a number or a percentage [-]."""

PositiveRatio = Annotated[
    float, quantity_reader(""), Field(gt=0, allow_inf_nan=False), _schema("", "a plain number above 0")
]
"""A plain number above 0, as a number or a percentage [-]."""


def duration(seconds: float) -> str:
    """Give a time in the units people use.

    Examples
    --------
    >>> duration(0.0421), duration(12.34), duration(754), duration(7500)
    ('42 ms', '12.3 s', '12 min 34 s', '2 h 5 min')
    """
    if seconds < 1.0:
        return f"{1000 * seconds:.0f} ms"
    if seconds < 100.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes >= 60:
        return f"{minutes // 60} h {minutes % 60} min"
    return f"{minutes} min {rest} s"
