"""Standard output and standard error as the commands need them: whoever reads them, in whatever encoding.

A reader that closes its end early, as ``fibertwin run CASE | head -1`` does, has read what it wanted: what is printed
after that goes nowhere, the command does what it was asked to do, and its exit code tells what became of it.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import codecs
import io
import os
import sys
from typing import Any, TextIO

from pipeline.errors import StageError

_READABLE = "fibertwin-readable"
_PLAIN = {
    "µ": "u", "μ": "u", "³": "3", "²": "2", "°": " deg", "·": "*", "×": "x", "…": "...", "–": "-", "—": "-", "−": "-",
    "→": "->", "≤": "<=", "≥": ">=", "±": "+-", "Δ": "d", "α": "alpha", "η": "eta", "λ": "lambda",
}  # fmt: skip


class _Outlet(io.RawIOBase):
    """A file descriptor that is written to for as long as anybody reads."""

    def __init__(self, descriptor: int, name: str) -> None:
        super().__init__()
        self._descriptor, self.name = descriptor, name

    def writable(self) -> bool:
        return True

    def fileno(self) -> int:
        return self._descriptor

    def isatty(self) -> bool:
        return os.isatty(self._descriptor)

    def write(self, data: Any) -> int:
        try:
            return os.write(self._descriptor, data)
        except BrokenPipeError:
            _point_nowhere(self._descriptor)
            return memoryview(data).nbytes
        except OSError as problem:
            # as on a full disk: it is told once, and the rest of the text must not raise it again at the end
            _point_nowhere(self._descriptor)
            raise StageError(f"cannot write to {self.name}: {(problem.strerror or str(problem)).lower()}") from problem


def steady() -> None:
    """Put outlets that survive their reader in the place of standard output and standard error."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            # closed by whoever started us: the next file that is opened would be taken for it
            _point_nowhere(descriptor)
    codecs.register_error(_READABLE, _readable)
    # a program that holds these already, as a test does, keeps its own
    if sys.stdout is sys.__stdout__:
        sys.stdout = _outlet(sys.stdout, 1, "standard output")
    if sys.stderr is sys.__stderr__:
        sys.stderr = _outlet(sys.stderr, 2, "standard error")


def _outlet(before: TextIO | None, descriptor: int, name: str) -> TextIO:
    if sys.platform == "win32" and before is not None:
        # its console takes no bytes
        return before
    return io.TextIOWrapper(
        io.BufferedWriter(_Outlet(descriptor, name)),
        encoding=before.encoding if before is not None else "utf-8",
        errors=_READABLE,
        line_buffering=descriptor == 2 or os.isatty(descriptor),
        write_through=getattr(before, "write_through", False),
    )


def _point_nowhere(descriptor: int) -> None:
    nowhere = os.open(os.devnull, os.O_RDWR)
    if nowhere != descriptor:
        os.dup2(nowhere, descriptor)
        os.close(nowhere)


def _readable(problem: UnicodeError) -> tuple[str, int]:
    """Give letters that the output's encoding has not in letters that each has."""
    if not isinstance(problem, UnicodeEncodeError):
        raise problem
    letters = problem.object[problem.start : problem.end]
    return "".join(_PLAIN.get(letter, "?") for letter in letters), problem.end
