"""What systems do differently: locks, the memory of a process and a bound on it, ending a group of processes.

Linux is what is tested. Elsewhere a function does what that system offers, and says what it does not.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from typing import IO, Any

import psutil

_PR_SET_PDEATHSIG = 1  # of prctl(2)


def lock(file: IO[Any]) -> None:
    """Hold an open file for this process alone, until it is closed or the process ends, however it ends.

    Raises
    ------
    BlockingIOError
        If another process holds it.
    """
    if sys.platform == "win32":
        import msvcrt

        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError as problem:
            raise BlockingIOError(*problem.args) from problem
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def peak_memory() -> int:
    """Most memory that this process has held so far [byte]."""
    if sys.platform == "win32":
        return int(psutil.Process().memory_info().peak_wset)
    import resource

    # Linux counts in KiB, macOS in bytes
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


@contextlib.contextmanager
def memory_bounded() -> Iterator[None]:
    """End what would take more than the machine's free memory with a MemoryError.

    Windows has no such bound, and macOS need not keep to it.
    """
    if sys.platform == "win32":
        yield
        return
    import resource

    _, hard = before = resource.getrlimit(resource.RLIMIT_AS)
    bound = psutil.Process().memory_info().vms + psutil.virtual_memory().available
    if before[0] != resource.RLIM_INFINITY:
        bound = min(bound, before[0])
    resource.setrlimit(resource.RLIMIT_AS, (bound, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def apart() -> dict[str, Any]:
    """Options of `subprocess.Popen` for a program in a group of its own that `end_group` ends.

    On Linux it also ends when this process is killed; elsewhere it may outlive that.
    """
    if sys.platform == "win32":
        return {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
    return {"start_new_session": True, **({"preexec_fn": _end_with_parent} if sys.platform == "linux" else {})}


def _end_with_parent() -> None:
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)


def end_group(program: "subprocess.Popen[bytes]", patience: float) -> None:
    """End a program that was started `apart`, with all that it started; by force after `patience` [s]."""
    if program.poll() is not None:
        return
    _signal_group(program, "SIGTERM")
    try:
        program.wait(patience)
    except subprocess.TimeoutExpired:
        _signal_group(program, "SIGKILL")
        program.wait()


def _signal_group(program: "subprocess.Popen[bytes]", name: str) -> None:
    with contextlib.suppress(ProcessLookupError):
        if sys.platform == "win32":
            for child in psutil.Process(program.pid).children(recursive=True):
                child.kill()
            program.kill()
        else:
            os.killpg(program.pid, getattr(signal, name))
