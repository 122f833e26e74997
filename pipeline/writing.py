"""Files that a user named for a result: there whole, or as they were before.

What ends a command, a full disk too, may do so in the middle of a file, and what stood under its name would be lost.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import errno
import os
from collections.abc import Iterator
from pathlib import Path

_LONGEST = 40  # letters of its name that the file beside it keeps, since names have an end


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a file beside a place to write into, which takes the place at the end of the block.

    A link is followed, as whoever named it wants. What is no file, as ``/dev/stdout`` or a pipe, is written as it is.

    Parameters
    ----------
    path : Path
        The place, whose folder has to be there.

    Yields
    ------
    Path
        With the ending of the place's name.

    Raises
    ------
    OSError
        If it cannot be written; `filename` is the place.
    """
    if path.is_dir():
        raise OSError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    if path.exists() and not path.is_file():
        yield path
        return
    place = Path(os.path.realpath(path))
    if place.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), os.fspath(path))
    side = place.with_name(f".{place.stem[:_LONGEST]}.part{place.suffix}")
    try:
        # not every library tells that it cannot write
        side.write_bytes(b"")
        yield side
        side.replace(place)
    except BaseException as problem:
        with contextlib.suppress(OSError):
            side.unlink()
        if isinstance(problem, OSError) and problem.filename in (side, os.fspath(side)):
            problem.filename, problem.filename2 = os.fspath(path), None
        raise


def write_whole(path: Path, content: str | bytes) -> None:
    """Put a text, in UTF-8, or bytes into a place as `whole_file` does, and make its folder if it is not there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as side:
        side.write_bytes(content.encode() if isinstance(content, str) else content)
