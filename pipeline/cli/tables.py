"""Results as tables for a terminal."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from collections.abc import Iterable

from rich.console import Group
from rich.table import Table
from rich.text import Text

from pipeline.analytics.tables.rows import comparison_tables, length
from pipeline.cli.doctor import Finding
from pipeline.line.run import Outcome, Run
from pipeline.nouns.flow import Solution
from pipeline.nouns.quality import QualityReport
from pipeline.quality.table import HEADER, rows, summary


def findings_table(findings: Iterable[Finding]) -> Table:
    """Show what `doctor` found, one line per thing."""
    table = Table("", "found", "what to do", box=None, title="fibertwin doctor", title_justify="left")
    for finding in findings:
        mark = "ok" if finding.fine else ("MISSING" if finding.needed else "optional")
        table.add_row(f"{mark:8} {finding.name}", Text(finding.found), Text(finding.advice))
    return table


def outcome_table(outcomes: Iterable[Outcome]) -> Table:
    """Show what became of each stage."""
    table = Table("stage", "", "time", "result", box=None)
    for outcome in outcomes:
        result = ", ".join(_count(name, value) for name, value in outcome.counts.items())
        table.add_row(outcome.stage, outcome.how, duration(outcome.seconds), Text(result))
    return table


def duration(seconds: float) -> str:
    """Give a time in the units people use.

    Examples
    --------
    >>> duration(0.0421), duration(12.34), duration(754), duration(7500)
    ('42 ms', '12.3 s', '12 min 34 s', '2 h 5 min')
    """
    if seconds < 1.0:
        return f"{1000 * seconds:.0f} ms"
    if seconds < 100.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes >= 60:
        return f"{minutes // 60} h {minutes % 60} min"
    return f"{minutes} min {rest} s"


_PERCENT = {"solidity", "mesh_solidity", "efficiency", "volume_error", "force_balance_error"}
_UNITS = {"fluid_volume": ("um3", 1e18), "max_non_orthogonality": ("deg", 1.0), "pressure_drop": ("Pa", 1.0)}


def _count(name: str, value: object) -> str:
    """Give one count of a stage's manifest, which is in SI, in the units people use."""
    label = name.replace("_", " ")
    if name == "reason":
        return str(value)
    if isinstance(value, bool):
        return label if value else f"not {label}"
    if isinstance(value, int | float) and name in _PERCENT:
        return f"{label} {100 * value:.4g} %"
    if isinstance(value, int | float) and name in _UNITS:
        unit, per_si = _UNITS[name]
        return f"{label} {value * per_si:,.4g} {unit}"
    if isinstance(value, float):
        return f"{label} {value:.4g}"
    if isinstance(value, int):
        return f"{label} {value:,}"
    return f"{label} {' '.join(map(str, value))}" if isinstance(value, list | tuple) else f"{label} {value}"


def result_tables(run: Run, stages: Iterable[str]) -> list[Group]:
    """Make the quality report and the comparison into tables, where the run has them."""
    tables = []
    if "quality" in stages:
        tables.append(quality_table(run.quality, "mesh quality: "))
    if "compare" in stages:
        tables += [plain_table(table.title, table.columns, table.rows) for table in comparison_tables(run.comparison)]
    if "solve" in stages:
        tables.append(solution_table(run.solution))
    return tables


def quality_table(report: QualityReport, opening: str = "") -> Group:
    """Show a mesh's quality: one line per metric. What each is measured on stands in the JSON: a terminal is narrow."""
    return plain_table(
        opening + summary(report), (HEADER[0], *HEADER[2:]), [(name, *numbers) for name, _, *numbers in rows(report)]
    )


def solution_table(solution: Solution) -> Group:
    """Lay a solution out in the units people use."""
    rows = [
        ("pressure drop", f"{solution.pressure_drop:.4g} Pa"),
        ("flow rate", f"{solution.flow_rate * 1e9:.4g} mm3/s"),
        ("drag on the fibers", f"{solution.drag * 1e9:.4g} nN"),
        ("permeability", f"{solution.permeability * 1e12:.4g} um2"),
    ]
    if solution.effective_fiber_diameter is not None:
        rows.append(("effective fiber diameter", length(solution.effective_fiber_diameter)))
    if solution.f_star is not None:
        rows.append(("drag per length F*", f"{solution.f_star:.5g}"))
    settled = "settled" if solution.converged else "NOT settled: raise solve.max_iterations or solve.time_limit"
    rows += [
        ("iterations", f"{solution.iterations:,}, {settled}"),
        ("forces balance to", f"{abs(solution.force_balance_error):.2g}"),
        ("mass balances to", f"{abs(solution.mass_balance_error):.2g}"),
        ("time", f"{duration(solution.seconds)} on {solution.cores} core{'s' if solution.cores > 1 else ''}"),
    ]
    return plain_table("solution", ("", ""), rows)


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
