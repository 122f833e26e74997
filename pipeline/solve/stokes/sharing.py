"""Loops over the rows of a matrix, shared by all cores; what they find does not depend on how many there are."""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import numpy as np

from pipeline.nouns.arrays import Floats

SHARES = 8
"""Parts that rows are cut into, on any number of cores."""
_MANY = 20_000  # rows from which it pays to wake threads

Loop = Callable[..., None]
"""Compiled for threads; takes the first row and the one behind the last, then its arrays."""


class Team:
    """Threads that share loops over rows.

    Parameters
    ----------
    pool : ThreadPoolExecutor or None
        None where one core does all.
    """

    def __init__(self, pool: ThreadPoolExecutor | None = None) -> None:
        self.pool = pool

    def over(self, first: int, end: int, loop: Loop, *arguments: Any) -> None:
        """Run a loop over the rows from `first` to before `end`, part by part."""
        self._each([(loop, *part, *arguments) for part in _parts(first, end)], end - first)

    def sums(self, end: int, loop: Loop, count: int, *arguments: Any) -> Floats:
        """Run a loop over the rows up to `end` that adds up `count` sums, its last argument: those of all rows."""
        found = np.zeros((SHARES, count))
        self._each([(loop, *part, *arguments, found[k]) for k, part in enumerate(_parts(0, end))], end)
        total: Floats = found.sum(axis=0)
        return total

    def _each(self, calls: list[tuple[Any, ...]], rows: int) -> None:
        if self.pool is None or rows < _MANY:
            for loop, *arguments in calls:
                loop(*arguments)
            return
        for done in [self.pool.submit(*call) for call in calls]:
            done.result()


def _parts(first: int, end: int) -> list[tuple[int, int]]:
    cuts = [first + (end - first) * k // SHARES for k in range(SHARES + 1)]
    return list(itertools.pairwise(cuts))


@contextmanager
def team(cores: int) -> Iterator[Team]:
    """Keep as many threads as cores while the block lasts."""
    if cores == 1:
        yield Team()
        return
    with ThreadPoolExecutor(max_workers=cores) as pool:
        yield Team(pool)
