"""Results as tables for a terminal."""

from collections.abc import Iterable

from rich.table import Table

from pipeline.analytics import comparison_tables
from pipeline.cli.doctor import Finding
from pipeline.quality.table import HEADER, rows, summary
from pipeline.run import Outcome, Run


def findings_table(findings: Iterable[Finding]) -> Table:
    """Show what `doctor` found, one line per thing."""
    table = Table("", "found", "what to do", box=None, title="fibertwin doctor", title_justify="left")
    for finding in findings:
        mark = "ok" if finding.fine else ("MISSING" if finding.needed else "optional")
        table.add_row(f"{mark:8} {finding.name}", finding.found, finding.advice)
    return table


def outcome_table(outcomes: Iterable[Outcome]) -> Table:
    """Show what became of each stage."""
    table = Table("stage", "", "time", "result", box=None)
    for outcome in outcomes:
        result = ", ".join(f"{name.replace('_', ' ')} {_text(value)}" for name, value in outcome.counts.items())
        table.add_row(outcome.stage, outcome.how, duration(outcome.seconds), result)
    return table


def duration(seconds: float) -> str:
    """Give a time in the units people use.

    Examples
    --------
    >>> duration(0.0421), duration(12.34), duration(754)
    ('42 ms', '12.3 s', '12 min 34 s')
    """
    if seconds < 1.0:
        return f"{1000 * seconds:.0f} ms"
    if seconds < 100.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s"


def _text(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, int):
        return f"{value:,}"
    return " ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def result_tables(run: Run, stages: Iterable[str]) -> list[Table]:
    """Make the quality report and the comparison into tables, where the run has them."""
    tables = []
    if "quality" in stages:
        report = run.quality
        tables.append(plain_table(f"mesh quality: {summary(report)}", HEADER, rows(report)))
    if "compare" in stages:
        tables += [plain_table(table.title, table.columns, table.rows) for table in comparison_tables(run.comparison)]
    return tables


def plain_table(title: str, columns: Iterable[str], lines: Iterable[tuple[str, ...]]) -> Table:
    """Make a table whose first column is text and whose others are numbers."""
    first, *rest = columns
    table = Table(first, box=None, title=f"\n{title}", title_justify="left", title_style="bold")
    for column in rest:
        table.add_column(column, justify="right")
    for line in lines:
        table.add_row(*line)
    return table
