"""One run of OpenFOAM: started or continued, watched, stopped when the pressure drop has settled, read back."""

# SPDX-License-Identifier: GPL-3.0-or-later

import hashlib
import math
import re
import shutil
import stat
import time
from pathlib import Path

import numpy as np

from pipeline import child_process
from pipeline.errors import StageError
from pipeline.line.places import remove, write_text
from pipeline.nouns.arrays import Floats
from pipeline.nouns.flow import Curve, Flow, Settling, Solution
from pipeline.openfoam.environment import openfoam_missing
from pipeline.openfoam.process import call, started, tail
from pipeline.progress import Progress, silent
from pipeline.solve import read_back
from pipeline.solve.bed import Bed
from pipeline.solve.settings import OpenFoamSettings
from pipeline.solve.settled import change
from pipeline.solve.states import KEPT, cut, saved, saving_step

MASS_ERROR = 1e-5
"""A pressure drop counts as settled only where as much air leaves as enters, to this share."""
LOST_MASS = 0.5
"""A run diverges where this share of the air is lost or found between inlet and outlet."""
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
    before = seconds_spent(work)
    command = [program]
    if settings.cores > 1:
        command = ["mpirun", "-np", str(settings.cores), program, "-parallel"]
    try:
        last, settled = _run(command, work, flow, settings, progress)
    finally:
        write_text(work / _SECONDS, f"{before + time.monotonic() - began:.3f}")
    cut(work, last)
    return _solution(work, flow, bed, settled)


def settling(work: Path, flow: Flow, fiber_wall: str) -> Settling:
    """Read how the pressure drop of a run settled."""
    rows = read_back.table(work)
    drops = [_drop(row, flow) for row in rows]
    return Settling((Curve(fiber_wall, tuple(int(at) for at in rows[:, 0]), tuple(drops)),))


def _prepare(case: Path, work: Path, settings: OpenFoamSettings) -> None:
    """Make `work` a copy of the case, split for the cores, unless a run of just this case was killed there."""
    key = _digest(case, settings.cores)
    if _text(work / _KEY) == key:
        # the last fields may be half written: those of which the tables tell are whole
        rows = read_back.table(work)
        cut(work, int(rows[-1, 0]) if len(rows) else 0)
        # and so may be a dictionary that was edited
        remove(work / "system")
        _copy(case / "system", work / "system")
    else:
        remove(work)
        _copy(case, work)
    if settings.cores > 1:
        _edit(work / "system/decomposeParDict", numberOfSubdomains=settings.cores, n=f"(1 1 {settings.cores})")
    if _text(work / _KEY) != key:
        if settings.cores > 1:
            call(["decomposePar", "-force"], work)
        # last, so that a copy that was killed halfway is not taken for a run
        write_text(work / _KEY, key)
    (work / _STOP).unlink(missing_ok=True)
    step = saving_step(settings.max_iterations)
    _edit(
        work / "system/controlDict",
        endTime=settings.max_iterations // step * step,
        writeInterval=step,
        purgeWrite=KEPT,
    )


def _copy(case: Path, work: Path) -> None:
    """Copy the files of a case, and nothing that a link leads to, a pipe or a device: it would take for good."""

    def others(folder: str, names: list[str]) -> list[str]:
        return [name for name in names if not _is_own(Path(folder, name))]

    shutil.copytree(case, work, ignore=others)


def _is_own(path: Path) -> bool:
    mode = path.lstat().st_mode
    return stat.S_ISREG(mode) or stat.S_ISDIR(mode)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii")
    except (OSError, ValueError):
        return ""


def seconds_spent(work: Path) -> float:
    """Wall time [s] of all runs that were kept in a folder."""
    try:
        return float(_text(work / _SECONDS))
    except ValueError:
        return 0.0


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
    for path in sorted(path for path in case.rglob("*") if path.is_file() and not path.is_symlink()):
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


