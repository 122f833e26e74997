# SPDX-License-Identifier: GPL-3.0-or-later

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from pipeline.errors import StageError
from pipeline.line import places
from pipeline.line.places import disk_trouble_explained, locked, own_file, own_folder, remove, side_folder, write_text


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A folder that belongs to somebody else."""
    folder = tmp_path / "outside"
    (folder / "deep").mkdir(parents=True)
    (folder / "thesis").write_text("three years")
    (folder / "deep" / "data").write_text("more")
    return folder


def content(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def folder_with_links(place: Path, outside: Path) -> None:
    place.mkdir()
    (place / "in").symlink_to(outside)


OBSTACLES: dict[str, Callable[[Path, Path], object]] = {
    "a link to a folder": lambda place, outside: place.symlink_to(outside),
    "a link to a file": lambda place, outside: place.symlink_to(outside / "thesis"),
    "a link to nothing": lambda place, outside: place.symlink_to(outside / "nothing"),
    "a link to itself": lambda place, outside: place.symlink_to(place),
    "a file": lambda place, outside: place.write_text("in the way"),
    "a pipe": lambda place, outside: os.mkfifo(place),
    "a folder with links": folder_with_links,
}
PLACES = (".lock", "mat", ".mat.partial", ".mat.old", ".mat.kept", "case.json", ".case.json.new")


@pytest.mark.parametrize("obstacle", OBSTACLES)
@pytest.mark.parametrize("place", PLACES)
def test_nothing_in_any_place_blocks_a_stage_or_leads_outside(
    obstacle: str, place: str, tmp_path: Path, outside: Path
) -> None:
    run = tmp_path / "run"
    run.mkdir()
    before = content(outside)
    OBSTACLES[obstacle](run / place, outside)
    # twice: what is left by the first must not block the second
    for attempt in ("first", "second"):
        if (place, obstacle) == (".lock", "a folder with links"):
            # a folder is nobody's lock, and nobody's to remove
            with pytest.raises(Exception, match=r"\.lock: is a directory"), locked(run):
                pass
            return
        with locked(run):
            if place == "case.json" and obstacle == "a folder with links":
                with pytest.raises(IsADirectoryError):
                    write_text(run / "case.json", attempt)
            else:
                write_text(run / "case.json", attempt)
                assert (run / "case.json").read_text() == attempt
            with side_folder(run / "mat") as side:
                (side / "a").write_text(attempt)
        assert (run / "mat" / "a").read_text() == attempt
        assert not (run / "mat").is_symlink()
    assert {path.name for path in run.iterdir()} == {".lock", "mat", "case.json"}
    assert content(outside) == before


@pytest.mark.parametrize("obstacle", OBSTACLES)
def test_files_and_folders_of_the_run_are_its_own(obstacle: str, tmp_path: Path, outside: Path) -> None:
    before = content(outside)
    if obstacle.startswith("a link") or obstacle == "a file":
        OBSTACLES[obstacle](tmp_path / "picture.png", outside)
        own_file(tmp_path / "picture.png").write_text("drawn")
    OBSTACLES[obstacle](tmp_path / "pictures", outside)
    (own_folder(tmp_path, "pictures") / "a").write_text("drawn")
    assert content(outside) == before
    remove(tmp_path / "pictures")
    assert content(outside) == before
    # and a folder deeper down, whose way leads through what stands there
    OBSTACLES[obstacle](tmp_path / "work", outside)
    (own_folder(tmp_path, "work", "in", "deeper") / "a").write_text("made")
    assert content(outside) == before


# what a kill between two steps of `side_folder` leaves, and what stands after the next start
LEFT = {
    "while writing the first result": ({".mat.partial": "half"}, None),
    "while writing another result": ({"mat": "old", ".mat.partial": "half"}, "old"),
    "before the first result took its place": ({".mat.partial": "whole"}, "whole"),
    "before another result took its place": ({"mat": "old", ".mat.partial": "whole"}, "whole"),
    "between the two": ({".mat.old": "old", ".mat.partial": "whole"}, "whole"),
    "before the old one was removed": ({"mat": "whole", ".mat.old": "old"}, "whole"),
    "while the old one was removed": ({"mat": "whole", ".mat.old": "half"}, "whole"),
    "in a case file": ({".case.json.new": "half"}, None),
}


@pytest.mark.parametrize("moment", LEFT)
def test_a_kill_at_any_step_loses_no_whole_result_and_leaves_nothing_half(moment: str, tmp_path: Path) -> None:
    found, stands = LEFT[moment]
    for name, state in found.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "a").write_text(state)
        if state != "half":
            (tmp_path / name / places.MANIFEST).write_text("{}")
    with locked(tmp_path):
        pass
    assert {path.name for path in tmp_path.iterdir()} == ({".lock", "mat"} if stands else {".lock"})
    if stands:
        assert (tmp_path / "mat" / "a").read_text() == stands


def test_a_result_of_before_stands_again_after_an_interruption_at_the_worst_moment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with side_folder(tmp_path / "mat") as side:
        (side / "a").write_text("first")
    rename = Path.rename

    def interrupted(path: Path, target: Path) -> Path:
        if path.name.endswith(".partial"):
            raise KeyboardInterrupt
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt), side_folder(tmp_path / "mat") as side:
        (side / "a").write_text("second")
    assert [path.name for path in tmp_path.iterdir()] == ["mat"]
    assert (tmp_path / "mat" / "a").read_text() == "first"


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    write_text(tmp_path / "case.json", "first")
    with pytest.raises(UnicodeEncodeError):
        write_text(tmp_path / "case.json", "second \udc80")
    assert [path.name for path in tmp_path.iterdir()] == ["case.json"]
    assert (tmp_path / "case.json").read_text() == "first"


def test_a_run_waits_for_what_a_killed_one_had_started(tmp_path: Path) -> None:
    # it holds the lock as long as its child, which does not listen, can write: two seconds
    script = (
        "import os, signal, sys; from pathlib import Path\n"
        "from pipeline import child_process; from pipeline.line.places import locked\n"
        "here = Path(sys.argv[1])\n"
        "with locked(here):\n"
        "    command = ['sh', '-c', 'trap \"\" TERM; touch ready; while :; do date >> written; sleep 0.01; done']\n"
        "    with child_process.started(command, here, here / 'log'):\n"
        "        while not (here / 'ready').exists(): pass\n"
        "        os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", script, tmp_path], check=False)
    assert done.returncode == -9
    with locked(tmp_path):
        size = (tmp_path / "written").stat().st_size
    assert (tmp_path / "written").stat().st_size == size


def test_a_folder_whose_name_is_no_text_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StageError, match="no text in UTF-8"), locked(tmp_path / "caf\udce9"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_is_not_there_or_was_removed_is_explained_and_other_missing_files_are_not(tmp_path: Path) -> None:
    dangling = tmp_path / "page.html"
    dangling.symlink_to(tmp_path / "nowhere" / "page.html")
    with pytest.raises(StageError, match=r"cannot write .*page\.html: no such file"), disk_trouble_explained(dangling):
        dangling.write_text("page")
    run = tmp_path / "run"

    def removed_meanwhile() -> None:
        with side_folder(run / "mat") as side:
            remove(run)
            (side / "mat.npz").write_text("a")

    with pytest.raises(StageError, match="no such file or directory"):
        removed_meanwhile()
    other = tmp_path / "something" / "else"
    with pytest.raises(FileNotFoundError), side_folder(run / "mat"):
        other.read_text()
