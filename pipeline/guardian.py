"""The process between this program and each program it starts: it ends that program, and all that this one started.

`python guardian.py HELD COUNT FOLDER... COMMAND...` runs COMMAND and ends as it ends. HELD are open files, the first of
them a pipe that closes when the parent ends, however it ends: then, as after SIGTERM, everything that the command
started is ended too, and the COUNT folders that the dead parent can no longer remove are removed. The other open files
are the locks that the parent holds; they stay held until nothing is left that could write.

It is run by its path, without site packages, so that it stands within milliseconds: it imports nothing of ours.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import ctypes
import os
import select
import signal
import sys
import time
from types import FrameType

PATIENCE = 2.0
"""Seconds that a program has to end by itself after SIGTERM: mpirun needs some to remove its files of the session."""
NOT_STARTED = 127
"""Exit code where the command cannot be started, as shells have it."""

_LIMIT = 20.0  # seconds after which a process that even SIGKILL does not end, as one that waits for a disk, is left
_LOOK = 1.0  # seconds between two looks at who the parent is, should another process hold the pipe open
_LINUX = sys.platform.startswith("linux")
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36  # of prctl(2)


class Guardian:
    """Runs one command; `status` is the command's wait status once it has ended.

    Parameters
    ----------
    held : list of int
        Open files; the first is the pipe that closes with the parent.
    """

    def __init__(self, held: list[int]) -> None:
        self.status: int | None = None
        self._parent, self._lifeline = os.getppid(), held[0]
        self._child, self._asked_to_end = -1, False
        self._wake, wake = os.pipe()
        os.set_blocking(wake, False)
        # each signal that has a handler ends the wait below
        signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGCHLD):
            signal.signal(number, self._signaled)
        for file in held:
            os.set_inheritable(file, False)
        # a process whose parent ends, as an MPI rank's may, becomes a child of this process instead of the system's
        _prctl(_PR_SET_CHILD_SUBREAPER, 1)

    def run(self, command: list[str]) -> bool:
        """Run the command until it or the parent ends, or SIGTERM comes; tell whether the parent is gone."""
        self._child = _start(command)
        orphaned = False
        while self.status is None and not self._asked_to_end and not orphaned:
            readable, _, _ = select.select([self._lifeline, self._wake], [], [], _LOOK)
            if self._wake in readable:
                os.read(self._wake, 4096)
            orphaned = self._lifeline in readable or os.getppid() != self._parent
            self._collect()
        self._end_all()
        return orphaned

    def _signaled(self, number: int, frame: FrameType | None) -> None:
        self._asked_to_end |= number != signal.SIGCHLD

    def _collect(self) -> None:
        while True:
            try:
                process, status = os.waitpid(-1, os.WNOHANG)
            except ChildProcessError:
                return
            if process == 0:
                return
            if process == self._child:
                self.status = status

    def _end_all(self) -> None:
        began = time.monotonic()
        told: set[int] = set()
        while left := self._left():
            late = time.monotonic() - began
            if late > _LIMIT:
                return
            # by force again and again: what is being ended may still start something
            for process in left if late > PATIENCE else set(left) - told:
                _send(process, signal.SIGKILL if late > PATIENCE else signal.SIGTERM)
            told.update(left)
            time.sleep(0.01)
            self._collect()
        # one that has just ended is not left, and its processor time counts once it is collected
        self._collect()

    def _left(self) -> list[int]:
        """Give all that descends from this process and runs; elsewhere than on Linux, the command alone."""
        if not _LINUX:
            return [self._child] if self.status is None else []
        parents = {process: parent for process, parent, state in _processes() if state not in (b"Z", b"X")}
        found: list[int] = []
        generation = {os.getpid()}
        while generation:
            generation = {process for process, parent in parents.items() if parent in generation}
            found += generation
        return found


def _processes() -> list[tuple[int, int, bytes]]:
    """Every process of this system with its parent and its state."""
    found = []
    for entry in os.listdir("/proc"):  # noqa: PTH208 (pathlib takes longer to load than all of this)
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat", "rb") as file:  # noqa: PTH123
                    state, parent = file.read().rpartition(b")")[2].split()[:2]
            except OSError:
                continue
            found.append((int(entry), int(parent), state))
    return found


def _start(command: list[str]) -> int:
    guardian = os.getpid()
    process = os.fork()
    if process:
        return process
    try:
        # a group of its own, which is all that other systems than Linux let us end at once
        os.setpgid(0, 0)
        # should the guardian be killed; before the program's first instruction, since later may be too late
        _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() == guardian:
            # Python ignores these, which a program would inherit
            signal.signal(signal.SIGPIPE, signal.SIG_DFL)
            signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
            os.execvp(command[0], command)
    except OSError as problem:
        os.write(2, f"cannot start {command[0]}: {problem.strerror}\n".encode(errors="replace"))
    finally:
        os._exit(NOT_STARTED)


def _send(process: int, number: int) -> None:
    try:
        os.kill(process if _LINUX else -process, number)
    except ProcessLookupError:
        return


def _prctl(option: int, value: int) -> None:
    if _LINUX:
        ctypes.CDLL(None).prctl(option, value)


def _end_like(status: int) -> None:
    """End this process as another ended, by the same signal if it was one."""
    code = os.waitstatus_to_exitcode(status)
    if code >= 0:
        os._exit(code)
    import resource

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if -code != signal.SIGKILL:
        signal.signal(-code, signal.SIG_DFL)
    os.kill(os.getpid(), -code)
    # a signal that does not end a process by default
    os._exit(128 - code)


def main(arguments: list[str]) -> None:
    """Guard a command as the module's documentation says."""
    held, count = [int(number) for number in arguments[0].split(",")], int(arguments[1])
    folders, command = arguments[2 : 2 + count], arguments[2 + count :]
    guardian = Guardian(held)
    if guardian.run(command):
        import shutil

        for folder in folders:
            shutil.rmtree(folder, ignore_errors=True)
    _end_like(guardian.status if guardian.status is not None else signal.SIGKILL)


if __name__ == "__main__":
    main(sys.argv[1:])
