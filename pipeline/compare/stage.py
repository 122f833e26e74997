"""The stage `compare`: pressure drops by analytical models."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.surface import Surface

COMPARE = Stage(
    name="compare",
    about="Pressure drops by analytical models.",
    make=Entry("pipeline.compare.make:make"),
    needs=needing(Mat, Surface, FaceMesh),
    gives={Comparison: "comparison.json"},
    reads=("flow",),
    units={"mesh_solidity": "%"},
    tables=Entry("pipeline.compare.tables:tables"),
    section=Entry("pipeline.report.page.flow_sections:comparison"),
)
