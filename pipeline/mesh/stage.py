"""The stage `tetmesh`: the air in cells."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.line.stage import Entry, Stage, needing
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import MeshingCost, TetmeshMeasures

TETMESH = Stage(
    name="tetmesh",
    about="The air in tetrahedra.",
    make=Entry("pipeline.mesh.make:make"),
    needs=needing(FluidDomain),
    gives={FaceMesh: "mesh.npz", TetmeshMeasures: "measures.json", MeshingCost: "cost.json"},
    settings=TetmeshSettings,
    records=("cost.json", "*.log", "log.*"),
    units={"volume_error": "%"},
    obstacle=Entry("pipeline.mesh.make:obstacle"),
    estimate=Entry("pipeline.mesh.estimate:estimate"),
    section=Entry("pipeline.report.page.sections:mesh"),
)
