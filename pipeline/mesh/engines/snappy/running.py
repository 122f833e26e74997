"""Run the case's own script as a child process within limits of time and memory, and tell how far it is."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from pathlib import Path

from pipeline import child_process
from pipeline.child_process import Advice, Limits, Used
from pipeline.errors import StageError
from pipeline.mesh.engines.snappy.scripts import MESH_SCRIPT
from pipeline.openfoam.environment import programs_missing
from pipeline.openfoam.process import started, tail
from pipeline.progress import Progress

PROGRAMS = ("blockMesh", "snappyHexMesh", "renumberMesh", "transformPoints", "checkMesh")
"""What the script runs on one core."""
PARALLEL = ("decomposePar", "mpirun", "reconstructParMesh")
"""What it runs besides on more than one."""

_TAIL = 8  # lines of a log that an error quotes
_LOG = "log.snappyHexMesh"
_ADVICE = Advice(
    "snappyHexMesh",
    "raise tetmesh.snappy.time_limit or tetmesh.snappy.cores, or make the mesh coarser: raise tetmesh.edge",
    "raise tetmesh.memory_limit, or make the mesh coarser: raise tetmesh.edge",
)
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


def run_case(case: Path, cores: int, limits: Limits, progress: Progress) -> Used:
    """Mesh a case that `write_case` wrote.

    Parameters
    ----------
    case : Path
    cores : int
    limits : Limits
        On all processes together.
    progress : Progress

    Returns
    -------
    Used

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
    with started([f"./{MESH_SCRIPT}", str(cores)], case, log) as child:
        used = child_process.watch(child, _Look(case, progress), limits, _ADVICE)
    if child.returncode != 0:
        raise StageError(_failure(case, child.returncode, used.seconds))
    return used


class _Look:
    """Reads in the logs what is being done, and tells it where it is something else than before."""

    def __init__(self, case: Path, progress: Progress) -> None:
        self._case, self._progress, self._told = case, progress, ""

    def __call__(self) -> str:
        doing, share = _state(self._case)
        if doing != self._told:
            self._progress(f"snappyHexMesh, {doing}", share)
            self._told = doing
        return doing


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
