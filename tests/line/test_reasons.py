"""Why a stage runs: told for every kind of cause, and nothing is made again without one."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path
from typing import Any

import pytest

from pipeline.line import code
from pipeline.line.run import FORCED, NO_RESULT, Outcome, Run, dry_run, run
from pipeline.line.store import read_json, write_json
from tests.report.contents import CASE


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    run(CASE, tmp_path, until="enclosure")
    return tmp_path


def whys(outcomes: list[Outcome]) -> dict[str, tuple[str, ...]]:
    return {outcome.stage: outcome.why for outcome in outcomes if outcome.how == "made"}


def test_what_is_not_there_yet_is_made_because_it_is_not_there(tmp_path: Path) -> None:
    assert set(whys(run(CASE, tmp_path, until="surface")).values()) == {(NO_RESULT,)}
    assert whys(run(CASE, tmp_path, until="surface")) == {}


def test_a_changed_setting_is_named_with_both_values_and_changed_files_after_it(folder: Path) -> None:
    other = CASE.model_copy(update={"mat": CASE.mat.model_copy(update={"seed": 4})})
    found = whys(run(other, folder, until="enclosure"))
    assert found["mat"] == ("mat.seed changed from 3 to 4",)
    assert found["surface"] == ("mat/mat.npz changed",)
    assert found["enclosure"] == ("surface/surface.npz changed",)


def test_a_stage_made_again_with_the_same_result_makes_nothing_else_again(folder: Path) -> None:
    assert whys(run(CASE, folder, until="enclosure", force=frozenset({"surface"}))) == {"surface": (FORCED,)}


@pytest.mark.parametrize("change", ["code", "libraries"])
def test_changed_code_and_libraries_are_named(folder: Path, monkeypatch: pytest.MonkeyPatch, change: str) -> None:
    real = {"code": code.code_of, "libraries": code.libraries_of}[change]
    name, value = {"code": ("pipeline/mat/contact.py", "0" * 64), "libraries": ("numba", "0.1")}[change]

    def other(module: str) -> dict[str, str]:
        return {**real(module), **({name: value} if module == "pipeline.mat.make" else {})}

    monkeypatch.setattr(f"pipeline.line.reasons.{change}_of", other)
    found = whys(run(CASE, folder, until="enclosure"))
    assert list(found) == ["mat"]
    if change == "code":
        assert found["mat"] == ("pipeline/mat/contact.py changed",)
    else:
        assert found["mat"][0].startswith("numba 0.")
        assert found["mat"][0].endswith(" -> 0.1")


def test_a_damaged_result_is_named_and_a_lost_record_is_no_reason(folder: Path) -> None:
    (folder / "mat" / "fibers.csv").write_text("not what was left")
    assert whys(run(CASE, folder, until="enclosure")) == {"mat": ("mat/fibers.csv is not as it was left",)}


def test_records_are_no_part_of_a_result(folder: Path) -> None:
    # what meshing cost differs each time; a mesh that is the same byte by byte makes nothing again
    run(CASE, folder, until="quality")
    manifest = read_json(folder / "tetmesh" / "manifest.json")
    assert set(manifest["records"]) == {"cost.json"}
    assert "mesh.npz" in manifest["files"]
    cost = read_json(folder / "tetmesh" / "cost.json")
    assert cost["seconds"] > 0
    assert not {"seconds", "mesher_seconds"} & read_json(folder / "tetmesh" / "measures.json").keys()
    write_json(folder / "tetmesh" / "cost.json", {**cost, "seconds": 2 * cost["seconds"]})
    assert whys(run(CASE, folder, until="quality")) == {}


def test_the_page_is_made_again_when_what_it_shows_has_changed(folder: Path) -> None:
    first = whys(run(CASE, folder, without=frozenset({"tetmesh", "quality", "export", "compare"})))
    assert first == {"report": (NO_RESULT,)}
    assert whys(run(CASE, folder, without=frozenset({"tetmesh", "quality", "export", "compare"}))) == {}
    stricter = CASE.model_copy(update={"quality": CASE.quality.model_copy(update={"skewness": 3.0})})
    again = whys(run(stricter, folder, without=frozenset({"tetmesh", "quality", "export", "compare"})))
    assert again == {"report": ("quality.skewness changed from 4.0 to 3.0",)}


@pytest.mark.parametrize(
    "harm", ["{ not json", "[]", '{"key": 1}', '{"files": {}, "records": {}, "key": "x"}', '{"files": []}']
)
def test_a_damaged_manifest_is_a_reason_and_no_traceback(folder: Path, harm: str) -> None:
    (folder / "mat" / "manifest.json").write_text(harm)
    assert "mat" in whys(run(CASE, folder, until="enclosure"))


def test_a_dry_run_tells_what_a_run_then_does_and_does_nothing(folder: Path) -> None:
    other = CASE.model_copy(update={"enclosure": CASE.enclosure.model_copy(update={"inlet": 9e-6})})
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    prospects = {each.stage: each for each in dry_run(other, folder, until="tetmesh")}
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before
    assert {name: each.would for name, each in prospects.items()} == {
        "mat": "reuse", "surface": "reuse", "enclosure": "run", "tetmesh": "run",
    }  # fmt: skip
    assert any("enclosure.inlet changed from" in why for why in prospects["enclosure"].why)
    made = whys(run(other, folder, until="enclosure"))
    assert made == {"enclosure": prospects["enclosure"].why}


def test_a_dry_run_says_what_follows_from_a_stage_that_runs(folder: Path) -> None:
    prospects = {each.stage: each for each in dry_run(CASE, folder, until="enclosure", force=frozenset({"mat"}))}
    assert prospects["surface"].would == "follow"
    assert prospects["surface"].why == ("if mat changes",)
    assert prospects["enclosure"].why == ("if surface changes",)


def test_the_manifest_says_why(folder: Path) -> None:
    manifest: dict[str, Any] = json.loads((folder / "mat" / "manifest.json").read_text())
    assert manifest["why"] == [NO_RESULT]


def test_the_inputs_of_a_stage_are_the_files_of_the_nouns_it_needs(folder: Path) -> None:
    manifest = Run(CASE, folder).manifest("surface")
    assert manifest is not None
    assert set(manifest["inputs"]) == {"mat/mat.npz"}


def with_manifest(folder: Path, part: str, change: dict[str, Any], gone: int = 0) -> tuple[str, ...]:
    """Why the mat is made again when its manifest tells otherwise in one part, and lacks the first of its entries."""
    path = folder / "mat" / "manifest.json"
    content = read_json(path)
    rest = dict(list(content[part].items())[gone:])
    write_json(path, {**content, part: {**rest, **change}})
    return whys(run(CASE, folder, until="mat"))["mat"]


def test_three_files_are_named_and_the_others_counted(folder: Path) -> None:
    files = list(read_json(folder / "mat" / "manifest.json")["code"])
    assert len(files) > 6
    told = with_manifest(folder, "code", {}, gone=5)
    assert told == (*(f"{name} is new" for name in files[:3]), "2 more files changed")
    assert with_manifest(folder, "code", {}, gone=3) == tuple(f"{name} is new" for name in files[:3])
    assert with_manifest(folder, "code", {"pipeline/old.py": "0"}) == ("pipeline/old.py is gone",)


def test_libraries_that_come_or_go_are_named(folder: Path) -> None:
    now = read_json(folder / "mat" / "manifest.json")["libraries"]
    first = next(iter(now))
    assert with_manifest(folder, "libraries", {}, gone=1) == (f"{first} not there -> {now[first]}",)
    assert with_manifest(folder, "libraries", {"oldlib": "1.0"}) == ("oldlib 1.0 -> not there",)


def test_long_values_are_cut_and_many_settings_counted(folder: Path) -> None:
    mat = read_json(folder / "mat" / "manifest.json")["parameters"]["mat"]
    told = with_manifest(folder, "parameters", {"mat": {**mat, "side": "x" * 61}})
    assert told == (f"mat.side changed from {'x' * 60}... to {mat['side']}",)
    told = with_manifest(folder, "parameters", {"mat": {**mat, "side": "x" * 60}})
    assert told == (f"mat.side changed from {'x' * 60} to {mat['side']}",)
    told = with_manifest(folder, "parameters", {"mat": {**mat, "a": 1, "b": 2, "c": 3, "d": 4}})
    assert told == (
        *(f"mat.{name} changed from {k} to nothing" for k, name in enumerate("abc", 1)),
        "1 more settings changed",
    )


def test_a_key_of_another_content_is_damage(folder: Path) -> None:
    path = folder / "mat" / "manifest.json"
    write_json(path, {**read_json(path), "key": "0" * 64})
    assert whys(run(CASE, folder, until="mat"))["mat"] == ("its manifest is damaged",)
