"""The states that a solver saves on its way: at fixed iterations, so that every run of a case can stop at the same one.

Whoever looks at a running solver sees the iteration at which it is by chance. A run is therefore judged, and kept, at
the iterations whose fields are saved, wherever it is by then.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
from pathlib import Path

from pipeline.line.places import remove, write_text

STEP = 20
"""Iterations between two saved states, about."""
KEPT = 10
"""States that stay: a solver that goes on while nobody looks must not purge the one that counts."""


def saving_step(iterations: int) -> int:
    """Choose the iterations between two saved states of a run of at most so many, if possible a part of them.

    Examples
    --------
    >>> [saving_step(most) for most in (7, 25, 2000, 1999)]
    [7, 25, 20, 20]
    """
    if iterations <= STEP:
        return iterations
    return next((step for step in range(STEP, 2 * STEP + 1) if iterations % step == 0), STEP)


def parts(work: Path) -> list[Path]:
    """Folders of a run that hold its states: its own, and those of its processes."""
    return [work, *sorted(work.glob("processor[0-9]*"))]


def saved(work: Path) -> list[int]:
    """Give the iterations after the start whose fields every part of a run has, in order."""
    each = [{found for path in part.iterdir() if (found := _iteration(path))} for part in parts(work)]
    # a run in parts has no fields of its own
    return sorted(set.intersection(*(each[1:] or each)))


def cut(work: Path, last: int) -> None:
    """Make a run as if it had ended after an iteration: drop every later state, and every later line of its tables."""
    for part in parts(work):
        for path in part.iterdir():
            if _iteration(path) > last:
                remove(path)
    for start in (work / "postProcessing").glob("*/*"):
        if _iteration(start) > last:
            remove(start)
            continue
        for table in start.glob("*.dat"):
            lines = table.read_text(encoding="ascii", errors="replace").splitlines(keepends=True)
            kept = [line for line in lines if line.startswith("#") or _of_line(line) <= last]
            if kept != lines:
                write_text(table, "".join(kept))


def _iteration(path: Path) -> int:
    return int(path.name) if path.name.isascii() and path.name.isdigit() else 0


def _of_line(line: str) -> float:
    # the last one may be half written
    with contextlib.suppress(ValueError, IndexError):
        return float(line.split()[0])
    return float("inf")
