"""Text with a unit: what is converted without pint is what pint makes of it."""

# SPDX-License-Identifier: GPL-3.0-or-later

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.units import _SCALES, _registry, parse

KNOWN = [(unit, name) for unit, scales in _SCALES.items() for name, _ in scales if name] + [
    ("", "%"),
    ("kelvin", "degC"),
]


@given(number=st.floats(-1e6, 1e6, allow_nan=False), known=st.sampled_from(KNOWN))
def test_common_units_are_what_pint_makes_of_them(number: float, known: tuple[str, str]) -> None:
    unit, name = known
    pint = _registry().Quantity(number, name).to(unit or "dimensionless").magnitude
    # the last of fifteen digits may be rounded otherwise
    assert parse(f"{number!r} {name}", unit) == pytest.approx(float(pint), rel=1e-14, abs=1e-300)


@given(st.floats(1e-3, 999, allow_nan=False).map(lambda x: float(f"{x:.12g}")))
def test_a_length_in_micrometers_is_the_float_that_it_is_in_meters(number: float) -> None:
    assert parse(f"{number!r} um", "m") == float(f"{number!r}e-6")


@pytest.mark.parametrize(
    ("text", "unit", "value"), [("1 inch", "m", 0.0254), ("1 mi/h", "m/s", 0.44704), ("5 mbar", "Pa", 500)]
)
def test_other_units_are_pints(text: str, unit: str, value: float) -> None:
    assert parse(text, unit) == pytest.approx(value, rel=1e-14)
