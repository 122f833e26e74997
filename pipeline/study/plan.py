"""Which runs a study takes, each with all that its result depends on."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from pipeline.case import Case, read_case
from pipeline.errors import CaseError
from pipeline.line import store
from pipeline.line.manifest import finished
from pipeline.line.run import program_of, wanted
from pipeline.mat.settings import ArraySettings, FileSettings, SurfaceFileSettings
from pipeline.study.settings import Study

RESULTS, WORK = "results", "work"
"""Folders of a study's: each run's numbers, and each run's stages."""


@dataclass(frozen=True, slots=True)
class Task:
    """One run of a study.

    Parameters
    ----------
    point : int
        Which combination of the swept keys.
    seed : int
    overrides : tuple of str
        What ``fibertwin run CASE --set ...`` takes to do the same.
    case : Case
    until : str
    folder : Path
        Of the study.
    name : str
        Of the run's own folder in it.
    key : str
        Digest of all that the result depends on.
    keep : bool
        Whether the stages' own files are kept.
    """

    point: int
    seed: int
    overrides: tuple[str, ...]
    case: Case
    until: str
    folder: Path
    name: str
    key: str
    keep: bool

    @property
    def result(self) -> Path:
        """Folder of the run's numbers."""
        return self.folder / RESULTS / self.name

    @property
    def work(self) -> Path:
        """Folder of the run's stages."""
        return self.folder / WORK / self.name

    @property
    def done(self) -> bool:
        """Whether its result is there and still holds."""
        return finished(self.result, self.key) is not None and (not self.keep or self.work.is_dir())


def plan(study: Study, folder: Path) -> list[Task]:
    """Make the runs of a study, seed after seed: one that is stopped has every combination about equally often.

    Raises
    ------
    CaseError
        If the case or a combination of values is wrong; the message has one line per mistake.
    """
    tasks = []
    mistakes: dict[str, None] = {}
    for number, point in enumerate(study.points()):
        try:
            tasks += _runs(study, number, point, folder.resolve())
        except CaseError as problem:
            # the same mistake in every combination is told once
            mistakes |= dict.fromkeys(str(problem).splitlines())
    if mistakes:
        raise CaseError("\n".join(mistakes))
    return sorted(tasks, key=lambda task: task.seed)


def _runs(study: Study, number: int, point: dict[str, Any], folder: Path) -> list[Task]:
    settings = study.settings(point)
    case = read_case(study.case, settings)
    seeded = not isinstance(case.mat, ArraySettings | FileSettings | SurfaceFileSettings)
    if not seeded and study.seeds > 1:
        raise CaseError(f'seeds = {study.seeds}: a mat of generator = "{case.mat.generator}" is always the same; set 1')
    tasks = []
    for seed in range(study.first_seed, study.first_seed + study.seeds):
        overrides = (*settings, f"mat.seed={seed}") if seeded else settings
        mat = case.mat.model_copy(update={"seed": seed}) if seeded else case.mat
        each = case.model_copy(update={"mat": mat})
        tasks.append(
            Task(
                point=number,
                seed=seed,
                overrides=overrides,
                case=each,
                until=study.until,
                folder=folder,
                name=store.digest(overrides)[:16],
                key=_key(each, study.until),
                keep=study.keep == "everything",
            )
        )
    return tasks


def _key(case: Case, until: str) -> str:
    settings = case.model_dump(mode="json")
    stages = wanted(case, until)
    tables = dict.fromkeys(name for stage in stages for name in (stage.name, *stage.reads, "flow") if name in settings)
    sources = [path for stage in stages for path in stage.sources(case)]
    return store.digest(
        {
            "until": until,
            "sources": [store.file_digest(path) for path in sources if path.is_file()],
            "parameters": {name: settings[name] for name in tables},
            "made_by": _made_by(until),
        }
    )


@cache
def _made_by(until: str) -> str:
    return store.digest(list(program_of(until)))
