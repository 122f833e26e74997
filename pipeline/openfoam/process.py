"""Programs of OpenFOAM as child processes: they end when this process ends, and their logs tell what went wrong."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

from pipeline import child_process
from pipeline.errors import StageError
from pipeline.openfoam.environment import environment
from pipeline.scratch import scratch_folder

# OpenFOAM drops blanks and quotes from a path, expands others, and then finds no case there
_PLAIN_PATH = re.compile(r"[A-Za-z0-9_./+-]+")


@contextlib.contextmanager
def started(command: list[str], case: Path, log: Path) -> Iterator["subprocess.Popen[bytes]"]:
    """Run a program of OpenFOAM in a case's folder, as `pipeline.child_process.started` does.

    Parameters
    ----------
    command : list of str
    case : Path
        Any path: one that OpenFOAM cannot take is given to it through a link.
    log : Path
        What the program says is appended here.
    """
    case = case.absolute()
    with contextlib.ExitStack() as stack:
        scratch = []
        if not _PLAIN_PATH.fullmatch(str(case)):
            scratch.append(stack.enter_context(scratch_folder("solver")))
            link = scratch[0] / "case"
            if not _PLAIN_PATH.fullmatch(str(link)):
                raise StageError(
                    f"OpenFOAM takes no path with blanks, quotes and the like, neither {case} nor the temporary folder "
                    f"{scratch[0].parent}; choose another folder with --out, or set TMPDIR"
                )
            link.symlink_to(case, target_is_directory=True)
            case = link
        if command[0] == "mpirun":
            # which tells its ranks where the link leads to, and not of the link
            after = command.index("-np") + 2
            command = [*command[:after], "env", f"PWD={case}", *command[after:]]
        yield stack.enter_context(child_process.started(command, case, log, environment(case), scratch))


def call(command: list[str], case: Path) -> None:
    """Run a program in a case's folder to its end, with its log beside the case's folders.

    Raises
    ------
    StageError
        If it fails, with the end of its log.
    """
    log = case / f"log.{command[0]}"
    log.unlink(missing_ok=True)
    with started(command, case, log) as child:
        code = child.wait()
    if code:
        raise StageError(f"{command[0]} failed (exit code {code}):\n{tail(log)}")


def tail(log: Path, lines: int = 20, size: int = 20_000) -> str:
    """Give the last lines of a log, for an error message."""
    if not log.exists():
        return "(no log)"
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - size))
        text = file.read().decode("utf-8", errors="replace")
    return "\n".join(text.strip().split("\n")[-lines:])
