"""`fibertwin init`: a case file that holds every key, each with its meaning."""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import os
import textwrap
from collections.abc import Iterator, Mapping
from pathlib import Path

from pydantic import BaseModel

from pipeline.case import Case
from pipeline.cli.describe import Key, keys, summary
from pipeline.errors import CaseError, StageError
from pipeline.line.places import disk_trouble_explained
from pipeline.mat.settings import (
    ArraySettings,
    BoxSettings,
    FileSettings,
    LayeredSettings,
    Stop,
    SurfaceFileSettings,
)

_WIDTH = 110
GENERATORS: dict[str, type[BaseModel]] = {
    "layered": LayeredSettings,
    "box": BoxSettings,
    "array": ArraySettings,
    "file": FileSettings,
    "surface": SurfaceFileSettings,
}
# What a first case has where there is no default: the paper's fibers in a corner small enough to mesh in a minute.
_FIRST_CASE: Mapping[str, str] = {
    "side": '"20 um"',
    "thickness": '"10 um"',
    "fiber_diameter": '"1.4 um"',
    "relaxation_slope": "0.15",
    "arrangement": '"square"',
    "solidity": '"10 %"',
    "unit": '"um"',
    "pressure_drop": '"320 Pa"',
    "efficiency": '"99.97 %"',
    "count": "100",
    "particle_diameter": '"300 nm"',
    "mean_free_path": '"65.3 nm"',
}
_FIRST_FILE = {"file": '"fibers.csv"', "surface": '"medium.stl"'}
# The key that tells a table's kind, and what the keys that a kind must have are shown with.
_KIND_OF_TABLE = ("distribution", "law")
_WRITTEN: Mapping[str, str] = {
    "diameter": '"1.4 um"',
    "mean": '"1.4 um"',
    "std": '"0.3 um"',
    "median": '"1.2 um"',
    "geometric_std": "1.5",
    "min": '"0.8 um"',
    "max": '"2 um"',
    "parts": '[{weight = 3, diameter = "0.6 um"}, {weight = 1, diameter = {distribution = "lognormal", '
    'median = "3 um", geometric_std = 1.3}}]',
    "concentration": "10",
    "ratio": "1.5",
}
_FIRST_STOP = {"layered": ("coverage", "1"), "box": ("solidity", '"10 %"')}


def write_first_case(path: Path, generator: str) -> None:
    """Write a commented case file.

    Raises
    ------
    CaseError
        If there is no such generator.
    StageError
        If the file is there already, or cannot be written.
    """
    text = first_case(generator)
    with disk_trouble_explained(path):
        try:
            # exclusive creation: no moment between looking and writing
            file = path.open("x", encoding="utf-8")
        except FileExistsError:
            raise StageError(f"{path} is there already and stays as it is; name another file") from None
        except FileNotFoundError:
            raise StageError(f"there is no folder {path.parent}{os.sep}; make it first") from None
        try:
            with file:
                file.write(text)
        except BaseException:
            with contextlib.suppress(OSError):
                path.unlink()
            raise


def first_case(generator: str) -> str:
    """Give the text of a case file with every key, those with a default behind a ``#``."""
    if generator not in GENERATORS:
        raise CaseError(f"there is no generator {generator!r}; the generators are {', '.join(GENERATORS)}")
    lines = [
        f"# {summary(GENERATORS[generator])[:-1]}: a first case, made by fibertwin init.",
        "# Which pressure drop does it have? Keys behind a # show what holds when they are left out.",
    ]
    for key in keys(Case):
        settings = GENERATORS[generator] if key.name == "mat" else key.tables[0]
        lines += ["", "", *_comment(key.meaning), f"[{key.name}]", *_table(settings, generator)]
        if key.name != "mat":
            lines += _nested_tables(key.name, settings)
        if key.name == "mat" and generator in _FIRST_STOP:
            lines += ["", *_comment("When the mat is complete: exactly one quantity."), "[mat.stop]"]
            lines += _table(Stop, generator)
    return "\n".join(lines) + "\n"


def _nested_tables(path: str, settings: type[BaseModel]) -> Iterator[str]:
    """Give the tables within a table, as the engines' own within the mesh's; those not in use as comments alone."""
    for key in keys(settings):
        if key.takes != "a table":
            continue
        (table,) = key.tables
        lines = ["", *_comment(key.meaning), f"[{path}.{key.name}]", *_table(table, "")]
        used = getattr(settings(), key.name) is not None
        yield from lines if used else (line if not line or line.startswith("# ") else _behind(line) for line in lines)


def _behind(line: str) -> str:
    return f"# {line.removeprefix('#')}"


def _table(settings: type[BaseModel], generator: str) -> Iterator[str]:
    stop, target = _FIRST_STOP.get(generator, ("", ""))
    # the key that says what kind of table this is comes first
    for key in sorted(keys(settings), key=lambda key: key.name != "generator"):
        if key.takes == "a table":
            continue
        yield ""
        if key.name == "generator":
            yield from _comment(f"{key.meaning} The generators are {', '.join(GENERATORS)}.")
            yield f'generator = "{generator}"'
            continue
        yield from _comment(f"{key.meaning} Takes: {key.takes}.")
        if key.name == stop and settings is Stop:
            yield f"{key.name} = {target}"
        elif key.required:
            yield f"{key.name} = {_FIRST_FILE[generator] if key.name == 'file' else _FIRST_CASE[key.name]}"
        elif key.default is not None:
            yield f"#{key.name} = {key.default}"
        else:
            yield f"#{key.name} = {_shown(key)}  # not set; this is an example"
        yield from _other_ways(key)


def _other_ways(key: Key) -> Iterator[str]:
    """Show every table that may stand as the value of a key that takes text as well."""
    if " or " not in key.takes:
        return
    if key.tables:
        yield "# Or one of these, without the # and the blank before it:"
    for table in key.tables:
        yield f"# {key.name} = {_inline(table)}  # {summary(table)}"


def _inline(table: type[BaseModel]) -> str:
    """Write a table in one line: the key that says its kind, and those that it must have."""
    kind = next(
        (f'{name} = "{field.default}"' for name, field in table.model_fields.items() if name in _KIND_OF_TABLE), ""
    )
    needed = [f"{key.name} = {_WRITTEN[key.name]}" for key in keys(table) if key.required]
    return f"{{{', '.join([kind, *needed])}}}"


def _shown(key: Key) -> str:
    return _FIRST_CASE.get(key.name) or key.example or '""'


def _comment(text: str) -> list[str]:
    return textwrap.wrap(text.replace("`", ""), _WIDTH, initial_indent="# ", subsequent_indent="# ")
