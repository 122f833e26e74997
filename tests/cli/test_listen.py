# SPDX-License-Identifier: GPL-3.0-or-later

import io

import pytest
from rich.console import Console

from pipeline.cli import listen


def told(console: Console, quiet: bool = False) -> None:
    with listen.listening(console, quiet) as progress:
        # a solve of a minute that tells of itself ten times a second, and other stages after it
        for step in range(600):
            progress(f"solve: iteration {3 * step}, pressure drop 3.4 Pa", step / 600)
        for stage in ("capture", "report"):
            progress(f"{stage}: working")


def test_without_a_terminal_a_line_is_printed_every_few_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter(0.1 * k for k in range(10_000))
    monkeypatch.setattr("pipeline.cli.listen.time.monotonic", lambda: next(clock))
    written = io.StringIO()
    told(Console(file=written))
    lines = written.getvalue().splitlines()
    # 60 seconds and a line every 5
    assert 11 <= len(lines) <= 13
    assert lines[:2] == [
        "  solve: iteration 0, pressure drop 3.4 Pa 0%",
        "  solve: iteration 150, pressure drop 3.4 Pa 8%",
    ]


@pytest.mark.parametrize("terminal", [True, False])
def test_a_note_stays_to_be_read_between_lines_that_do_not(terminal: bool) -> None:
    written = io.StringIO()
    with listen.listening(Console(file=written, force_terminal=terminal, width=200), quiet=False) as progress:
        progress("tetmesh: preparing")
        progress("note: this takes about 12 minutes; raise tetmesh.edge")
        progress("tetmesh: meshing")
    # a live line is drawn over; what was printed stands on a line of its own
    assert "note: this takes about 12 minutes; raise tetmesh.edge\n" in written.getvalue()


def test_quiet_is_quiet() -> None:
    written = io.StringIO()
    told(Console(file=written), quiet=True)
    assert written.getvalue() == ""
