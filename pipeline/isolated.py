"""Runs a reader of somebody else's library in a process of its own: a file that crashes it is one error here."""

# SPDX-License-Identifier: GPL-3.0-or-later

import multiprocessing
import os
import sys
import traceback
import warnings
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TypeVar

from pipeline.errors import FibertwinError
from pipeline.machine import address_space

_T = TypeVar("_T")
_SECONDS = 60.0
_PR_SET_PDEATHSIG = 1  # of prctl(2)
_BYTES_PER_SECOND = 1e6  # a slow disk, and base64 to be decoded


def isolated(read: Callable[[Path], _T], path: Path) -> _T:
    """Call a reader in a forked process that may take the machine's free memory, and time by the file's size.

    Where a system cannot fork, the reader is called here.

    Parameters
    ----------
    read : function of a path
        Its modules are imported already; what it gives can be pickled. It raises ValueError, or an error of ours, for
        a file that it does not take.
    path : Path

    Raises
    ------
    ValueError
        As the reader does, or if it crashed, or took too much time or memory.
    """
    if sys.platform != "linux":
        return read(path)
    seconds = _SECONDS + path.stat().st_size / _BYTES_PER_SECOND
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    child = context.Process(target=_answer, args=(read, path, theirs, seconds), daemon=True)
    with warnings.catch_warnings():
        # threads of numpy's that the child does not use
        warnings.simplefilter("ignore", DeprecationWarning)
        child.start()
    theirs.close()
    try:
        if not ours.poll(seconds):
            raise ValueError(f"it was not read within {seconds:.0f} s")
        found = ours.recv()
    except EOFError:
        child.join()
        raise ValueError(
            f"it crashed its reader (signal {-(child.exitcode or 0)}): it is damaged, or too large"
        ) from None
    finally:
        ours.close()
        child.kill()
        child.join()
    if isinstance(found, BaseException):
        raise found
    result: _T = found
    return result


def _answer(read: Callable[[Path], _T], path: Path, to: Connection, seconds: float) -> None:
    import ctypes
    import faulthandler
    import resource
    import signal

    # it ends with its parent, however that ends
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    # a crash is told by the parent, in a line
    faulthandler.disable()
    # what the library mutters about the file is not for the terminal
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 1))
    bound = address_space()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (bound if soft == resource.RLIM_INFINITY else min(bound, soft), hard))
    found: object
    try:
        found = read(path)
    except (FibertwinError, ValueError, ArithmeticError, LookupError, MemoryError) as problem:
        found = problem
    except BaseException as bug:  # it is raised again in the parent
        found = RuntimeError("".join(traceback.format_exception(bug)))
    to.send(found)
    to.close()
    # no exit handler of the parent's runs twice
    os._exit(0)
