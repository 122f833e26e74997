"""All file formats, a line each: what can be written, what can be read, and why the rest cannot."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterable
from pathlib import Path

from pipeline.export.formats import abaqus, csv, fluent, gmsh, medit, nastran, obj, ply, spaceclaim, stl, su2, vtk
from pipeline.export.formats.format import Format
from pipeline.export.formats.openfoam import format as openfoam
from pipeline.export.formats.unavailable import UNAVAILABLE

FORMATS: tuple[Format, ...] = (
    openfoam.FORMAT,
    vtk.FORMAT,
    fluent.FORMAT,
    gmsh.FORMAT,
    abaqus.FORMAT,
    nastran.FORMAT,
    su2.FORMAT,
    medit.FORMAT,
    stl.FORMAT,
    ply.FORMAT,
    obj.FORMAT,
    csv.FORMAT,
    spaceclaim.FORMAT,
    *UNAVAILABLE,
)
WRITTEN = {each.name: each for each in FORMATS if each.write is not None}
"""Formats that can be written, by name."""


def why_not(name: str) -> str | None:
    """Say why a format is not written; None where it is, or is unknown."""
    return next((each.unavailable_because for each in FORMATS if each.name == name), None)


def of_file(path: Path, head: bytes) -> Format | None:
    """Give the format of a file by its suffix and its first bytes; None where no reader takes it."""
    suffix = path.suffix.lower()
    return next((each for each in FORMATS if each.read and suffix in each.suffixes and each.recognizes(head)), None)


def suffixes_read() -> list[str]:
    """Give the suffixes of all files that are read."""
    return sorted({suffix for each in FORMATS if each.read for suffix in each.suffixes})


def why_not_read(path: Path) -> str | None:
    """Say why files of a suffix are not read; None where they are, or the suffix is unknown."""
    suffix = path.suffix.lower()
    return next((each.unavailable_because for each in FORMATS if suffix in each.suffixes), None)


def held(names: Iterable[str]) -> tuple[type, ...]:
    """Give the nouns that formats hold, each once."""
    return tuple(dict.fromkeys(WRITTEN[name].of for name in names))
