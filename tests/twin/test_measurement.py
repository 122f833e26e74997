"""What was measured, as people write it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any

import pytest

from pipeline.case import validate_as
from pipeline.errors import CaseError
from pipeline.twin.measurement import Measurement, read_drop, read_measurement
from pipeline.twin.settings import MeasuredFilter


@pytest.mark.parametrize("sign", ["+-", "±", " +/- ", "  ±  "])
def test_a_tolerance_is_in_the_values_unit_or_a_share_of_it(sign: str) -> None:
    exact = Measurement(6e-5, 3e-6)
    for text in (f"60 um{sign}5 %", f"60 um{sign}3 um", f"0.06 mm{sign}3000 nm"):
        assert read_measurement(text, "m") == exact, text
    # of a value in percent, a tolerance in percent is a share of the value as well
    assert read_measurement(f"8 %{sign}5 %", "") == read_measurement(f"0.08{sign}0.004", "")
    # without a tolerance it is a twentieth
    assert read_measurement("60 um", "m") == exact


def test_basis_weights_are_read_as_data_sheets_write_them() -> None:
    for text in ("8 g/m^2", "8 g/m2", "8 gsm", "0.008 kg/m^2"):
        assert read_measurement(text, "kg/m^2").value == pytest.approx(8e-3, rel=1e-12), text


def test_a_pressure_drop_has_its_velocity_and_its_tolerance_in_either_order() -> None:
    for text in ("45 Pa at 5.3 cm/s +- 10 %", "45 Pa +- 10 % at 5.3 cm/s", "45 Pa ± 4.5 Pa at 53 mm/s"):
        found = read_drop(text)
        assert found.drop == Measurement(45.0, 4.5), text
        assert found.face_velocity == pytest.approx(0.053, rel=1e-12)


FILTER: dict[str, Any] = {"fiber_diameter": "1.4 um +- 3 %", "solidity": "8 %", "thickness": "60 um"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fiber_diameter": None}, "micrograph or from a fiber_diameter"),
        ({"micrograph": "web.png"}, "not both"),
        ({"solidity": None}, "a mat takes two"),
        ({"solidity": "8"}, "above 1"),
        ({"basis_weight": "8 g/m^2"}, "fiber_density"),
        ({"pressure_drop": "45 Pa"}, "one face velocity"),
        ({"pressure_drop": "45 Pa at 5 cm/s", "face_velocity": "5 cm/s"}, "one face velocity"),
        ({"pressure_drop": "45 Pa at 5 cm/s at 6 cm/s"}, "two velocities"),
        ({"thickness": "60 um +- 2 um +- 3 um"}, "two tolerances"),
        ({"thickness": "60 um +- 60 um"}, "a tolerance is above 0 and below the value"),
        ({"thickness": "60 um +- 0 um"}, "a tolerance is above 0"),
        ({"thickness": 60}, "with its unit"),
        ({"thickness": "60 kg"}, "with a unit"),
        ({"thicknes": "60 um"}, "did you mean thickness"),
        ({"pixel": "25 nm"}, "give the micrograph"),
        ({"seeds": 1}, "seeds"),
        ({"pressure_drop": "45 Pa at 5 km/s"}, "Mach"),
    ],
)
def test_what_makes_no_twin_is_told(change: dict[str, Any], message: str) -> None:
    content = {key: value for key, value in {**FILTER, **change}.items() if value is not None}
    with pytest.raises(CaseError, match=message):
        validate_as(MeasuredFilter, content, "test")


def test_a_diameters_tolerance_stands_in_its_text_or_beside_its_distribution() -> None:
    assert validate_as(MeasuredFilter, FILTER, "test").diameter_tolerance == pytest.approx(0.03, rel=1e-12)
    law = {"distribution": "lognormal", "median": "1 um", "geometric_std": 1.3}
    beside = validate_as(MeasuredFilter, {**FILTER, "fiber_diameter": law, "diameter_tolerance": "4 %"}, "test")
    assert beside.diameter_tolerance == 0.04
