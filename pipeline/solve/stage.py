"""The stage `solve`: the flow."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.exports import OpenFoamCase
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.solve.settings import SolveSettings

SOLVE = Stage(
    name="solve",
    about="The run of the solver.",
    make=Entry("pipeline.solve.make:make"),
    needs=needing(Mat, OpenFoamCase, Comparison),
    gives={Solution: "solution.json"},
    settings=SolveSettings,
    reads=("flow", "mat"),
    records=("log.*", "*/log.*"),
    units={"pressure_drop": "Pa", "force_balance_error": "%"},
    obstacle=Entry("pipeline.solve.make:obstacle"),
    asked=True,
    tables=Entry("pipeline.solve.tables:tables"),
    section=Entry("pipeline.report.page.flow_sections:solution"),
)
