"""Make the mat that a case asks for, measure it, and keep both."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.analytics.models.growth import Predictor, predictor
from pipeline.cad.fibers import write_fibers
from pipeline.errors import CaseError
from pipeline.line import store
from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.mat.settings import BoxSettings, LayeredSettings, SurfaceFileSettings
from pipeline.mat.sums import report_stop
from pipeline.nouns.surface_file import SurfaceFile
from pipeline.progress import Progress
from pipeline.units import parse

if TYPE_CHECKING:
    from pipeline.line.results import Results
    from pipeline.line.stage import Counts


def make(results: "Results", into: Path, progress: Progress) -> "Counts":
    """Draw the fibers."""
    settings, predict = results.case.mat, mat_predictor(results.case)
    if isinstance(settings, SurfaceFileSettings):
        store.write_json(into / "surface_file.json", named_surface(settings))
        return {"file": settings.file.name}
    mat = generate(settings, predict, progress)
    measures = measure(mat)
    store.save(mat, into / "mat.npz")
    store.write_json(into / "measures.json", measures)
    write_fibers(mat, into / "fibers.csv")
    counts: Counts = {"fibers": mat.fibers, "segments": mat.segments}
    if isinstance(settings, LayeredSettings | BoxSettings):
        stop = report_stop(settings.stop, measures, predict)
        store.write_json(into / "stop.json", stop)
        counts[stop.quantity] = stop.reached
    return counts


def named_surface(settings: SurfaceFileSettings) -> SurfaceFile:
    """Say where a medium's surface is read from, and how.

    Raises
    ------
    CaseError
        If there is no such file.
    """
    if not settings.file.is_file():
        raise CaseError(f"cannot read the surface {settings.file}: there is no such file")
    return SurfaceFile(
        str(settings.file), store.file_digest(settings.file), parse(f"1 {settings.unit}", "m"), settings.side
    )


def mat_predictor(case: Any) -> Predictor | None:
    """Make what a mat that grows toward a predicted quantity asks after each fiber."""
    # arrays and fibers from a file grow toward nothing
    return predictor(case.mat.stop, case.flow) if isinstance(case.mat, LayeredSettings | BoxSettings) else None
