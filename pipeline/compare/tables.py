"""The comparison as tables for the terminal."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import TYPE_CHECKING

from pipeline.analytics.tables.rows import comparison_tables
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.section import Table

if TYPE_CHECKING:
    from pipeline.line.results import Results


def tables(results: "Results") -> tuple[Table, ...]:
    """Give one table per question."""
    return comparison_tables(results.read(Comparison))
