"""The stage `solve`: the flow."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any

from pipeline.line.stage import Entry, Stage
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.exports import OpenFoamCase
from pipeline.nouns.flow import Settling, Solution, SolvingCost
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.surface import Surface
from pipeline.solve.settings import SolveSettings


def _needs(case: Any) -> tuple[type, ...]:
    if case.solve.engine == "openfoam":
        return Surface, OpenFoamCase, Comparison
    return Surface, FluidDomain, FaceMesh, Comparison


SOLVE = Stage(
    name="solve",
    about="The run of the solver.",
    make=Entry("pipeline.solve.make:make"),
    needs=_needs,
    gives={
        Solution: "solution.json",
        FlowField: "flow.npz",
        SolvingCost: "cost.json",
        Settling: "settling.json",
    },
    settings=SolveSettings,
    reads=("flow", "mat", "enclosure", "tetmesh"),
    records=("cost.json", "settling.json", "log.*", "*/log.*", "*/fibertwin.*"),
    units={"pressure_drop": "Pa", "force_balance_error": "%"},
    obstacle=Entry("pipeline.solve.make:obstacle"),
    asked=True,
    tables=Entry("pipeline.solve.tables:tables"),
    section=Entry("pipeline.report.page.flow_sections:solution"),
)
