# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.case import Case, override, read_case, read_toml, validate
from pipeline.errors import CaseError
from pipeline.mat.settings import LayeredSettings

CASES = Path(__file__).parent.parent / "cases"

GOOD = {
    "mat": {
        "generator": "layered",
        "side": "20 um",
        "fiber_diameter": "1.4 um",
        "relaxation_slope": 0.15,
        "stop": {"coverage": 1},
    }
}


def changed(*overrides: str) -> str:
    with pytest.raises(CaseError) as caught:
        validate(override(GOOD, overrides), "case.toml")
    return str(caught.value)


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_bundled_case_is_valid_and_says_its_question_in_two_lines(path: Path) -> None:
    read_case(path)
    first, second = path.read_text().splitlines()[:2]
    assert first.startswith("# ")
    assert second.startswith("# ")
    assert "?" in second


def test_lengths_are_meters_inside() -> None:
    mat = validate(GOOD, "case.toml").mat
    assert isinstance(mat, LayeredSettings)
    assert mat.side == 20e-6


@pytest.mark.parametrize(
    ("mistake", "place", "advice"),
    [
        ("mat.side=20", "mat.side", 'like "1.4 um"'),
        ("mat.side='20 kg'", "mat.side", 'like "1.4 um"'),
        ("mat.side='-20 um'", "mat.side", "greater than 0"),
        ("mat.relaxation_slope='steep'", "mat.relaxation_slope", "steep"),
        ("mat.sides='20 um'", "mat.sides", "did you mean side?"),
        ("mat.generator='woven'", "mat.generator", "layered"),
        ("mat.generator='box'", "mat.relaxation_slope", "does not go with mat.generator = 'box'"),
        ("tetmesh.engine='gmsh'", "tetmesh.engine", "tetwild"),
        ("flow.face_velocity='0 m/s'", "flow.face_velocity", "greater than 0"),
        ("quality.skewness=0", "quality.skewness", "greater than 0"),
        ("mat.seed=-1", "mat.seed", "greater than or equal to 0"),
        ("mat.stop.coverage=1000000", "mat.stop", "fibers"),
    ],
)
def test_a_mistake_is_told_with_its_place_and_what_would_do(mistake: str, place: str, advice: str) -> None:
    message = changed(mistake)
    assert place in message
    assert advice in message


def test_a_missing_file_of_fibers_is_told_by_its_key() -> None:
    with pytest.raises(CaseError, match=r"mat\.file: missing"):
        validate({"mat": {"generator": "file"}}, "case.toml")


def test_all_mistakes_are_told_at_once() -> None:
    message = changed("mat.side=20", "tetmesh.edge=0", "flow.temperature='warm'", "surface.joint='glued'")
    assert message.startswith("case.toml has 4 mistakes:")
    for place in ("mat.side", "tetmesh.edge", "flow.temperature", "surface.joint"):
        assert place in message


def test_an_empty_stop_and_two_stops_are_refused() -> None:
    for stop in ({}, {"coverage": 1, "count": 5}):
        with pytest.raises(CaseError, match="exactly one of"):
            validate({"mat": {**GOOD["mat"], "stop": stop}}, "case.toml")


def test_setting_another_stop_replaces_the_one_in_the_file() -> None:
    case = validate(override(GOOD, ("mat.stop.thickness=9 um",)), "case.toml")
    assert isinstance(case.mat, LayeredSettings)
    assert case.mat.stop.quantity == "thickness"


def test_setting_how_a_stop_is_meant_keeps_it() -> None:
    case = override(GOOD, ("mat.stop.efficiency=0.9", "mat.stop.particle_diameter=200 nm"))
    assert case["mat"]["stop"] == {"efficiency": 0.9, "particle_diameter": "200 nm"}


@pytest.mark.parametrize("text", ["seed", "=3", "mat..seed=1", "mat.side.x=1"])
def test_an_override_that_names_no_key_is_refused(text: str) -> None:
    with pytest.raises(CaseError, match="--set"):
        override(GOOD, (text,))


def test_overriding_leaves_the_original_alone() -> None:
    override(GOOD, ("mat.seed=9", "mat.stop.count=3"))
    assert "seed" not in GOOD["mat"]
    assert GOOD["mat"]["stop"] == {"coverage": 1}


def test_broken_files_are_told_apart(tmp_path: Path) -> None:
    broken = tmp_path / "broken.toml"
    broken.write_text("[mat\nside = 3")
    with pytest.raises(CaseError, match="not valid TOML"):
        read_toml(broken)
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CaseError, match="UTF-8"):
        read_toml(binary)
    with pytest.raises(CaseError, match="cannot read"):
        read_toml(tmp_path / "missing.toml")
    with pytest.raises(CaseError, match="cannot read"):
        read_toml(tmp_path)


def test_a_case_read_back_from_its_own_json_is_the_same() -> None:
    case = validate(GOOD, "case.toml")
    again = Case.model_validate(json.loads(json.dumps(case.model_dump(mode="json"))))
    assert again == case


def test_the_schema_names_every_fixed_key() -> None:
    text = json.dumps(Case.model_json_schema())
    fixed = "generator side fiber_diameter relaxation_slope contact spacing seed stop coverage thickness solidity count"
    more = "pressure_drop efficiency inlet outlet sides engine face_velocity temperature viscosity density"
    for key in (fixed + " " + more).split():
        assert f'"{key}"' in text


@given(st.dictionaries(st.sampled_from(["mat", "flow", "tetmesh", "x"]), st.dictionaries(st.text(), st.text())))
def test_whatever_a_file_holds_only_a_case_error_comes_of_it(content: dict[str, dict[str, str]]) -> None:
    with pytest.raises(CaseError):
        validate(content, "case.toml")
