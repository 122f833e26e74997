"""Pictures of a run, drawn by a child process: where no OpenGL is to be had, VTK ends the process that asks it.

A machine without a screen is told to VTK before it looks for one, or it would complain of "bad X server connection".
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import TracebackType
from typing import Self

from pipeline import child_process
from pipeline.report.views import painter
from pipeline.report.views.mesh_scenes import MeshSubject
from pipeline.report.views.scenes import Subject
from pipeline.scratch import scratch_folder

_TIME_LIMIT = 600.0  # seconds; pictures of a million cells take one minute on one slow core


@dataclass(frozen=True, slots=True)
class Pictures:
    """Pictures by the name of their scene, as bytes of a file, and why there are none if so."""

    files: Mapping[str, bytes] = field(default_factory=dict)
    trouble: str = ""


def screenless() -> bool:
    """Whether this machine has no screen that a window could open on."""
    return sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def rendering_environment() -> dict[str, str]:
    """Environment in which VTK renders without a screen; what the user chose for himself stands."""
    choice = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"} if screenless() else {}
    return {**choice, **os.environ}


class Painting:
    """Pictures in the making: they are drawn while the caller does something else.

    Parameters
    ----------
    subject : Subject or MeshSubject
    scenes : iterable of str
        As `pipeline.report.views.painter.possible` gives them.
    kind : str
        ``"jpg"`` or ``"png"``.
    """

    def __init__(self, subject: Subject | MeshSubject, scenes: Iterable[str], kind: str = "jpg") -> None:
        self._names = tuple(scenes)
        self._kind = kind
        with contextlib.ExitStack() as open_now:
            self._folder = open_now.enter_context(scratch_folder("pictures"))
            order = {
                "scenes": self._names,
                "kind": kind,
                "kind of subject": painter.write_subject(subject, self._folder),
            }
            (self._folder / painter.ORDER).write_text(json.dumps(order))
            # -P: the working folder must not become a place to import from
            command = [sys.executable, "-P", "-m", painter.__name__, str(self._folder)]
            self._child = open_now.enter_context(
                child_process.started(
                    command, self._folder, self._folder / "log", rendering_environment(), [self._folder]
                )
            )
            self._open = open_now.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._open.__exit__(kind, error, trace)

    def finished(self) -> Pictures:
        """Wait for the pictures."""
        folder = self._folder
        try:
            code = self._child.wait(_TIME_LIMIT)
        except subprocess.TimeoutExpired:
            return Pictures(trouble=f"they were not drawn within {_TIME_LIMIT:.0f} s")
        # VTK colors what it says
        log = re.sub(r"\x1b\[[0-9;]*m", "", (folder / "log").read_text(errors="replace")).strip()
        if code:
            how = f"was ended by signal {-code}" if code < 0 else f"ended with exit code {code}"
            last = log.splitlines()[-1] if log else "it said nothing"
            return Pictures(trouble=f"the process that draws them {how}: {last}")
        return Pictures({name: (folder / f"{name}.{self._kind}").read_bytes() for name in self._names})
