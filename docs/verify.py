"""Measure what docs/verification.md shows: ``python docs/verify.py runs/verification [PART ...]``, or ``make verify``.

Parts: square, hexagonal, slip, mats, and tables, which draws and writes from what the others left. Finished runs are reused.
"""

import sys
from pathlib import Path

from pipeline.case import read_case
from pipeline.verify.ladder import SLIP, ladder
from pipeline.verify.records import write_records

DOCS = Path(__file__).parent
CASES = DOCS.parent / "cases" / "verification"
RECORDS = DOCS / "verification"


def arrays(arrangement: str, runs: Path) -> None:
    """Climb the ladder of one arrangement."""
    rungs = ladder(read_case(CASES / f"{arrangement}.toml"), runs / arrangement, tell=told)
    write_records(RECORDS / f"{arrangement}.csv", rungs)


def told(what: str, done: float | None = None) -> None:
    """Say which stages are done."""
    if done == 1.0:
        sys.stderr.write(f"{what}\n")


if __name__ == "__main__":
    for part in sys.argv[2:]:
        arrays(part, Path(sys.argv[1]))
