"""The stage `export`: cases for solvers, files for viewers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any

from pipeline.export.formats.registry import held
from pipeline.export.formats.vtk_index import INDEX
from pipeline.export.settings import ExportSettings
from pipeline.line.stage import Entry, Stage
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.exports import OpenFoamCase
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import CellFields


def _colors(case: Any) -> tuple[type, ...]:
    return (CellFields,) if "vtk" in case.export.formats else ()


def _held(case: Any) -> tuple[type, ...]:
    return tuple(dict.fromkeys((FaceMesh, FluidDomain, *held(case.export.formats))))


EXPORT = Stage(
    name="export",
    about="The files for solvers and viewers.",
    make=Entry("pipeline.export.make:make"),
    needs=_held,
    takes=_colors,
    gives={OpenFoamCase: "openfoam"},
    settings=ExportSettings,
    reads=("flow", "enclosure", "tetmesh"),
    # the index of VTK's files names the flow, which comes later
    records=(f"vtk/{INDEX}",),
    after=Entry("pipeline.export.index:name_flow"),
)
