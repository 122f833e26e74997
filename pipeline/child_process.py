"""Every program that this one starts: it ends with this process however that ends, and keeps within its limits.

Between the two stands `pipeline.guardian`, which outlives a kill by a moment. Windows has no such process: there a
program that this process started may outlive a kill of it.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import math
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import psutil

from pipeline import guardian, machine
from pipeline.errors import StageError

POLL = 0.2
"""Seconds between two looks at a program."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What a program, with all that it starts, may use: seconds, and bytes of memory."""

    seconds: float = math.inf
    memory: float = math.inf


@dataclass(frozen=True, slots=True)
class Used:
    """What a program used: seconds, and the most memory that it and all that it started held at a look [byte]."""

    seconds: float
    peak_memory: int


@dataclass(frozen=True, slots=True)
class Advice:
    """What a message about a limit says: the program's name, and what to do about more time and more memory."""

    name: str
    time: str
    memory: str


@contextlib.contextmanager
def started(
    command: Sequence[str | Path],
    folder: Path,
    log: Path,
    environment: Mapping[str, str] | None = None,
    scratch: Sequence[Path] = (),
) -> Iterator["subprocess.Popen[bytes]"]:
    """Run a program until it ends or the block does, whichever is first, with all that it starts.

    Parameters
    ----------
    command : sequence of str
        A program that is not there ends with `pipeline.guardian.NOT_STARTED` and says so in the log.
    folder : Path
        Where it works.
    log : Path
        What it says, on either of its outputs, is appended here.
    environment : mapping, optional
        That of this process unless given.
    scratch : sequence of Path
        Folders to remove should this process be killed meanwhile.

    Yields
    ------
    subprocess.Popen
        Ended by signal n, its return code is -n.
    """
    with log.open("ab") as file:
        if sys.platform == "win32":
            child, lifeline = _plain(command, folder, file.fileno(), environment), -1
        else:
            child, lifeline = _guarded(command, folder, file.fileno(), environment, scratch)
    try:
        yield child
    finally:
        try:
            end(child)
        finally:
            if lifeline >= 0:
                os.close(lifeline)


def _guarded(
    command: Sequence[str | Path],
    folder: Path,
    log: int,
    environment: Mapping[str, str] | None,
    scratch: Sequence[Path],
) -> tuple["subprocess.Popen[bytes]", int]:
    theirs, lifeline = os.pipe()
    # what would still write must keep the next run out of the folder
    held = [theirs, *machine.held_locks()]
    # -I -S: it starts in hundredths of a second, and imports nothing from where the program works
    before = [sys.executable, "-I", "-S", guardian.__file__, ",".join(map(str, held)), str(len(scratch))]
    try:
        child = subprocess.Popen(
            [*before, *scratch, *command],
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            # a session of its own: Ctrl-C is for this process, which then ends the program
            start_new_session=True,
            pass_fds=held,
        )
    except BaseException:
        os.close(lifeline)
        raise
    finally:
        os.close(theirs)
    return child, lifeline


def _plain(
    command: Sequence[str | Path], folder: Path, log: int, environment: Mapping[str, str] | None
) -> "subprocess.Popen[bytes]":
    return subprocess.Popen(
        [*command], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT
    )


def end(child: "subprocess.Popen[bytes]") -> None:
    """End a program of `started` with all that it started; by force where it does not end by itself."""
    if child.poll() is not None:
        return
    if sys.platform == "win32":
        for process in [*psutil.Process(child.pid).children(recursive=True), child]:
            process.kill()
    else:
        child.terminate()
    child.wait()


def watch(
    child: "subprocess.Popen[bytes]",
    look: Callable[[], str],
    limits: Limits | None = None,
    advice: Advice | None = None,
) -> Used:
    """Wait for a program to end, looking at it now and then, and not for longer than its limits.

    Parameters
    ----------
    child : subprocess.Popen
        Of `started`.
    look : callable
        Gives what the program is doing, for a message; called every `POLL` seconds and once after the end.
    limits : Limits, optional
        None unless given.
    advice : Advice
        Needed where there are limits.

    Raises
    ------
    StageError
        If a limit is exceeded.
    """
    limits = limits or Limits()
    advice = advice or Advice("the program", "", "")
    began, peak = time.monotonic(), 0
    while child.poll() is None:
        # ends at once when the program does
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.wait(POLL)
        peak = max(peak, _memory(child.pid))
        seconds = time.monotonic() - began
        if child.poll() is not None:
            break
        doing = look()
        if seconds > limits.seconds:
            raise StageError(f"{advice.name} was ended after {seconds:.0f} s, the limit, while {doing}; {advice.time}")
        if peak > limits.memory:
            raise StageError(
                f"{advice.name} was ended at {peak / 2**30:.1f} GiB of memory, over the limit of "
                f"{limits.memory / 2**30:.1f} GiB, while {doing}; {advice.memory}"
            )
    look()
    return Used(time.monotonic() - began, peak)


def _memory(pid: int) -> int:
    """Memory of a process and all that it started [byte]."""
    try:
        first = psutil.Process(pid)
        family = [first, *first.children(recursive=True)]
    except psutil.Error:
        return 0
    total = 0
    for process in family:
        with contextlib.suppress(psutil.Error):
            total += process.memory_info().rss
    return total
