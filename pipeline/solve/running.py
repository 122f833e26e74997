"""One run of OpenFOAM: started or continued, watched, stopped when the pressure drop has settled, read back."""

# SPDX-License-Identifier: GPL-3.0-or-later

import hashlib
import math
import re
import shutil
import time
from pathlib import Path

import numpy as np

from pipeline import child_process
from pipeline.errors import StageError
from pipeline.nouns.arrays import Floats
from pipeline.nouns.flow import Flow, Solution
from pipeline.openfoam.environment import openfoam_missing
from pipeline.openfoam.process import call, started, tail
from pipeline.progress import Progress, silent
from pipeline.solve import read_back
from pipeline.solve.bed import Bed
from pipeline.solve.settings import OpenFoamSettings
from pipeline.solve.settled import change

MASS_ERROR = 1e-5
"""A pressure drop counts as settled only where as much air leaves as enters, to this share."""
LOST_MASS = 0.5
"""A run diverges where this share of the air is lost or found between inlet and outlet."""
_SAVES = 100  # iterations between two states that a killed run continues from
_KEY, _SECONDS, _STOP = "fibertwin.key", "fibertwin.seconds", "stop"


def solve(
    case: Path,
    work: Path,
    flow: Flow,
    bed: Bed,
    settings: OpenFoamSettings | None = None,
    progress: Progress = silent,
) -> Solution:
    """Run a case that `pipeline.export` wrote until its pressure drop has settled.

    Parameters
    ----------
    case : Path
        The written OpenFOAM case; left as it is.
    work : Path
        Where the run is kept. If a run of the same case was killed there, it is continued.
    flow : Flow
        As the case was written with.
    bed : Bed
    settings : OpenFoamSettings
    progress : Progress
        Told the iteration, the pressure drop and the residuals.

    Returns
    -------
    Solution
        `converged` is False where the iterations or the time ran out before the pressure drop had settled.

    Raises
    ------
    StageError
        If OpenFOAM is missing, cannot start, or the run diverges; with the end of its log.
    """
    settings = settings or OpenFoamSettings()
    program = _application(case)
    missing = openfoam_missing(settings.cores, program)
    if missing:
        raise StageError(missing)
    began = time.monotonic()
    progress("solve: preparing the case")
    _prepare(case, work, settings)
    before = float((work / _SECONDS).read_text()) if (work / _SECONDS).exists() else 0.0
    command = [program]
    if settings.cores > 1:
        command = ["mpirun", "-np", str(settings.cores), program, "-parallel"]
    try:
        settled = _run(command, work, flow, settings, progress)
    finally:
        seconds = before + time.monotonic() - began
        (work / _SECONDS).write_text(f"{seconds:.3f}")
    return _solution(work, flow, bed, settled, seconds, settings.cores)


def _prepare(case: Path, work: Path, settings: OpenFoamSettings) -> None:
    """Make `work` a copy of the case, split for the cores, unless a run of just this case was killed there."""
    key = _digest(case, settings.cores)
    key_file = work / _KEY
    if not key_file.exists() or key_file.read_text() != key:
        shutil.rmtree(work, ignore_errors=True)
        shutil.copytree(case, work)
        if settings.cores > 1:
            _edit(work / "system/decomposeParDict", numberOfSubdomains=settings.cores, n=f"(1 1 {settings.cores})")
            call(["decomposePar", "-force"], work)
        # last, so that a copy that was killed halfway is not taken for a run
        key_file.write_text(key)
    (work / _STOP).unlink(missing_ok=True)
    _edit(
        work / "system/controlDict",
        endTime=settings.max_iterations,
        writeInterval=min(_SAVES, settings.max_iterations),
    )


def _application(case: Path) -> str:
    """Name of the solver that a case was written for."""
    path = case / "system/controlDict"
    if not path.is_file():
        raise StageError(f"{case} is no OpenFOAM case: {path.relative_to(case)} is missing; run the export stage")
    match = re.search(r"^\s*application\s+(\w+)\s*;", path.read_text(encoding="ascii"), re.MULTILINE)
    if match is None:
        raise StageError(f"{path} names no application; export the case again with --force export")
    return match[1]


def _digest(case: Path, cores: int) -> str:
    digest = hashlib.sha256(str(cores).encode())
    for path in sorted(path for path in case.rglob("*") if path.is_file()):
        digest.update(path.relative_to(case).as_posix().encode())
        with path.open("rb") as file:
            digest.update(hashlib.file_digest(file, "sha256").digest())
    return digest.hexdigest()


