"""Results as tables for a terminal."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from rich.console import Group
from rich.table import Table
from rich.text import Text

from pipeline.units import duration

if TYPE_CHECKING:
    from pipeline.cli.doctor import Finding
    from pipeline.line.results import Results
    from pipeline.line.run import Outcome, Prospect
    from pipeline.line.stage import Stage


def findings_table(findings: "Iterable[Finding]") -> Table:
    """Show what `doctor` found, one line per thing."""
    table = Table("", "found", "what to do", box=None, title="fibertwin doctor", title_justify="left")
    for finding in findings:
        mark = "ok" if finding.fine else ("MISSING" if finding.needed else "optional")
        table.add_row(f"{mark:8} {finding.name}", Text(finding.found), Text(finding.advice))
    return table


def outcome_table(outcomes: "Iterable[Outcome]", line: "Iterable[Stage]") -> Table:
    """Show what became of each stage, and why."""
    units = {stage.name: stage.units for stage in line}
    table = Table("stage", "", "time", "result", "why", box=None)
    for outcome in outcomes:
        result = ", ".join(_count(name, value, units[outcome.stage]) for name, value in outcome.counts.items())
        why = "; ".join(outcome.why)
        table.add_row(outcome.stage, outcome.how, duration(outcome.seconds), Text(result), Text(why))
    return table


def prospect_table(prospects: "Iterable[Prospect]") -> Table:
    """Show what would become of each stage, why, and what it would take."""
    table = Table("stage", "would", "why", "cells", "memory", "processor time", box=None)
    for each in prospects:
        cost = each.estimate
        numbers = (
            (f"{cost.cells:,.2g}", f"{cost.memory / 2**30:.2g} GiB", duration(cost.seconds)) if cost else ("", "", "")
        )
        table.add_row(each.stage, each.would, Text("; ".join(each.why)), *numbers)
    return table


_PER_SI = {"nm": 1e9, "%": 100.0, "um": 1e6, "um3": 1e18, "Pa": 1.0, "deg": 1.0}
"""How many of a unit, in which a stage tells a count, make one in SI."""


def _count(name: str, value: object, units: Mapping[str, str]) -> str:
    """Give one count of a stage's manifest, which is in SI, in the unit that its stage names."""
    label = name.replace("_", " ")
    if name == "reason":
        return str(value)
    if isinstance(value, bool):
        return label if value else f"not {label}"
    if isinstance(value, int | float) and name in units:
        return f"{label} {value * _PER_SI[units[name]]:,.4g} {units[name]}"
    if isinstance(value, float):
        return f"{label} {value:.4g}"
    if isinstance(value, int):
        return f"{label} {value:,}"
    return f"{label} {' '.join(map(str, value))}" if isinstance(value, list | tuple) else f"{label} {value}"


def result_tables(results: "Results", stages: Iterable[str]) -> list[Group]:
    """Lay out what stages show of their results."""
    shown = [stage.tables for stage in results.line if stage.name in stages and stage.tables is not None]
    return [plain_table(table.title, table.columns, table.rows) for tables in shown for table in tables(results)]


def story_table(stories: Iterable[tuple[str, str]]) -> Table:
    """Show names and what each is about."""
    table = Table("name", "what it is, and which question it answers", box=None, padding=(0, 1, 1, 0))
    for name, text in stories:
        table.add_row(Text(name), Text(text))
    return table


_BETWEEN_NOTES = re.compile(r"; (?![^(]*\))")
_NOTES = "outside its range"
"""Column whose texts are too long for a terminal: they become notes below the table."""


def plain_table(title: str, columns: Iterable[str], lines: Iterable[tuple[str, ...]]) -> Group:
    """Make a table whose first column is text and whose others are numbers; long notes go below it."""
    heads, table_rows = list(columns), list(lines)
    notes: list[str] = []
    if heads[-1] == _NOTES:
        heads[-1] = "notes"
        table_rows = [(*cells, _numbered(note, notes)) for *cells, note in table_rows]
    table = Table(box=None, padding=(0, 1, 0, 0))
    # as Text: rich would read a unit in brackets as its markup and drop it
    table.add_column(Text(heads[0]))
    for column in heads[1:]:
        table.add_column(Text(column), justify="right")
    for cells in table_rows:
        table.add_row(*map(Text, cells))
    # as lines of their own: a table's title and caption are no wider than the table
    below = [Text(f"{number} {note}") for number, note in enumerate(notes, 1)]
    return Group(Text(f"\n{title}", style="bold"), table, *below)


def _numbered(text: str, notes: list[str]) -> str:
    """Give the numbers of the notes in a text, and add those that are new."""
    parts = _BETWEEN_NOTES.split(text) if text else []
    notes.extend(part for part in dict.fromkeys(parts) if part not in notes)
    return " ".join(str(notes.index(part) + 1) for part in parts)
