"""`fibertwin init`, `cases` and `schema`: the case file before there is one."""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib.metadata
import json
import re
import tomllib
from pathlib import Path

import pytest

from pipeline.case import Case, read_case
from pipeline.cli.bundled import bundled
from pipeline.cli.describe import keys
from pipeline.cli.starting import first_case
from pipeline.mesh.engines.registry import ENGINES
from tests.cli.conftest import Fibertwin

GENERATORS = ("layered", "box", "array", "file", "surface")


@pytest.mark.parametrize("generator", GENERATORS)
def test_a_first_case_is_valid_as_it_stands(fibertwin: Fibertwin, generator: str, tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    assert fibertwin("init", path, "--generator", generator).code == 0
    assert read_case(path).mat.generator == generator


@pytest.mark.parametrize("generator", GENERATORS)
def test_defaults_in_comments_are_what_holds_when_they_are_left_out(generator: str, tmp_path: Path) -> None:
    text = first_case(generator)
    shown = tmp_path / "shown.toml"
    # every commented key becomes a real one, except examples of what is not set
    shown.write_text(re.sub(r"^#(?=[a-z_]+ = )(?!.*this is an example)", "", text, flags=re.MULTILINE))
    plain = tmp_path / "plain.toml"
    plain.write_text(text)
    assert shown.read_text().count("\n#") < text.count("\n#")
    assert read_case(shown) == read_case(plain)


@pytest.mark.parametrize("generator", ["layered", "box"])
def test_every_way_to_write_diameters_and_directions_loads_when_it_is_uncommented(
    generator: str, tmp_path: Path
) -> None:
    text = first_case(generator)
    shown = re.findall(r"^# ((fiber_diameter|orientation) = \{.*)$", text, flags=re.MULTILINE)
    kinds = {
        f"{key} {match[1]}" for line, key in shown if (match := re.search(r'(?:distribution|law) = "(\w+)"', line))
    }
    # all laws of each, the mixture among them
    tables = next(key for key in keys(Case) if key.name == "mat").tables
    drawn = next(table for table in tables if table.model_fields["generator"].default == generator)
    expected = {
        f"{key.name} {table.model_fields[name].default}"
        for key in keys(drawn)
        if key.name in ("fiber_diameter", "orientation")
        for table in key.tables
        for name in ("distribution", "law")
        if name in table.model_fields
    }
    assert kinds == expected
    assert "fiber_diameter mixture" in kinds
    for number, (line, key) in enumerate(shown):
        path = tmp_path / f"{number}.toml"
        place = re.search(rf"^#?{key} = .*$", text, flags=re.MULTILINE)
        assert place
        path.write_text(text[: place.start()] + line + text[place.end() :])
        value = getattr(read_case(path).mat, key)
        assert (getattr(value, "distribution", None) or value.law) in line


def test_every_key_of_every_stage_stands_in_a_first_case() -> None:
    tables = tomllib.loads(re.sub(r"^#(?=[a-z_]+ = )", "", first_case("layered"), flags=re.MULTILINE))
    for key in keys(Case):
        if key.name != "mat":
            settings = key.tables[0]
            unused = {
                inner.name
                for inner in keys(settings)
                if inner.takes == "a table" and getattr(settings(), inner.name) is None
            }
            assert set(tables[key.name]) == set(settings.model_fields) - unused


def test_the_tables_of_engines_that_are_not_in_use_stand_as_comments() -> None:
    text = first_case("layered")
    for name, engine in ENGINES.items():
        assert f"[tetmesh.{name}]" in text
        assert all(f"{key} = " in text for key in engine.settings.model_fields)


def test_a_file_that_is_there_stays_as_it_is(fibertwin: Fibertwin, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("mine")
    said = fibertwin("init", path)
    assert said.code == 1
    assert "is there already" in said.err
    assert path.read_text() == "mine"


def test_a_bundled_case_is_found_by_its_name_from_anywhere(
    fibertwin: Fibertwin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    said = fibertwin("run", "smoke", "--until", "mat", "--quiet")
    assert (said.code, said.out, said.err) == (0, "", "")
    assert (tmp_path / "runs/smoke/mat/manifest.json").is_file()


def test_a_name_that_is_no_case_tells_the_nearest(fibertwin: Fibertwin) -> None:
    said = fibertwin("run", "smok")
    assert said.code == 2
    assert "did you mean smoke?" in said.err


def test_cases_tells_the_question_of_each(fibertwin: Fibertwin) -> None:
    said = fibertwin("cases")
    assert said.out.count("?") >= len(bundled())


def test_run_in_json_tells_what_became_of_each_stage(fibertwin: Fibertwin, tmp_path: Path) -> None:
    first, second = (fibertwin("run", "smoke", "--until", "mat", "--out", tmp_path, "--json") for _ in range(2))
    stages = json.loads(first.out)["stages"] + json.loads(second.out)["stages"]
    assert [(stage["stage"], stage["how"]) for stage in stages] == [("mat", "made"), ("mat", "reused")]
    assert stages[0]["counts"]["fibers"] > 3


def test_the_reference_in_the_docs_is_what_the_settings_say(fibertwin: Fibertwin) -> None:
    page = Path(__file__).parents[2] / "docs/reference/case_file.md"
    # made again by: fibertwin schema --markdown > docs/reference/case_file.md
    assert page.read_text(encoding="utf-8") == fibertwin("schema", "--markdown").out


def test_the_reference_has_every_key_with_its_range(fibertwin: Fibertwin) -> None:
    said = fibertwin("schema", "--markdown").out
    assert "| `stop_energy` | number or percentage &gt;= 3 | `1000` |" in said
    assert '| `time_limit` | time &gt; 0 | `"2 h"` |' in said
    assert "### [mat.fiber_diameter.parts]" in said


def test_every_command_tells_what_each_of_its_options_does(fibertwin: Fibertwin) -> None:
    commands = re.findall(r"^│ ([a-z]+)  ", fibertwin("--help").out, re.MULTILINE)
    assert {"run", "quality", "solve", "init", "cases", "doctor", "report", "view"} <= set(commands)
    for command in commands:
        text = fibertwin(command, "--help").out
        options = re.findall(r"^│ [ *] +(\S+.*?)(?:  +(.*))?│$", text, re.MULTILINE)
        named = [(name, meaning) for name, meaning in options if name.startswith("-") or name.isupper()]
        assert all(meaning.strip() for _, meaning in named), (command, named)


def test_doctor_names_what_is_there_and_the_command_for_what_is_missing(
    fibertwin: Fibertwin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("COLUMNS", "200")
    # no window of X where there is no X
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkXOpenGLRenderWindow")
    said = fibertwin("doctor")
    # nothing that is needed is missing
    assert said.code == 0
    for line in ("apt-get install openfoam", "apt-get install openmpi-bin", "apt-get install libegl1 libgl1-mesa-dri"):
        assert line in said.out
    assert re.search(r"ok +numpy +\d", said.out)
    assert "MISSING" not in said.out


@pytest.mark.openfoam
def test_doctor_tells_openfoams_version(fibertwin: Fibertwin) -> None:
    assert re.search(r"ok +OpenFOAM +\d{4}", fibertwin("doctor").out)


def test_the_version_is_that_of_the_package(fibertwin: Fibertwin) -> None:
    assert fibertwin("--version").out.strip() == importlib.metadata.version("fibertwin")


def test_help_keeps_silent_of_switches_that_are_off(fibertwin: Fibertwin) -> None:
    assert "default" not in fibertwin("run", "--help").out
    assert "[default: layered]" in fibertwin("init", "--help").out