def _edit(path: Path, **entries: object) -> None:
    """Set entries of a dictionary that stand on lines of their own."""
    text = path.read_text(encoding="ascii")
    for key, value in entries.items():
        text, count = re.subn(rf"^(\s*{key}\s+)[^;]*;", rf"\g<1>{value};", text, count=1, flags=re.MULTILINE)
        if not count:
            raise StageError(f"{path} has no entry {key}; export the case again with --force export")
    path.write_text(text, encoding="ascii")


def _run(command: list[str], work: Path, flow: Flow, settings: OpenFoamSettings, progress: Progress) -> bool:
    """Run the solver until the pressure drop has settled, it ends, or the time is over; tell whether it has settled."""
    log = work / f"log.{_application(work)}"
    deadline = time.monotonic() + settings.time_limit
    drops, settled = _pressure_drops(work, flow), False

    def look() -> str:
        nonlocal drops, settled
        drops = _pressure_drops(work, flow)
        if len(drops):
            last = change(drops[:, 1], settings.window)
            settled = settled or (last < settings.tolerance and abs(_mass_error(work)) < MASS_ERROR)
            _tell(progress, log, drops, last, settings)
            lost = len(drops) > settings.window and abs(_mass_error(work)) > LOST_MASS
            if lost or not math.isfinite(drops[-1, 1]):
                raise _failure(f"diverged after {drops[-1, 0]:.0f} iterations", log)
        if settled or time.monotonic() > deadline:
            (work / _STOP).touch()
        return "solving"

    with started(command, work, log) as solver:
        child_process.watch(solver, look)
    code = solver.returncode
    if code != 0 or not len(drops):
        at = f"after {drops[-1, 0]:.0f} iterations" if len(drops) else "before its first iteration"
        raise _failure(f"failed {at} (exit code {code})", log)
    # the solver may also find that nothing changes any more before the window is full
    return settled or "SIMPLE solution converged" in tail(log, 40)


def _failure(what: str, log: Path) -> StageError:
    return StageError(
        f"{log.suffix[1:]} {what}; check the mesh's quality, refine tetmesh.edge, or look into {log}, "
        f"which ends:\n{tail(log)}"
    )


def _pressure_drops(work: Path, flow: Flow) -> Floats:
    inlet, outlet = (read_back.history(work, name) for name in (read_back.PRESSURE_IN, read_back.PRESSURE_OUT))
    both = min(len(inlet), len(outlet))
    # OpenFOAM's incompressible pressure is over the density
    return np.column_stack([inlet[:both, 0], flow.density * (inlet[:both, 1] - outlet[:both, 1])])


def _mass_error(work: Path) -> float:
    """Flow out over flow in, less 1, at the last iteration that both are known of."""
    inlet, outlet = (read_back.history(work, name)[:, 1] for name in (read_back.FLOW_IN, read_back.FLOW_OUT))
    both = min(len(inlet), len(outlet))
    return float(-outlet[both - 1] / inlet[both - 1] - 1.0) if both else math.inf


def _tell(progress: Progress, log: Path, drops: Floats, last: float, settings: OpenFoamSettings) -> None:
    found = read_back.residuals(tail(log, 60))
    told = ", ".join(f"{name} {value:.1e}" for name, value in sorted(found.items()))
    # the change falls from 1 to the tolerance, in even steps on a logarithmic scale
    done = math.log(max(min(last, 1.0), settings.tolerance)) / math.log(settings.tolerance)
    progress(
        f"solve: iteration {drops[-1, 0]:.0f}, pressure drop {drops[-1, 1]:.4g} Pa, "
        f"changed by {100 * last:.2g} % in {settings.window} iterations; residuals {told}",
        min(max(done, drops[-1, 0] / settings.max_iterations), 1.0),
    )


def _solution(work: Path, flow: Flow, bed: Bed, settled: bool, seconds: float, cores: int) -> Solution:
    drops = _pressure_drops(work, flow)
    drop = float(drops[-1, 1])
    # the third number of the force's first vector: along z
    drag = float(read_back.history(work, read_back.DRAG, 3)[-1, 1])
    flow_in = -float(read_back.history(work, read_back.FLOW_IN)[-1, 1])
    return Solution(
        pressure_drop=drop,
        flow_rate=flow_in,
        drag=drag,
        permeability=bed.permeability(flow, drop),
        force_balance_error=float(drag / (drop * bed.face_area) - 1.0),
        mass_balance_error=_mass_error(work),
        iterations=int(drops[-1, 0]),
        converged=settled,
        seconds=seconds,
        cores=cores,
        effective_fiber_diameter=bed.effective_diameter(flow, drop),
        f_star=bed.f_star(flow, drag),
    )
