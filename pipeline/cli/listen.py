"""Show what a stage tells: a live line on a terminal, plain lines elsewhere."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from pipeline.progress import NOTE, silent
from pipeline.progress import Progress as Tell

_GAP = 5.0  # seconds between two plain lines, so that a log stays readable


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

            def progress(what: str, done: float | None = None) -> None:
                if what.startswith(NOTE):
                    live.console.print(what, markup=False, highlight=False, soft_wrap=True)
                else:
                    live.update(task, description=what, total=1.0, completed=done or 0.0)

            yield progress
    else:
        yield _plain(console)


def _plain(console: Console) -> Tell:
    last = -math.inf

    def progress(what: str, done: float | None = None) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= _GAP or what.startswith(NOTE):
            last = now
            share = f" {done:.0%}" if done is not None else ""
            console.print(f"  {what}{share}", markup=False, highlight=False, soft_wrap=True)

    return progress
