"""Lengths in text files, whose unit is changed by moving the decimal point: equal lengths stay equal in any units."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import re
from decimal import Decimal
from functools import cache
from typing import NamedTuple

from pipeline.units import parse

NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,6})?"
"""Pattern of a plain number."""

_PARTS = re.compile(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eE]([+-]?[0-9]{1,6}))?")
_MICRO = 6


class Unit(NamedTuple):
    """A unit of length: 10 to the power of `shift` meters, or, where it is no power of ten, `meters`."""

    shift: int | None
    meters: float


@cache
def unit_of(text: str) -> Unit:
    """Find a unit of length by its name.

    Raises
    ------
    ValueError
        If there is no such unit, or it measures something else.

    Examples
    --------
    >>> unit_of("um").shift
    -6
    """
    meters = parse(f"1 {text}", "m")
    shift = round(math.log10(meters)) if meters > 0 else 0
    return Unit(shift if float(f"1e{shift}") == meters else None, meters)


def in_meters(text: str, unit: Unit) -> float:
    """Read a number of some unit.

    Returns
    -------
    float [m]
        The float next to what the text says, since the text's own exponent is changed: 25.6 um, 0.0256 mm and
        2.56e-5 m are one float, which 25.6 * 1e-6 and 25.6 / 1e6 are not.

    Raises
    ------
    ValueError
        If the text is no plain number: Python's own 2_0 and nan are none.

    Examples
    --------
    >>> in_meters("25.6", unit_of("um")) == in_meters("0.0256", unit_of("mm")) == 2.56e-5
    True
    """
    match = _PARTS.fullmatch(text)
    if match is None:
        finite = "" if text.lower().lstrip("+-") not in ("inf", "infinity", "nan") else "finite "
        raise ValueError(f"{text!r} is not a {finite}number")
    value = float(text) * unit.meters if unit.shift is None else float(f"{match[1]}e{int(match[2] or 0) + unit.shift}")
    if not math.isfinite(value):
        raise ValueError(f"{text!r} is not a finite number")
    return value


def in_micrometers(value: float) -> str:
    """Write a length [m] as a number of micrometers from which `in_meters` reads the same float.

    Examples
    --------
    >>> in_micrometers(2.56e-5), in_micrometers(1e-4 / 3), in_micrometers(0.0)
    ('25.6', '33.333333333333335', '0')
    """
    return format(Decimal(repr(value)).scaleb(_MICRO), "f") if value else "0"
