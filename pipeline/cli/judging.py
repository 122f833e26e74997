"""`fibertwin quality`: any mesh, whoever made it, held against the limits."""

import dataclasses
import json
import sys
from pathlib import Path

from rich.console import Console

from pipeline.case import read_case
from pipeline.cli.listen import listening
from pipeline.cli.printable import printable
from pipeline.cli.tables import quality_table
from pipeline.data import FaceMesh, QualityReport
from pipeline.export import read_mesh
from pipeline.quality import judge
from pipeline.quality.settings import QualitySettings
from pipeline.run import CASE, Run

FELL_SHORT = 1
"""Exit code where a limit does not hold."""


def judge_mesh(path: Path, limits: Path | None, as_json: bool, quiet: bool) -> int:
    """Print what a mesh is like and give the exit code: 0 where every limit holds."""
    settings = read_case(limits).quality if limits else None
    with listening(Console(stderr=True), quiet or as_json) as tell:
        tell(f"reading {path}")
        mesh, of_run = _mesh(path)
        report = judge(mesh, settings or of_run, tell)
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(report), indent=2, allow_nan=False) + "\n")
    elif not quiet:
        _show(report)
    return 0 if report.passed else FELL_SHORT


def _mesh(path: Path) -> tuple[FaceMesh, QualitySettings | None]:
    # a run of ours keeps its mesh, and its case has limits of its own
    if (path / CASE).is_file():
        run = Run.opened(path)
        return run.mesh, run.case.quality
    return read_mesh(path), None


def _show(report: QualityReport) -> None:
    out = Console()
    out.print(quality_table(report))
    patches = ", ".join(f"{name} {count:,}" for name, count in report.patches.items())
    out.print(f"patches by faces: {printable(patches)}", markup=False, highlight=False, soft_wrap=True)
    for reason in report.reasons:
        out.print(f"- {reason}", markup=False, highlight=False, soft_wrap=True)
