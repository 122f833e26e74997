"""Run the case's own script as a child process within limits of time and memory, and tell how far it is."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
import subprocess
import time
from pathlib import Path

import psutil

from pipeline.errors import StageError
from pipeline.mesh.engines.limits import Limits
from pipeline.mesh.engines.snappy.scripts import MESH_SCRIPT
from pipeline.openfoam.environment import programs_missing
from pipeline.openfoam.process import running, tail
from pipeline.progress import Progress

PROGRAMS = ("blockMesh", "snappyHexMesh", "renumberMesh", "transformPoints", "checkMesh")
"""What the script runs on one core."""
PARALLEL = ("decomposePar", "mpirun", "reconstructParMesh")
"""What it runs besides on more than one."""

_POLL = 0.2  # seconds between two looks at the child
_TAIL = 8  # lines of a log that an error quotes
_LOG = "log.snappyHexMesh"
# what snappyHexMesh's log says as it goes on, what that means, and the share of the time that is over by then
_STEPS = (
    (rb"Surface refinement iteration", "halving cells at the fibers", 0.05),
    (rb"Shell refinement iteration", "halving cells around them", 0.25),
    (rb"Morphing phase", "moving the cells onto the fibers", 0.35),
    (rb"Morph iteration", "moving the cells onto the fibers", 0.45),
    (rb"Finished meshing|Mesh snapped in", "writing the mesh", 0.85),
)


def missing(cores: int) -> str | None:
    """Say which programs this engine lacks here, and what to do; None where all are there."""
    lacking = programs_missing([*PROGRAMS, *(PARALLEL if cores > 1 else ())])
    return f'tetmesh.engine = "snappy" cannot run: {lacking}' if lacking else None


def run_case(case: Path, cores: int, limits: Limits, tell: Progress) -> tuple[float, int]:
    """Mesh a case that `write_case` wrote.

    Parameters
    ----------
    case : Path
    cores : int
    limits : Limits
        On all processes together.
    tell : Progress

    Returns
    -------
    seconds : float [s]
    peak_memory : int [byte]
        Of all processes together.

    Raises
    ------
    StageError
        If a program is missing or fails, or a limit is exceeded.
    """
    lacking = missing(cores)
    if lacking:
        raise StageError(lacking)
    log = case / f"{MESH_SCRIPT}.log"
    log.unlink(missing_ok=True)
    began = time.monotonic()
    with running([f"./{MESH_SCRIPT}", str(cores)], case, log) as child:
        peak = _watch(child, case, limits, tell)
    seconds = time.monotonic() - began
    if child.returncode != 0:
        raise StageError(_failure(case, child.returncode, seconds))
    return seconds, peak


def _watch(child: "subprocess.Popen[bytes]", case: Path, limits: Limits, tell: Progress) -> int:
    began, peak = time.monotonic(), 0
    state, told = "cutting the duct into blocks", ""
    while child.poll() is None:
        time.sleep(_POLL)
        peak = max(peak, _memory(child.pid))
        seconds = time.monotonic() - began
        if seconds > limits.seconds:
            raise StageError(
                f"snappyHexMesh was ended after {seconds:.0f} s, the limit, while {state}; raise "
                "tetmesh.snappy.time_limit or tetmesh.snappy.cores, or make the mesh coarser: raise tetmesh.edge"
            )
        if peak > limits.memory:
            raise StageError(
                f"snappyHexMesh was ended at {peak / 2**30:.1f} GiB of memory, over the limit of "
                f"{limits.memory / 2**30:.1f} GiB, while {state}; raise tetmesh.memory_limit, "
                "or make the mesh coarser: raise tetmesh.edge"
            )
        state, share = _state(case)
        if state != told:
            tell(f"snappyHexMesh, {state}", share)
            told = state
    return peak


def _memory(pid: int) -> int:
    """Memory of a process and all that it started [byte]."""
    try:
        first = psutil.Process(pid)
        family = [first, *first.children(recursive=True)]
    except psutil.Error:
        return 0
    total = 0
    for process in family:
        try:
            total += process.memory_info().rss
        except psutil.Error:
            continue
    return total


def _state(case: Path) -> tuple[str, float]:
    if (case / "log.renumberMesh").exists():
        return "numbering the cells", 0.9
    try:
        content = (case / _LOG).read_bytes()
    except OSError:
        return "cutting the duct into blocks", 0.0
    state, share = "reading the surface", 0.02
    for pattern, meaning, done in _STEPS:
        if re.search(pattern, content):
            state, share = meaning, done
    return state, share


def _failure(case: Path, code: int, seconds: float) -> str:
    said = tail(case / f"{MESH_SCRIPT}.log", 1)
    program = said.split(" failed")[0] if " failed" in said else MESH_SCRIPT
    last = " | ".join(line.strip() for line in tail(case / f"log.{program}", _TAIL).splitlines() if line.strip())
    how = f"was killed by signal {-code}" if code < 0 else "failed"
    return (
        f"{program} {how} after {seconds:.0f} s; change tetmesh.edge a little (a tenth is enough), "
        f"or another mat.seed; its last lines: {last}"
    )
