"""Write the page of a run."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.progress import Progress
from pipeline.report.page.page import write_report

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Write the page."""
    return {"page": write_report(results, into, progress).name}
