"""What systems do differently: locks, the memory of a process and a bound on it.

Linux is what is tested. Elsewhere a function does what that system offers, and says what it does not.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import os
import sys
import weakref
from collections.abc import Iterator
from typing import IO, Any

MEMORY_SHARE = 0.85
"""Of the memory that is free, what may be used where a case names no limit."""
_LOCKED: "weakref.WeakSet[IO[Any]]" = weakref.WeakSet()


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
    _LOCKED.add(file)


def held_locks() -> list[int]:
    """Descriptors of the files that this process holds: where another process has one too, it holds as long as both."""
    return [file.fileno() for file in _LOCKED if not file.closed]


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def free_memory() -> int:
    """Memory of this machine that a process may still take [byte]."""
    # psutil takes a third as long to load as numpy, which no command that asks nothing of the kind should wait for
    import psutil

    return int(psutil.virtual_memory().available)


def memory_allowed(limit: float | None) -> float:
    """Give the limit of a case [byte], or most of the free memory where it names none."""
    return limit or MEMORY_SHARE * free_memory()


def address_space() -> int:
    """Bytes that this process takes, and those free besides: more cannot be had."""
    import psutil

    return int(psutil.Process().memory_info().vms) + free_memory()


def peak_memory() -> int:
    """Most memory that this process has held so far [byte]."""
    if sys.platform == "win32":
        import psutil

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
    bound = address_space()
    if before[0] != resource.RLIM_INFINITY:
        bound = min(bound, before[0])
    resource.setrlimit(resource.RLIMIT_AS, (bound, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
