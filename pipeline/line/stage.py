"""What a stage of the line says about itself, in its own room: what it needs, what it gives, and what makes it."""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Counts = dict[str, object]
"""What a stage tells of its result in a few words: names and values, in SI."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A function by its place, loaded when it is called first: what describes a stage must not load its libraries.

    Parameters
    ----------
    place : str
        ``module:function``, as in ``pipeline.mat.make:make``.
    """

    place: str

    @property
    def module(self) -> str:
        """The module that holds the function."""
        return self.place.partition(":")[0]

    def load(self) -> Callable[..., Any]:
        """Import the module and give the function."""
        module, _, name = self.place.partition(":")
        function: Callable[..., Any] = getattr(importlib.import_module(module), name)
        return function

    def __call__(self, *arguments: Any) -> Any:
        """Load the function and call it."""
        return self.load()(*arguments)


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a stage will take, before it is started: cells, bytes of memory, and seconds of processor time."""

    cells: float
    memory: float
    seconds: float


def _nothing(case: Any) -> tuple[()]:
    return ()


@dataclass(frozen=True, slots=True)
class Stage:
    """One step of the line, described by its own room.

    Parameters
    ----------
    name : str
        Of its folder, of its table in the case file, and on the terminal.
    about : str
        What its table in the case file is about.
    make : Entry
        ``make(results, into, progress) -> Counts``: reads nouns from `results`, writes the stage's files into the
        folder `into`. All that the result depends on follows from what its module imports.
    needs : callable
        Takes the case, gives the nouns (types) that the stage reads; the stages that give them come before it.
    takes : callable
        The same for nouns that it reads only where they are there.
    gives : mapping of type to str
        Each noun that the stage leaves, and its file or folder: ``.npz`` and ``.json`` are read by `line.store`, a
        folder becomes the noun by its path.
    settings : type, optional
        Model of the stage's own table in the case file.
    required : bool
        Whether a case file has to have that table.
    reads : tuple of str
        Other tables of the case file that the result depends on.
    sources : callable
        Takes the case, gives files beside the case file that the result depends on.
    records : tuple of str
        Patterns of files that tell how the result came about (seconds, memory, logs) and are no part of it: what comes
        after does not depend on them.
    shows_run : bool
        Whether the stage shows the whole run: it depends on every table of the case, on the files and records of all
        stages before it, and on what makes their sections.
    units : mapping of str to str
        In which unit a count is told, by its name; its value is in SI.
    obstacle : Entry, optional
        ``obstacle(results) -> str | None``: what keeps the stage from running on this machine.
    asked : bool
        Whether the stage runs only where the case file has its table, or somebody asks for it.
    tables : Entry, optional
        ``tables(results) -> iterable of Table``: what the terminal shows of the result.
    section : Entry, optional
        ``section(results) -> Section | None``: what the report shows of it.
    estimate : Entry, optional
        ``estimate(case) -> Estimate``: what the stage will take.
    after : Entry, optional
        ``after(results) -> None``: called at the end of every run that the stage is part of, whether it was made or
        reused, to bring its records up to date with what came behind it.
    """

    name: str
    about: str
    make: Entry
    needs: Callable[[Any], tuple[type, ...]] = _nothing
    takes: Callable[[Any], tuple[type, ...]] = _nothing
    gives: Mapping[type, str] = field(default_factory=dict)
    settings: Any = None
    required: bool = False
    reads: tuple[str, ...] = ()
    sources: Callable[[Any], Iterable[Path]] = _nothing
    records: tuple[str, ...] = ()
    shows_run: bool = False
    units: Mapping[str, str] = field(default_factory=dict)
    obstacle: Entry | None = None
    asked: bool = False
    tables: Entry | None = None
    section: Entry | None = None
    estimate: Entry | None = None
    after: Entry | None = None


def needing(*nouns: type) -> Callable[[Any], tuple[type, ...]]:
    """Say that a stage needs these nouns, whatever the case."""

    def needs(case: Any) -> tuple[type, ...]:
        return nouns

    return needs


def giver(line: Iterable[Stage], noun: type) -> Stage:
    """Find the stage that gives a noun.

    Raises
    ------
    LookupError
        If there is none: a fault of the line, not of a case.
    """
    for stage in line:
        if noun in stage.gives:
            return stage
    raise LookupError(f"no stage of the line gives {noun.__name__}")
