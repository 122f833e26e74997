"""Run the mesher as a child process within limits of time and memory, and tell how far it is."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pipeline import child_process
from pipeline.child_process import Advice, Limits
from pipeline.errors import StageError
from pipeline.mesh.engines.ftetwild import worker
from pipeline.nouns.arrays import Floats, Ints
from pipeline.progress import Progress
from pipeline.scratch import scratch_folder

# What fTetWild's log says at the start of each pass, and at the end of each round that refines by the size field.
_ROUND = re.compile(rb"/ pass (\d+) /|^/{9}(\d+) ", re.MULTILINE)
_TAIL = 5  # lines of the child's log that an error quotes


_ADVICE = Advice(
    "fTetWild",
    "raise tetmesh.tetwild.time_limit, or make the mesh coarser: raise tetmesh.edge or lower tetmesh.tetwild.passes",
    "raise tetmesh.memory_limit, or make the mesh coarser: raise tetmesh.edge",
)


@dataclass(frozen=True, slots=True)
class Meshed:
    """What the child gave: points (n, 3), tets (m, 4), and what it used."""

    points: Floats
    tets: Ints
    seconds: float
    peak_memory: int


def run_mesher(
    points: Floats,
    triangles: Ints,
    options: dict[str, Any],
    background: dict[str, Any],
    limits: Limits,
    progress: Progress,
) -> Meshed:
    """Call ``pytetwild.tetrahedralize`` in a child process.

    Parameters
    ----------
    points : (n, 3) array
        Of a closed surface of order one in size.
    triangles : (m, 3) int array
    options : dict
        Plain arguments of the call; `num_opt_iter` scales the progress.
    background : dict
        Its `bg_...` arrays, or empty.
    limits : Limits
    progress : Progress

    Raises
    ------
    StageError
        If the child crashes, exceeds a limit, or gives no tetrahedron.
    """
    with scratch_folder("mesh") as folder:
        np.savez(
            folder / worker.INPUT,
            points=points,
            triangles=triangles.astype(np.int32),
            options=np.array(json.dumps(options)),
            **background,
        )
        # -P: the working folder must not become a place to import from
        command = [sys.executable, "-P", "-m", worker.__name__, str(folder)]
        log = folder / "log"
        with child_process.started(command, folder, log, scratch=[folder]) as child:
            look = _Look(log, int(options["num_opt_iter"]), progress)
            used = child_process.watch(child, look, limits, _ADVICE)
        if child.returncode != 0 or not (folder / worker.OUTPUT).exists():
            raise StageError(_crash(child.returncode, log, used.seconds))
        with np.load(folder / worker.OUTPUT, allow_pickle=False) as result:
            mesh_points, tets = result["points"].astype(np.float64), result["tets"].astype(np.int64)
    if len(tets) == 0:
        raise StageError(
            f"fTetWild gave no tetrahedron from {len(triangles)} triangles; lower tetmesh.tetwild.envelope"
        )
    return Meshed(mesh_points, tets, used.seconds, used.peak_memory)


class _Look:
    """Reads in the mesher's log what it is doing, and tells it."""

    def __init__(self, log: Path, passes: int, progress: Progress) -> None:
        self._log, self._passes, self._progress = log, passes, progress
        self._read, self._doing, self._share = 0, "inserting the surface", 0.0

    def __call__(self) -> str:
        with self._log.open("rb") as file:
            file.seek(self._read)
            news = file.read()
        self._read += len(news)
        found = _ROUND.findall(news)
        if found:
            before, after = found[-1]
            self._doing = (
                f"in pass {int(before) + 1} of {self._passes}" if before else f"refining, round {int(after) + 2}"
            )
            # the passes take about a third of the time, the insertion before them and the refining after them the rest
            self._share = 0.2 + (0.3 * int(before) / self._passes if before else 0.3 + min(0.4, 0.2 * int(after)))
        if news:
            self._progress(f"fTetWild, {self._doing}", self._share)
        return self._doing


def _crash(code: int, log: Path, seconds: float) -> str:
    lines = log.read_text(errors="replace").strip().splitlines()
    last = " | ".join(line.strip() for line in lines[-_TAIL:]) or "nothing"
    how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
    advice = "the system ends processes when memory runs out; " if code == -9 else ""
    return (
        f"fTetWild {how} after {seconds:.0f} s; {advice}change tetmesh.tetwild.envelope or tetmesh.edge a little "
        f"(a tenth is enough), or another mat.seed; its last lines: {last}"
    )
