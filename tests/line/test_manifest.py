"""A manifest is believed only in the form in which it was written; what is no part of a result is kept apart."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import os
from pathlib import Path
from typing import Any

import pytest

from pipeline.line.manifest import damaged, finished, read_manifest, write_manifest
from pipeline.line.places import MANIFEST
from pipeline.line.store import LARGEST_INTEGER

CONTENT = {
    "stage": "mat",
    "key": "k",
    "why": ["no result yet"],
    "parameters": {"mat": {"seed": 1}},
    "sources": {"fibers.csv": "s"},
    "inputs": {"mat/mat.npz": "i"},
    "code": {"pipeline/mat/make.py": "c"},
    "libraries": {"numpy": "2.0"},
    "seconds": 0.5,
    "peak_memory": 1000,
    "counts": {"fibers": 3, "closed": True, "name": "a", "none": None, "sizes": [1, 2.5, "x"]},
}


@pytest.fixture(name="stage")
def _stage(tmp_path: Path) -> Path:
    (tmp_path / "deep").mkdir()
    for name in ("mat.npz", "cost.json", "log.mesher", "deep/log.solver", "deep/field"):
        (tmp_path / name).write_text(name)
    write_manifest(tmp_path, CONTENT, ("cost.json", "log.*", "*/log.*"))
    return tmp_path


def with_another(stage: Path, changes: dict[str, Any]) -> dict[str, Any] | None:
    path = stage / MANIFEST
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    return read_manifest(stage)


def test_results_and_records_are_kept_apart(stage: Path) -> None:
    found = read_manifest(stage)
    assert found is not None
    assert sorted(found["files"]) == ["deep/field", "mat.npz"]
    assert sorted(found["records"]) == ["cost.json", "deep/log.solver", "log.mesher"]
    assert {name: found[name] for name in CONTENT} == CONTENT
    assert finished(stage, "k") == found
    assert finished(stage, "another") is None


def test_a_lost_record_is_no_damage_and_a_changed_or_linked_result_is(stage: Path) -> None:
    (stage / "log.mesher").unlink()
    assert finished(stage, "k") is not None
    (stage / "mat.npz").rename(stage / "moved")
    (stage / "mat.npz").symlink_to("moved")
    found = read_manifest(stage)
    assert found is not None
    assert damaged(stage, found) == ["mat.npz"]
    assert finished(stage, "k") is None


TABLES = ("sources", "inputs", "code", "libraries", "files", "records")


def each(names: tuple[str, ...], *wrongs: object) -> list[tuple[str, object]]:
    return [(name, wrong) for name in names for wrong in wrongs]


PATHS = ("", ".", "/a", "../a", "a/../../b", "a\0b")
VALUES: tuple[object, ...] = ({}, [[1]], [None], [True], LARGEST_INTEGER + 1, -(2**64))
WRONG = [
    *each(TABLES, None, [], "x", {"a": 1}, {"a": None}),
    *each(("stage", "key"), None, 1, ["mat"]),
    *each(("parameters", "counts"), None, [], "x"),
    *each(("seconds", "peak_memory"), None, "1", True, -1, LARGEST_INTEGER + 1, 1e19, [1]),
    *each(("why",), None, "x", {}, [1], ["a", None]),
    *each(("counts",), *({"a": value} for value in VALUES)),
    *each(("files", "records"), *({path: "d"} for path in PATHS)),
]


@pytest.mark.parametrize(("name", "wrong"), WRONG)
def test_what_none_of_ours_holds_is_no_manifest(stage: Path, name: str, wrong: object) -> None:
    assert with_another(stage, {name: wrong}) is None


@pytest.mark.parametrize("name", [*sorted(CONTENT), "files", "records"])
def test_nothing_may_be_missing(stage: Path, name: str) -> None:
    path = stage / MANIFEST
    content = json.loads(path.read_text())
    del content[name]
    path.write_text(json.dumps(content))
    assert read_manifest(stage) is None


def test_what_is_at_the_limit_is_taken(stage: Path) -> None:
    fine: dict[str, Any] = {"seconds": 0, "peak_memory": LARGEST_INTEGER, "why": [], "counts": {"a": [], "b": -2.5}}
    assert with_another(stage, {**fine, "files": {"a/b": "d", ".c": "d"}}) is not None


def test_neither_a_link_nor_a_pipe_nor_another_text_is_a_manifest(stage: Path, tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to(stage, target_is_directory=True)
    assert read_manifest(link) is None
    for text in ("[]", "{", "1", '"x"', "[" * 100_000):
        (stage / MANIFEST).write_text(text)
        assert read_manifest(stage) is None
    (stage / MANIFEST).unlink()
    assert read_manifest(stage) is None
    os.mkfifo(stage / MANIFEST)
    assert read_manifest(stage) is None