def _run(
    command: list[str], work: Path, flow: Flow, settings: OpenFoamSettings, progress: Progress
) -> tuple[int, bool]:
    """Run the solver until the pressure drop has settled, it ends, or the time is over.

    Returns
    -------
    last : int
        The iteration that counts; the solver may have gone on by chance.
    settled : bool
    """
    log = work / f"log.{_application(work)}"
    deadline = time.monotonic() + settings.time_limit
    rows = read_back.table(work)
    last = _settled(work, rows, settings)
    if last is None and not (len(rows) and _converged(log) and int(rows[-1, 0]) in saved(work)):
        with started(command, work, log) as solver:

            def look() -> str:
                nonlocal rows, last
                rows = read_back.table(work)
                if len(rows):
                    _progress(progress, log, rows, flow, settings)
                    lost = len(rows) > settings.window and abs(_mass_error(rows[-1])) > LOST_MASS
                    if lost or not math.isfinite(_drop(rows[-1], flow)):
                        raise _failure(f"diverged after {rows[-1, 0]:.0f} iterations", log)
                    last = _settled(work, rows, settings)
                    if last is not None:
                        child_process.end(solver)
                if time.monotonic() > deadline:
                    # it saves its fields and ends
                    (work / _STOP).touch()
                return "solving"

            child_process.watch(solver, look)
        if last is None and (solver.returncode != 0 or not len(rows)):
            at = f"after {rows[-1, 0]:.0f} iterations" if len(rows) else "before its first iteration"
            raise _failure(f"failed {at} (exit code {solver.returncode})", log)
    if last is not None:
        return last, True
    # the solver may also find that nothing changes any more before the window is full
    return int(rows[-1, 0]), _converged(log)


def _settled(work: Path, rows: Floats, settings: OpenFoamSettings) -> int | None:
    """Give the first saved iteration at which the pressure drop has settled."""
    step = saving_step(settings.max_iterations)
    drops = rows[:, 1] - rows[:, 2]
    there = saved(work)
    for row in np.flatnonzero(rows[:, 0] % step == 0):
        if (
            change(drops[: row + 1], settings.window) < settings.tolerance
            and abs(_mass_error(rows[row])) < MASS_ERROR
            and int(rows[row, 0]) in there
        ):
            return int(rows[row, 0])
    return None


def _converged(log: Path) -> bool:
    return "SIMPLE solution converged" in tail(log, 40)


def _failure(what: str, log: Path) -> StageError:
    return StageError(
        f"{log.suffix[1:]} {what}; check the mesh's quality, refine tetmesh.edge, or look into {log}, "
        f"which ends:\n{tail(log)}"
    )


def _drop(row: Floats, flow: Flow) -> float:
    # OpenFOAM's incompressible pressure is over the density
    return float(flow.density * (row[1] - row[2]))


def _mass_error(row: Floats) -> float:
    """Flow out over flow in, less 1."""
    return float(-row[4] / row[3] - 1.0)


def _progress(progress: Progress, log: Path, rows: Floats, flow: Flow, settings: OpenFoamSettings) -> None:
    last = change(rows[:, 1] - rows[:, 2], settings.window)
    found = read_back.residuals(tail(log, 60))
    told = ", ".join(f"{name} {value:.1e}" for name, value in sorted(found.items()))
    # the change falls from 1 to the tolerance, in even steps on a logarithmic scale
    done = math.log(max(min(last, 1.0), settings.tolerance)) / math.log(settings.tolerance)
    progress(
        f"solve: iteration {rows[-1, 0]:.0f}, pressure drop {_drop(rows[-1], flow):.4g} Pa, "
        f"changed by {100 * last:.2g} % in {settings.window} iterations; residuals {told}",
        min(max(done, rows[-1, 0] / settings.max_iterations), 1.0),
    )


def _solution(work: Path, flow: Flow, bed: Bed, settled: bool) -> Solution:
    row = read_back.table(work)[-1]
    drop = _drop(row, flow)
    # the third number of the force's first vector: along z
    drags = read_back.history(work, read_back.DRAG, 3)
    drag = float(drags[drags[:, 0] == row[0], 1][0])
    return Solution(
        pressure_drop=drop,
        flow_rate=-float(row[3]),
        drag=drag,
        permeability=bed.permeability(flow, drop),
        force_balance_error=float(drag / (drop * bed.face_area) - 1.0),
        mass_balance_error=_mass_error(row),
        iterations=int(row[0]),
        converged=settled,
        effective_fiber_diameter=bed.effective_diameter(flow, drop),
        f_star=bed.f_star(flow, drag),
    )
