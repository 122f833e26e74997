"""Programs of OpenFOAM as child processes: they end when this process ends, and their logs tell what went wrong."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import subprocess
from collections.abc import Iterator
from pathlib import Path

from pipeline import machine
from pipeline.errors import StageError
from pipeline.openfoam.environment import environment

_PATIENCE = 10.0  # seconds that a program has to end by itself


@contextlib.contextmanager
def running(command: list[str], case: Path, log: Path) -> Iterator["subprocess.Popen[bytes]"]:
    """Run a program in a case's folder, in a process group of its own, which ends with the block whatever happens.

    Parameters
    ----------
    command : list of str
    case : Path
    log : Path
        What the program says is appended here.

    Yields
    ------
    subprocess.Popen
    """
    with log.open("ab") as file:
        child = subprocess.Popen(
            command,
            cwd=case,
            env=environment(case),
            stdout=file,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            # or a killed run's program would go on writing into the next run's folder
            **machine.apart(),
        )
    try:
        yield child
    finally:
        machine.end_group(child, _PATIENCE)


def call(command: list[str], case: Path) -> None:
    """Run a program in a case's folder to its end, with its log beside the case's folders.

    Raises
    ------
    StageError
        If it fails, with the end of its log.
    """
    log = case / f"log.{command[0]}"
    with log.open("wb") as file:
        done = subprocess.run(
            command, cwd=case, env=environment(case), stdout=file, stderr=subprocess.STDOUT, check=False
        )
    if done.returncode:
        raise StageError(f"{command[0]} failed (exit code {done.returncode}):\n{tail(log)}")


def tail(log: Path, lines: int = 20, size: int = 20_000) -> str:
    """Give the last lines of a log, for an error message."""
    if not log.exists():
        return "(no log)"
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - size))
        text = file.read().decode("utf-8", errors="replace")
    return "\n".join(text.strip().split("\n")[-lines:])
