"""What a stage shows of its result: tables for the terminal, and a section for the report."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Table:
    """A title, column heads, and rows of as many cells."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Facts:
    """What and how much, line by line."""

    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Charts:
    """Charts side by side, each an ``<svg>`` element as `pipeline.report.page.svg.chart` gives it."""

    drawings: tuple[str, ...]
    caption: str = ""
    wide: bool = False


@dataclass(frozen=True, slots=True)
class Picture:
    """A rendered view, by its name; left out where it could not be drawn."""

    view: str
    caption: str


@dataclass(frozen=True, slots=True)
class Pictures:
    """Views side by side."""

    views: tuple[Picture, ...]


@dataclass(frozen=True, slots=True)
class Photograph:
    """A picture that is there already, by the address of its own content (``data:``); empty where it is lost."""

    source: str
    caption: str


@dataclass(frozen=True, slots=True)
class Photographs:
    """Such pictures side by side."""

    pictures: tuple[Photograph, ...]


@dataclass(frozen=True, slots=True)
class Text:
    """A paragraph; `mark` is ``""``, ``"soft"``, ``"good"``, ``"note"`` or ``"bad"``."""

    words: str
    mark: str = ""


@dataclass(frozen=True, slots=True)
class Heading:
    """A title within a section, which `anchor` leads to."""

    title: str
    anchor: str = ""


@dataclass(frozen=True, slots=True)
class Columns:
    """Parts beside each other: a narrow and a wide column, or all of them even."""

    columns: tuple[tuple["Part", ...], ...]
    even: bool = False


Part = Table | Facts | Charts | Picture | Pictures | Photographs | Text | Heading | Columns
"""What a section is made of."""


@dataclass(frozen=True, slots=True)
class Section:
    """A section of the report.

    Parameters
    ----------
    anchor : str
        Its id on the page.
    short : str
        Its name among the links at the top.
    title : str
    parts : tuple of Part
        In order; words in them are escaped, drawings are not.
    """

    anchor: str
    short: str
    title: str
    parts: tuple[Part, ...]
