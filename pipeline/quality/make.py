"""Judge the mesh, and keep the report and the fields that it is made of."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.line import store
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.progress import Progress
from pipeline.quality.judge import judge_with_fields
from pipeline.quality.walls import with_walls

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Judge the mesh."""
    mesh, measures = results.read(FaceMesh), results.read(TetmeshMeasures)
    report, fields = judge_with_fields(mesh, results.case.quality, progress)
    if measures.fidelity is not None:
        report = with_walls(report, measures.fidelity, results.case.tetmesh.deviation)
    store.write_json(into / "quality.json", report)
    store.save(fields, into / "fields.npz")
    return {"verdict": report.verdict, "max_non_orthogonality": report.metrics["non_orthogonality"].max}
