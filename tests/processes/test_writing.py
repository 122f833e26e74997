"""A file that a user named is there whole, or as it was: whatever ends its writing."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import stat
import sys
from pathlib import Path

import pytest

from pipeline.errors import StageError
from pipeline.line.places import disk_trouble_explained
from pipeline.writing import whole_file, write_whole


@pytest.mark.parametrize("before", [None, "last week's page"])
@pytest.mark.parametrize("ending", [KeyboardInterrupt, ValueError, OSError(28, "No space left on device")])
def test_what_ends_a_write_leaves_the_place_as_it_was(
    before: str | None, ending: BaseException | type[BaseException], tmp_path: Path
) -> None:
    place = tmp_path / "page.html"
    if before is not None:
        place.write_text(before)

    def write() -> None:
        with whole_file(place) as side:
            assert side.suffix == ".html"
            side.write_text("half a page")
            raise ending

    with pytest.raises(type(ending) if isinstance(ending, BaseException) else ending):
        write()
    assert [path.name for path in tmp_path.iterdir()] == ([] if before is None else ["page.html"])
    assert before is None or place.read_text() == before


def test_a_whole_file_takes_the_place_and_nothing_stays_beside_it(tmp_path: Path) -> None:
    place = tmp_path / "made" / ("a long name " * 15 + ".toml")
    for content in ("first", "second", b"third"):
        write_whole(place, content)
        assert place.read_bytes() == (content if isinstance(content, bytes) else content.encode())
    assert list(place.parent.iterdir()) == [place]
    # whoever may read files of this user may read this one
    (tmp_path / "usual").write_text("")
    assert stat.S_IMODE(place.stat().st_mode) == stat.S_IMODE((tmp_path / "usual").stat().st_mode)


@pytest.mark.skipif(sys.platform == "win32", reason="links and pipes")
def test_a_link_is_followed_and_a_pipe_is_written_into(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "page.html").symlink_to("deep/page.html")
    write_whole(tmp_path / "page.html", "a page")
    assert (tmp_path / "page.html").is_symlink()
    assert (tmp_path / "deep/page.html").read_text() == "a page"
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    write_whole(tmp_path / "pipe", "a page")
    assert os.read(reader, 100) == b"a page"
    os.close(reader)
    # as /dev/stdout is, where the next program of a shell's pipe reads it: a link whose end has no name
    reader, writer = os.pipe()
    write_whole(Path(f"/dev/fd/{writer}"), "a page")
    assert os.read(reader, 100) == b"a page"
    os.close(reader)
    os.close(writer)


@pytest.mark.skipif(sys.platform == "win32", reason="links")
@pytest.mark.parametrize("what", ["folder", "link to itself", "link to nowhere"])
def test_a_place_that_takes_no_file_is_one_error_with_its_name(what: str, tmp_path: Path) -> None:
    place = tmp_path / "page.html"
    match what:
        case "folder":
            place.mkdir()
        case "link to itself":
            place.symlink_to(place)
        case _:
            place.symlink_to(tmp_path / "gone" / "page.html")
    with pytest.raises(StageError, match=r"cannot write .*/page\.html: "), disk_trouble_explained(place):
        write_whole(place, "a page")
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
