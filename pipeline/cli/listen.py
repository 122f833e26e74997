"""Show what a stage tells: a live line on a terminal, plain lines elsewhere."""

# SPDX-License-Identifier: GPL-3.0-or-later

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from pipeline.progress import Progress as Tell
from pipeline.progress import silent

_QUIET_GAP = 10.0  # seconds between two plain lines about the same thing, so that a log stays readable

_SHORT_GAP = 0.3  # seconds in which one line about a stage is enough


@contextmanager
def listening(console: Console, quiet: bool) -> Iterator[Tell]:
    """Give a listener for as long as the block runs."""
    if quiet:
        yield silent
    elif console.is_terminal:
        with Progress(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            TimeElapsedColumn(),
            console=console,
            transient=True,
        ) as live:
            task = live.add_task("starting", total=None)
            yield lambda what, done=None: live.update(task, description=what, total=1.0, completed=done or 0.0)
    else:
        yield _plain(console)


def _plain(console: Console) -> Tell:
    last: list[object] = ["", 0.0]

    def tell(what: str, done: float | None = None) -> None:
        now = time.monotonic()
        topic, gap = what.split(",")[0], now - float(str(last[1]))
        same_stage = topic.split(":")[0] == str(last[0]).split(":")[0]
        if (topic != last[0] and not (same_stage and gap < _SHORT_GAP)) or gap > _QUIET_GAP:
            last[:] = [topic, now]
            share = f" {done:.0%}" if done is not None else ""
            console.print(f"  {what}{share}", markup=False, highlight=False, soft_wrap=True)

    return tell
