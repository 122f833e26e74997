"""The stage `mat`: the fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pipeline.line.stage import Entry, Stage
from pipeline.mat.settings import FileSettings, MatSettings, SurfaceFileSettings
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mat_measures import MatMeasures
from pipeline.nouns.surface_file import SurfaceFile


def _file(case: Any) -> Iterable[Path]:
    return (case.mat.file,) if isinstance(case.mat, FileSettings | SurfaceFileSettings) else ()


MAT = Stage(
    name="mat",
    about="The fiber mat: how it is drawn and when it is complete.",
    make=Entry("pipeline.mat.make:make"),
    gives={Mat: "mat.npz", MatMeasures: "measures.json", SurfaceFile: "surface_file.json"},
    settings=MatSettings,
    required=True,
    reads=("flow",),
    sources=_file,
    units={"solidity": "%", "thickness": "um", "pressure_drop": "Pa", "efficiency": "%"},
    section=Entry("pipeline.report.page.sections:mat"),
)
