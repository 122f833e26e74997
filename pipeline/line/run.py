"""The line: stage after stage, each result kept on disk and reused while it holds, and why each stage ran."""

# SPDX-License-Identifier: GPL-3.0-or-later

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pipeline.case import Case
from pipeline.errors import StageError
from pipeline.line import places, store
from pipeline.line.manifest import read_manifest, write_manifest
from pipeline.line.reasons import NO_RESULT, identity, of_this_case, reasons
from pipeline.line.results import Results
from pipeline.line.stage import Counts, Estimate, Stage, giver
from pipeline.line.stages import LINE
from pipeline.line.store import CASE
from pipeline.machine import peak_memory
from pipeline.progress import Progress, silent
from pipeline.report.stage import PAGE

STAGES = tuple(stage.name for stage in LINE)
LAST = [stage.name for stage in LINE if not stage.asked][-1]
"""Where a run ends that nobody asked more of."""
FORCED = "asked for"
"""Why a stage runs that holds and is made again all the same."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a stage.

    Parameters
    ----------
    stage : str
    folder : Path
    how : str
        ``made``, ``reused``, or ``skipped``; the counts then hold the reason.
    seconds : float [s]
    counts : dict
    why : tuple of str
        Why it was made.
    """

    stage: str
    folder: Path
    how: str
    seconds: float
    counts: Counts
    why: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Prospect:
    """What would become of a stage.

    Parameters
    ----------
    stage : str
    would : str
        ``run``, ``reuse``, ``skip``, or ``follow``: run only if what it needs changes when that is made again.
    why : tuple of str
    estimate : Estimate, optional
        What it would take, where that is known beforehand.
    """

    stage: str
    would: str
    why: tuple[str, ...]
    estimate: Estimate | None = None


@dataclass(frozen=True, eq=False, slots=True)
class Run(Results):
    """The results of a run of the whole line."""

    line: tuple[Stage, ...] = field(default=LINE)

    @classmethod
    def opened(cls, folder: Path) -> "Run":
        """Open the folder of an earlier run; what stands there from another case is left out.

        Raises
        ------
        StageError
            If the folder is not one.
        """
        if not (folder / CASE).is_file():
            raise StageError(f"{folder} is no run: it has no {CASE}; make one with fibertwin run CASE --out {folder}")
        return cls.of_case(store.load_json(Case, folder / CASE), folder)

    @classmethod
    def of_case(cls, case: Case, folder: Path) -> "Run":
        """Give the results of a case, without those that other settings or inputs made."""
        return cls(case, folder, left_out=_left_out(case, folder))


def _left_out(case: Case, folder: Path) -> tuple[str, ...]:
    results = Results(case, folder, LINE)
    holds: dict[str, bool] = {}
    for stage in LINE:
        if results.manifest(stage.name) is not None and not stage.shows_run:
            givers = {giver(LINE, noun).name for noun in stage.needs(case)}
            holds[stage.name] = all(holds.get(name, False) for name in givers) and of_this_case(stage, results)
    return tuple(name for name, fine in holds.items() if not fine)


def run(
    case: Case,
    folder: Path,
    until: str = LAST,
    force: frozenset[str] = frozenset(),
    progress: Progress = silent,
    without: frozenset[str] = frozenset(),
) -> list[Outcome]:
    """Run the line for a case, stage by stage, and reuse what still holds.

    Parameters
    ----------
    case : Case
    folder : Path
        Where this run's stages are kept; made if it is not there.
    until : str
        The last stage to run, one of `STAGES`.
    force : frozenset of str
        Stages to make again though they hold.
    progress : Progress
    without : frozenset of str
        Stages to leave out, as a program that runs many cases leaves out the report.

    Returns
    -------
    list of Outcome
        One per stage, in order.

    Raises
    ------
    StageError
        If a stage cannot do what the case asks, or the folder cannot be written; finished stages are kept.
    """
    stages = [stage for stage in wanted(case, until) if stage.name not in without]
    _refuse_obstacles(stages, case, folder)
    outcomes = []
    with places.locked(folder):
        store.write_json(folder / CASE, case.content())
        for stage in stages:
            outcomes.append(_step(stage, case, folder, stage.name in force, progress))
        for stage in stages:
            if stage.after is not None and read_manifest(folder / stage.name) is not None:
                with places.disk_trouble_explained(folder / stage.name):
                    stage.after(Run.of_case(case, folder))
    return outcomes


def dry_run(case: Case, folder: Path, until: str = LAST, force: frozenset[str] = frozenset()) -> list[Prospect]:
    """Tell what `run` would do and why, and do nothing.

    Parameters
    ----------
    case : Case
    folder : Path
    until : str
    force : frozenset of str

    Returns
    -------
    list of Prospect
        One per stage, in order.
    """
    found: dict[str, Prospect] = {}
    for stage in wanted(case, until):
        found[stage.name] = _prospect(stage, case, folder, stage.name in force, found)
    return list(found.values())


