"""Files that somebody else may have put there: opened only if they are files, and never read for longer than they are.

A pipe or a device in the place of a file would keep a reader waiting, or fed, for good.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import errno
import io
import os
import stat
from pathlib import Path

_WORDS = {stat.S_IFIFO: "a pipe", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device", stat.S_IFSOCK: "a socket"}
_LINK = "a link"


def is_text(name: str) -> bool:
    """Whether a name is text in UTF-8, as any sequence of bytes may name a file but not everything can say it."""
    return not any("\ud800" <= letter <= "\udfff" for letter in name)


def open_file(path: Path, links: bool = True) -> io.BufferedReader:
    """Open a file for reading.

    Parameters
    ----------
    path : Path
    links : bool
        Whether a link in its place is followed.

    Raises
    ------
    OSError
        If it cannot be opened, or is a pipe, a device, a folder or such; `strerror` says which, for a message.
    """
    # without waiting: opening a pipe would wait until somebody writes into it
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | (0 if links else getattr(os, "O_NOFOLLOW", 0))
    try:
        file = open(os.open(path, flags | getattr(os, "O_BINARY", 0)), "rb")  # noqa: PTH123, SIM115
    except OSError as problem:
        if problem.errno == errno.ELOOP:
            raise _not_a_file(path, _LINK) from None
        if problem.errno == errno.ENOENT and path.is_symlink():
            raise OSError(errno.ENOENT, f"it is a link to {os.readlink(path)!r}, which is not there", path) from None  # noqa: PTH115
        raise
    except ValueError as problem:
        # a name with a zero byte
        raise OSError(errno.EINVAL, str(problem), repr(path)) from None
    kind = stat.S_IFMT(os.fstat(file.fileno()).st_mode)
    if kind != stat.S_IFREG:
        file.close()
        raise _not_a_file(path, _WORDS.get(kind, "no file"))
    return file


def _not_a_file(path: Path, what: str) -> OSError:
    return OSError(errno.EINVAL, f"it is {what}, not a file", path)


def read_bytes(path: Path, largest: int, links: bool = True) -> bytes:
    """Read a file that is not larger than it should be.

    Parameters
    ----------
    path : Path
    largest : int [byte]
    links : bool
        Whether a link in its place is followed.

    Raises
    ------
    OSError
        As `open_file`, or if there is more in it.
    """
    with open_file(path, links) as file:
        # not the file's own word for its size: some of the system's files say 0
        content = file.read(largest + 1)
    if len(content) > largest:
        raise OSError(errno.EFBIG, f"it has more than {largest:,} bytes", path)
    return content
