"""The stage `export`: cases for solvers, files for viewers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any

from pipeline.export.settings import ExportSettings
from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.exports import OpenFoamCase
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import CellFields


def _colors(case: Any) -> tuple[type, ...]:
    return (CellFields,) if "vtk" in case.export.formats else ()


EXPORT = Stage(
    name="export",
    about="The files for solvers and viewers.",
    make=Entry("pipeline.export.make:make"),
    needs=needing(FaceMesh, FluidDomain),
    takes=_colors,
    gives={OpenFoamCase: "openfoam"},
    settings=ExportSettings,
    reads=("flow", "enclosure"),
)
