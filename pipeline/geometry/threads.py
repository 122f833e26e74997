"""Work on the rows of long arrays by all cores: compiled loops that let other threads run, each on rows of its own."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from pipeline.machine import cores

_LEAST = 20_000
"""Rows that are worth a thread."""
_PARTS = 4
"""Parts for each core: one that takes longer than the others does not leave them idle."""


def in_parts(work: Callable[[int, int], object], count: int, least: int | None = None) -> None:
    """Do the work on all rows, some at a time.

    Parameters
    ----------
    work : callable
        Takes the first row and the one after the last; writes to these rows alone, so that nothing depends on how many
        threads there are.
    count : int
        Number of rows.
    least : int, optional
        Rows that are worth a thread, where they are more or less work than usual.
    """
    threads, least = cores(), least or _LEAST
    if threads == 1 or count < 2 * least:
        work(0, count)
        return
    parts = min(_PARTS * threads, count // least)
    ends = [count * part // parts for part in range(parts + 1)]
    with ThreadPoolExecutor(max_workers=threads) as pool:
        list(pool.map(work, ends[:-1], ends[1:]))
