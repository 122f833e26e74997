"""What a case file says about the mat, and how it is told off."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from pipeline.mat.settings import LayeredSettings, MatSettings, Perimeter
from pipeline.units import FROM_FILE


class Case(BaseModel):
    mat: MatSettings


LAYERED: dict[str, Any] = {
    "generator": "layered",
    "side": "100 um",
    "fiber_diameter": "1.4 um",
    "relaxation_slope": 0.15,
    "stop": {"coverage": 4},
}
BOX: dict[str, Any] = {
    "generator": "box",
    "side": "100 um",
    "thickness": "20 um",
    "fiber_diameter": "1.4 um",
    "stop": {"solidity": 0.1},
}
ARRAY: dict[str, Any] = {
    "generator": "array",
    "arrangement": "square",
    "solidity": 0.1,
    "fiber_diameter": "1 um",
}


def test_a_layered_mat_is_the_papers_unless_told_otherwise() -> None:
    mat = Case.model_validate({"mat": LAYERED}, context=FROM_FILE).mat
    assert isinstance(mat, LayeredSettings)
    assert (mat.side, mat.contact, mat.spacing, mat.stop.quantity) == (1e-4, "paper", 0.0, "coverage")
    assert isinstance(mat.law, Perimeter)


def test_settings_made_in_python_go_into_a_case_as_they_are() -> None:
    mat = Case.model_validate({"mat": LAYERED}, context=FROM_FILE).mat
    assert Case(mat=mat).mat is mat


@pytest.mark.parametrize(
    ("base", "changes", "path", "reason"),
    [
        (LAYERED, {"generator": "pile"}, "mat.generator", 'one of "layered", "box", "array", "file"'),
        (LAYERED, {"generator": None}, "mat.generator", "must be one of"),
        (LAYERED, {"side": 100}, "mat.side", "number with a unit"),
        (LAYERED, {"side": "-1 um"}, "mat.side", "greater than 0"),
        (LAYERED, {"fiber_diameter": "1.4"}, "mat.fiber_diameter", "number with a unit"),
        (LAYERED, {"fiber_diameter": {"distribution": "normal", "mean": "1 um"}}, "mat.fiber_diameter.std", "required"),
        (LAYERED, {"relaxation_slope": "steep"}, "mat.relaxation_slope", "plain number"),
        (LAYERED, {"relaxation_slope": 1.5}, "mat.relaxation_slope", "less than or equal to 1"),
        (LAYERED, {"contact": "soft"}, "mat.contact", "'paper' or 'clear'"),
        (LAYERED, {"thickness": "20 um"}, "mat.thickness", "not permitted"),
        (LAYERED, {"stop": {}}, "mat.stop", "exactly one"),
        (LAYERED, {"stop": {"coverage": 1, "count": 4}}, "mat.stop", "not coverage and count"),
        (LAYERED, {"stop": {"coverage": 1, "model": "davies"}}, "mat.stop.model", "leave it out"),
        (LAYERED, {"stop": {"count": 1, "particle_diameter": "300 nm"}}, "mat.stop.particle_diameter", "leave it out"),
        (LAYERED, {"stop": {"coverage": 400}}, "mat.stop.coverage", "takes about 3.29e.04 fibers"),
        (LAYERED, {"stop": {"count": 30}, "max_fibers": 20}, "mat.stop.count", "exceeds max_fibers = 20"),
        (LAYERED, {"orientation": "random"}, "mat.orientation", "must be one of"),
        (LAYERED, {"orientation": {"law": "von_mises"}}, "mat.orientation.concentration", "required"),
        (LAYERED, {"periodic": True, "orientation": "perimeter"}, "mat.orientation", "no perimeter"),
        (LAYERED, {"periodic": True, "broken": 0.5}, "mat.broken", "fiber_length instead"),
        (LAYERED, {"periodic": True, "fiber_length": "100 um"}, "mat.fiber_length", "below the side"),
        (LAYERED, {"fiber_length": "50 um"}, "mat.fiber_length", "only fibers of a periodic mat"),
        (LAYERED, {"broken": 1.1}, "mat.broken", "less than or equal to 1"),
        (LAYERED, {"seed": -1}, "mat.seed", "greater than or equal to 0"),
        (BOX, {"contact": "clear"}, "mat.contact", "not permitted"),
        (BOX, {"stop": {"thickness": "3 um"}}, "mat.stop.thickness", "a box has its thickness"),
        (ARRAY, {"side": "10 um"}, "mat.side", "not permitted"),
        (ARRAY, {"solidity": 0.79}, "mat.solidity", "below 0.7854"),
        (ARRAY, {"solidity": 0.78}, "mat.solidity", "gaps of 0.0035 diameters.*take 0.7699 or less"),
        (ARRAY, {"depth": "0.01 um"}, "mat.depth", "less than 0.05 fiber diameters"),
        (ARRAY, {"arrangement": "hexagonal", "solidity": 0.69}, "mat.solidity", "below 0.6802"),
    ],
)
def test_nonsense_is_told_by_the_path_that_stands_in_the_file(
    base: dict[str, Any], changes: dict[str, Any], path: str, reason: str
) -> None:
    with pytest.raises(ValidationError, match=reason) as problem:
        Case.model_validate({"mat": base | changes}, context=FROM_FILE)
    assert [".".join(map(str, error["loc"])) for error in problem.value.errors()] == [path]


def test_all_mistakes_are_told_at_once() -> None:
    wrong = LAYERED | {"side": 1, "contact": "soft", "colour": "red", "stop": {}}
    with pytest.raises(ValidationError) as problem:
        Case.model_validate({"mat": wrong}, context=FROM_FILE)
    assert {error["loc"][1] for error in problem.value.errors()} == {"side", "contact", "colour", "stop"}


def test_the_schema_offers_text_and_tables() -> None:
    schema = Case.model_json_schema()
    diameter = schema["$defs"]["LayeredSettings"]["properties"]["fiber_diameter"]
    assert diameter["anyOf"][0]["type"] == "string"
    assert {"Constant", "Mixture"} <= set(schema["$defs"])