def _prospect(stage: Stage, case: Case, folder: Path, again: bool, before: dict[str, Prospect]) -> Prospect:
    results = Run.of_case(case, folder) if stage.shows_run else Run(case, folder)
    why = (FORCED,) if again else reasons(stage, results)
    if why and stage.obstacle is not None and (obstacle := stage.obstacle(results)) is not None:
        return Prospect(stage.name, "skip", (obstacle,))
    estimate = stage.estimate(case) if stage.estimate is not None else None
    if why:
        return Prospect(stage.name, "run", why, estimate)
    sources = [giver(LINE, noun).name for noun in (*stage.needs(case), *stage.takes(case))]
    changing = [name for name in (before if stage.shows_run else dict.fromkeys(sources)) if _may_change(before, name)]
    if changing:
        return Prospect(stage.name, "follow", tuple(f"if {name} changes" for name in changing), estimate)
    return Prospect(stage.name, "reuse", ())


def _may_change(before: dict[str, Prospect], stage: str) -> bool:
    return stage in before and before[stage].would in ("run", "follow")


def report(folder: Path, progress: Progress = silent) -> Path:
    """Write the page of a run as far as the run went.

    Parameters
    ----------
    folder : Path
        Of a run, whole or partial.
    progress : Progress

    Returns
    -------
    Path
        The page.

    Raises
    ------
    StageError
        If the folder is no run or cannot be written.
    """
    case = Run.opened(folder).case
    with places.locked(folder):
        return _step(LINE[-1], case, folder, True, progress).folder / PAGE


def wanted(case: Case, until: str) -> list[Stage]:
    """Give the stages that lead to one: all before it, but those that run only when asked only if they are.

    A stage is asked for by its table in the case file, by its name, or by a stage that needs it. A run that is asked
    for such a stage at the end of the line goes on to its report.
    """
    asked = set(case.asked)
    for stage in reversed(LINE):
        if stage.name == until or stage.name in asked:
            asked |= {source.name for noun in stage.needs(case) if (source := giver(LINE, noun)).asked}
            asked.add(stage.name)
    last, end = STAGES.index(until), STAGES.index(LAST)
    if all(stage.asked for stage in LINE[last:end]):
        last = max(last, end)
    return [stage for stage in LINE[: last + 1] if not stage.asked or stage.name in asked]


def _refuse_obstacles(stages: list[Stage], case: Case, folder: Path) -> None:
    """Refuse, before anything is made for nothing, what a stage that others need cannot do on this machine."""
    results = Results(case, folder, LINE)
    for stage in stages:
        # a stage that nobody needs is skipped; one that is there may still hold
        if stage.obstacle is None or stage.asked or results.manifest(stage.name) is not None:
            continue
        obstacle = stage.obstacle(results)
        if obstacle is not None:
            raise StageError(str(obstacle))


def _step(stage: Stage, case: Case, folder: Path, again: bool, progress: Progress) -> Outcome:
    results = Run.of_case(case, folder) if stage.shows_run else Run(case, folder)
    place = folder / stage.name
    why = (FORCED,) if again else reasons(stage, results)
    if not why:
        done: dict[str, Any] = read_manifest(place) or {}
        # of a run that was killed between its result and its end
        places.remove(places.kept_folder(folder, stage.name))
        progress(f"{stage.name}: reused", 1.0)
        return Outcome(stage.name, place, "reused", float(done["seconds"]), done["counts"])
    obstacle = stage.obstacle(results) if stage.obstacle is not None else None
    if obstacle is not None and not stage.asked:
        # others need it: it may have had a result when the run began, or room
        raise StageError(obstacle)
    if obstacle is not None:
        return Outcome(stage.name, place, "skipped", 0.0, {"reason": obstacle})
    progress(f"{stage.name}: {'; '.join(why)}", 0.0)
    began = time.perf_counter()
    with places.side_folder(place) as side:
        depends_on = identity(stage, results)
        key = store.digest(depends_on)
        counts: Counts = stage.make(replace(results, key=key), side, progress)
        seconds = time.perf_counter() - began
        made = {"stage": stage.name, "key": key, "why": why, **depends_on}
        cost = {"seconds": seconds, "peak_memory": peak_memory()}
        write_manifest(side, {**made, **cost, "counts": counts}, stage.records)
    return Outcome(stage.name, place, "made", seconds, counts, why)


def program_of(until: str) -> Iterator[str]:
    """Give what the results of the stages up to one depend on in the program and its libraries, as lines of text."""
    from pipeline.line.code import code_of, libraries_of

    for stage in LINE[: STAGES.index(until) + 1]:
        for name, digest in {**code_of(stage.make.module), **libraries_of(stage.make.module)}.items():
            yield f"{stage.name} {name} {digest}"


__all__ = [
    "CASE",
    "FORCED",
    "LAST",
    "LINE",
    "NO_RESULT",
    "STAGES",
    "Outcome",
    "Prospect",
    "Run",
    "dry_run",
    "program_of",
    "report",
    "run",
    "wanted",
]
