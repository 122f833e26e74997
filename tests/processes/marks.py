"""Finds what a command left: every process that inherited its mark, and every folder in its own temporary place."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import os
import time
import uuid
from dataclasses import dataclass, field
from pathlib import Path

import psutil

MARK = "FIBERTWIN_TEST_MARK"


@dataclass(frozen=True)
class Marked:
    """An environment that every descendant inherits, with a temporary folder of its own.

    Parameters
    ----------
    temporary : Path
        Made if it is not there.
    """

    temporary: Path
    mark: str = field(default_factory=lambda: uuid.uuid4().hex)

    def __post_init__(self) -> None:
        self.temporary.mkdir(parents=True, exist_ok=True)

    @property
    def environment(self) -> dict[str, str]:
        return {**os.environ, MARK: self.mark, "TMPDIR": str(self.temporary)}

    def processes(self) -> list[psutil.Process]:
        found = []
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error):
                if process.environ().get(MARK) == self.mark and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(process)
        return found

    def left(self, patience: float = 10.0) -> list[str]:
        """What still runs or lies there after some time to end in [s]."""
        deadline = time.monotonic() + patience
        while True:
            processes = self.processes()
            folders = [path.name for path in self.temporary.iterdir() if path.name.startswith("fibertwin-")]
            if not processes and not folders:
                return []
            if time.monotonic() > deadline:
                names = []
                for process in processes:
                    with contextlib.suppress(psutil.Error):
                        names.append(f"{process.pid} {' '.join(process.cmdline())}")
                    with contextlib.suppress(psutil.Error):
                        process.kill()
                return names + folders
            time.sleep(0.02)
