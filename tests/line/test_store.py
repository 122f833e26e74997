# SPDX-License-Identifier: GPL-3.0-or-later

import errno
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.errors import StageError
from pipeline.line import places, store
from pipeline.line.manifest import finished, write_manifest
from pipeline.line.places import MANIFEST
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh_measures import MeshingCost
from tests.surface.mats import CROSSING


def test_a_mat_survives_the_disk_and_its_bytes_depend_on_its_content_alone(tmp_path: Path) -> None:
    for name in ("one.npz", "two.npz"):
        store.save(CROSSING, tmp_path / name)
    again = store.load(Mat, tmp_path / "one.npz")
    np.testing.assert_array_equal(again.nodes, CROSSING.nodes)
    assert (again.slab, again.seed, again.origin, again.periodic) == (CROSSING.slab, -1, "by hand", False)
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()


def test_damaged_results_are_refused_with_what_to_do(tmp_path: Path) -> None:
    broken = tmp_path / "mat" / "mat.npz"
    broken.parent.mkdir()
    broken.write_bytes(b"PK\x03\x04 cut short")
    with pytest.raises(StageError, match="--force mat"):
        store.load(Mat, broken)
    with pytest.raises(StageError, match="cannot read"):
        store.load(Mat, tmp_path / "missing.npz")


def test_pickles_are_not_opened(tmp_path: Path) -> None:
    hostile = tmp_path / "mat.npz"
    np.savez(hostile, nodes=np.array([{"run": "me"}], dtype=object), rest=np.array("{}"))
    with pytest.raises(StageError, match="cannot read"):
        store.load(Mat, hostile)


def write_and_fail(stage: Path, problem: BaseException) -> None:
    with places.side_folder(stage) as side:
        (side / "a").write_text("cut short")
        raise problem


def test_a_stage_takes_its_place_only_when_it_is_whole(tmp_path: Path) -> None:
    stage = tmp_path / "mat"
    with places.side_folder(stage) as side:
        (side / "a").write_text("first")
    with pytest.raises(KeyboardInterrupt):
        write_and_fail(stage, KeyboardInterrupt())
    assert (stage / "a").read_text() == "first"
    assert [path.name for path in tmp_path.iterdir()] == ["mat"]


def test_a_full_disk_is_a_clear_error_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(StageError, match="no space left on device"):
        write_and_fail(tmp_path / "mat", OSError(errno.ENOSPC, "No space left on device"))
    assert list(tmp_path.iterdir()) == []


def test_other_trouble_with_files_keeps_its_traceback(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), places.side_folder(tmp_path / "mat"):
        (tmp_path / "missing").read_text()


@pytest.mark.parametrize("harm", ["change", "remove", "other key", "no manifest"])
def test_a_result_is_reused_only_while_it_is_what_was_made(tmp_path: Path, harm: str) -> None:
    stage = tmp_path / "mat"
    with places.side_folder(stage) as side:
        (side / "a").write_text("content")
        write_manifest(side, {"key": "k", "seconds": 1.0, "counts": {}})
    assert finished(stage, "k") is not None
    key = "k"
    if harm == "change":
        (stage / "a").write_text("changed")
    elif harm == "remove":
        (stage / "a").unlink()
    elif harm == "other key":
        key = "another"
    else:
        (stage / MANIFEST).write_text("{ not json")
    assert finished(stage, key) is None


def test_the_digest_of_settings_does_not_depend_on_their_order() -> None:
    assert store.digest({"a": 1, "b": 2.5}) == store.digest({"b": 2.5, "a": 1})
    assert store.digest({"a": 1}) != store.digest({"a": 2})


def test_one_folder_takes_one_run_at_a_time(tmp_path: Path) -> None:
    script = (
        "import sys, pathlib; from pipeline.line import places; places.locked(pathlib.Path(sys.argv[1])).__enter__()"
    )
    with places.locked(tmp_path):
        other = subprocess.run(
            [sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, check=False
        )
    assert "another run is writing" in other.stderr
    free = subprocess.run([sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, check=False)
    assert free.returncode == 0


def test_a_file_in_the_folders_place_is_refused(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    with pytest.raises(StageError, match="is a file"), places.locked(tmp_path / "taken"):
        pass
    with pytest.raises(StageError, match="cannot write"), places.locked(tmp_path / ("x" * 300)):
        pass
    with pytest.raises(StageError, match="cannot write"), places.locked(tmp_path / "taken" / "run"):
        pass


def test_json_holds_arrays_and_dataclasses_and_no_not_a_number(tmp_path: Path) -> None:
    store.write_json(tmp_path / "a.json", {"box": CROSSING.slab, "r": CROSSING.radius, "n": np.int64(3)})
    content = json.loads((tmp_path / "a.json").read_text())
    assert content["r"] == CROSSING.radius.tolist()
    assert content["box"]["upper"] == list(CROSSING.slab.upper)
    with pytest.raises(ValueError, match="not JSON compliant"):
        store.write_json(tmp_path / "b.json", {"x": float("nan")})


@pytest.mark.parametrize(
    "value", ["NaN", "Infinity", '"NaN"', '"0.5"', "1e999", "1" + "0" * 400, "true", "null", "[1]"]
)
def test_a_number_of_a_noun_is_a_number(value: str, tmp_path: Path) -> None:
    # pydantic would take texts for numbers, and an integer of 400 digits for infinity
    (tmp_path / "cost.json").write_text(f'{{"seconds": {value}, "peak_memory": 1}}')
    with pytest.raises(StageError, match=r"(?s)cannot read .*cost\.json: .*; run the stage again with --force"):
        store.load_json(MeshingCost, tmp_path / "cost.json")
    (tmp_path / "cost.json").write_text('{"seconds": 2, "peak_memory": 1}')
    assert store.load_json(MeshingCost, tmp_path / "cost.json") == MeshingCost(2.0, 1)


def test_arrays_of_another_type_and_things_that_are_no_json_are_refused(tmp_path: Path) -> None:
    store.save(CROSSING, tmp_path / "mat.npz")
    arrays: dict[str, Any] = dict(store.read_arrays(tmp_path / "mat.npz"))
    arrays["radius"] = arrays["radius"].astype(np.float32)
    np.savez(tmp_path / "mat.npz", **arrays)
    with pytest.raises(StageError, match="radius holds float32, not float64"):
        store.load(Mat, tmp_path / "mat.npz")
    with pytest.raises(TypeError, match="set is not JSON"):
        store.write_json(tmp_path / "set.json", {"a": {1}})
    assert store.LARGEST_INTEGER == 9_223_372_036_854_775_807
