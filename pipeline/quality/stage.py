"""The stage `quality`: what the mesh is like."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.nouns.quality import CellFields, QualityReport
from pipeline.quality.settings import QualitySettings

QUALITY = Stage(
    name="quality",
    about="The limits a good mesh keeps to.",
    make=Entry("pipeline.quality.make:make"),
    needs=needing(FaceMesh, TetmeshMeasures),
    gives={QualityReport: "quality.json", CellFields: "fields.npz"},
    settings=QualitySettings,
    reads=("tetmesh",),
    units={"max_non_orthogonality": "deg"},
    tables=Entry("pipeline.quality.table:tables"),
    section=Entry("pipeline.report.page.quality_section:section"),
)
