"""`fibertwin quality`: any mesh, whoever made it, held against the limits."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import sys
from pathlib import Path
from typing import Literal

from rich.console import Console

from pipeline.case import read_case
from pipeline.cli.listen import listening
from pipeline.cli.printable import printable
from pipeline.cli.tables import plain_table
from pipeline.export.read import mesh_files, read_mesh
from pipeline.line.places import disk_trouble_explained
from pipeline.line.run import CASE, Run
from pipeline.line.store import file_digest
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import QualityReport
from pipeline.progress import Progress
from pipeline.quality.judge import judge
from pipeline.quality.settings import QualitySettings
from pipeline.quality.table import terminal_table

EXIT_CODES = {"pass": 0, "warn": 3, "fail": 4}
"""Exit code of each verdict; a file that cannot be read ends with 1, a command line that asks for nonsense with 2."""


@dataclasses.dataclass(frozen=True, slots=True)
class _Source:
    # a run of ours keeps its mesh, and its case has limits of its own
    mesh: FaceMesh
    files: list[Path]
    limits: QualitySettings
    limits_of: str


def judge_mesh(
    path: Path,
    limits: Path | None,
    page: Path | None,
    model: Path | None,
    as_json: bool,
    quiet: bool,
    fail_on: Literal["warn", "fail"] = "warn",
) -> int:
    """Print what a mesh is like and give the exit code: 0 where the verdict is better than what one fails on."""
    settings = read_case(limits).quality if limits else None
    with listening(Console(stderr=True), quiet or as_json) as progress:
        progress(f"reading {path}")
        source = _source(path)
        if limits is not None and settings is not None:
            source = dataclasses.replace(source, limits=settings, limits_of=f"The limits are those of {limits}")
        report = judge(source.mesh, source.limits, progress)
        if page or model:
            _write_pages(path, source, report, page, model, progress)
    if as_json:
        sys.stdout.write(json.dumps(dataclasses.asdict(report), indent=2, allow_nan=False) + "\n")
    elif not quiet:
        _show(report)
        for what, file in (("read it:", page), ("turn it:", model)):
            if file is not None:
                Console().print(what, file, markup=False, highlight=False, soft_wrap=True)
    return 0 if report.verdict == "warn" and fail_on == "fail" else EXIT_CODES[report.verdict]


def _source(path: Path) -> _Source:
    if (path / CASE).is_file():
        run = Run.opened(path)
        return _Source(
            run.read(FaceMesh), [run.path(FaceMesh)], run.case.quality, f"The limits are those of {path / CASE}"
        )
    return _Source(read_mesh(path), mesh_files(path), QualitySettings(), "The limits are those of checkMesh")


def _write_pages(
    path: Path, source: _Source, report: QualityReport, page: Path | None, model: Path | None, progress: Progress
) -> None:
    # pages take a second to load what they need, for nobody who wants a table only
    from pipeline.report.page.content import MeshContent, SourceFile
    from pipeline.report.page.mesh_page import write_mesh_page
    from pipeline.report.views.layers import layers_of_mesh
    from pipeline.report.views.model_file import write_model

    files = tuple(SourceFile(str(file), file.stat().st_size, file_digest(file)) for file in source.files)
    content = MeshContent(path, source.mesh, report, source.limits, source.limits_of, files)
    if page is not None:
        with disk_trouble_explained(page):
            write_mesh_page(content, page, progress)
    if model is not None:
        progress("page: model to turn")
        with disk_trouble_explained(model):
            write_model(layers_of_mesh(content), str(path), model, flow=False)


def _show(report: QualityReport) -> None:
    out = Console()
    table = terminal_table(report)
    out.print(plain_table(table.title, table.columns, table.rows))
    patches = ", ".join(f"{name} {count:,}" for name, count in report.patches.items())
    out.print(f"patches by faces: {printable(patches)}", markup=False, highlight=False, soft_wrap=True)
    for remark in (*report.reasons, *(f"note: {note}" for note in report.notes)):
        out.print(f"- {remark}", markup=False, highlight=False, soft_wrap=True)
