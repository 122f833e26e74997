"""Programs whose cost is measured: each in a process of its own, its start included."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import subprocess
import sys
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Spent:
    """What a program took.

    Parameters
    ----------
    seconds : float [s]
        Of processor time on all cores, its children included.
    memory : int [byte]
        Most that one of its processes held.
    """

    seconds: float
    memory: int


def spent(*arguments: str) -> Spent:
    """Run a module of Python as a program.

    Parameters
    ----------
    arguments : str
        The module and what it is told.

    Raises
    ------
    SystemExit
        If it fails.
    """
    child = subprocess.Popen([sys.executable, "-m", *arguments])
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(arguments)} ended with {os.waitstatus_to_exitcode(status)}")
    # Linux counts in KiB
    return Spent(usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)
