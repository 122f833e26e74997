# SPDX-License-Identifier: GPL-3.0-or-later

import math

import pytest

from pipeline.errors import CaseError
from pipeline.study.quantity import read_quantity, value_of

RESULTS = {
    "mat": {"solidity": 0.095, "thickness": 47e-6, "orientation": [[0.5, 0.0], [0.0, 0.5]], "profile": {"z": [1.0]}},
    "predict": {"pressure_drop": {"happel": None}},
}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("mat.solidity", 0.095),
        ("mat.solidity in %", 9.5),
        ("mat.thickness in um", 47.0),
        ("mat.orientation.1.1", 0.5),
    ],
)
def test_a_quantity_is_found_in_its_unit(text: str, value: float) -> None:
    assert value_of(read_quantity(text), RESULTS) == pytest.approx(value, rel=1e-12)


def test_a_model_without_an_answer_gives_no_number() -> None:
    assert math.isnan(value_of(read_quantity("predict.pressure_drop.happel"), RESULTS))


def test_models_that_do_not_hold_give_no_number() -> None:
    none = {"predict": {"no_answer": "the summed volume is 1.2 of the slab"}}
    assert math.isnan(value_of(read_quantity("predict.efficiency.total"), none))


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("mat.soldity", "mat has no soldity; did you mean solidity?"),
        ("mat.xyz", "there are solidity, thickness"),
        ("mat.profile", "a table of z"),
        ("mat.solidity.more", "mat.solidity has no more"),
    ],
)
def test_a_quantity_that_is_not_there_is_refused_with_advice(text: str, advice: str) -> None:
    with pytest.raises(CaseError, match=advice):
        value_of(read_quantity(text), RESULTS)
