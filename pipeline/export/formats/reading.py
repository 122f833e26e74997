"""What the readers of text share: damage as one error, lines one after the other, rows of numbers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from pipeline.errors import StageError

_Number = TypeVar("_Number", int, float)


@contextlib.contextmanager
def damage_told(path: Path) -> Iterator[None]:
    """Turn what a reader of ours raises on a damaged file into one error that names the file.

    Raises
    ------
    StageError
    """
    try:
        yield
    except (ValueError, IndexError, KeyError, OverflowError) as problem:
        detail = f"no entry {problem}" if isinstance(problem, KeyError) else str(problem)
        raise StageError(f"cannot read {path}: {detail or 'it is damaged'}") from problem
    except OSError as problem:
        raise StageError(f"cannot read {path}: {(problem.strerror or str(problem)).lower()}") from problem


class Tokens(Iterator[list[str]]):
    """Lines as lists of words, one after the other; empty ones are left out."""

    def __init__(self, lines: list[list[str]]) -> None:
        self._lines = [line for line in lines if line]
        self._at = 0

    def __next__(self) -> list[str]:
        """Give the next line."""
        if self._at >= len(self._lines):
            raise StopIteration
        self._at += 1
        return self._lines[self._at - 1]

    def take(self, count: int, what: str) -> Iterator[list[str]]:
        """Give the next lines, so many.

        Raises
        ------
        ValueError
            If the file has fewer.
        """
        left = len(self._lines) - self._at
        if not 0 <= count <= left:
            raise ValueError(f"it says {count} {what} but ends after {left} lines")
        found = self._lines[self._at : self._at + count]
        self._at += count
        return iter(found)


def numbers_of(words: Sequence[str], kind: Callable[[str], _Number], count: int) -> list[_Number]:
    """Give so many numbers.

    Raises
    ------
    ValueError
        If there are fewer, or one is none.
    """
    if len(words) < count:
        raise ValueError(f"a row has {len(words)} of {count} numbers: {' '.join(words)[:60]!r}")
    return [kind(word) for word in words[:count]]
