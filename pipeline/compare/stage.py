"""The stage `compare`: pressure drops by analytical models."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any

from pipeline.line.stage import Entry, Stage
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.surface import Surface


def _needs(case: Any) -> tuple[type, ...]:
    # a medium that is there as a surface has no axes
    return (Surface, FaceMesh) if case.mat.generator == "surface" else (Mat, Surface, FaceMesh)


COMPARE = Stage(
    name="compare",
    about="Pressure drops by analytical models.",
    make=Entry("pipeline.compare.make:make"),
    needs=_needs,
    gives={Comparison: "comparison.json"},
    reads=("flow",),
    units={"mesh_solidity": "%"},
    tables=Entry("pipeline.compare.tables:tables"),
    section=Entry("pipeline.report.page.flow_sections:comparison"),
)
