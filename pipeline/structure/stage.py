"""The stage `structure`: the air between the fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.fibers import Mat
from pipeline.nouns.structure import Structure
from pipeline.nouns.surface import Surface
from pipeline.structure.settings import StructureSettings

STRUCTURE = Stage(
    name="structure",
    about="The air between the fibers: its pores, its surface, its way through.",
    make=Entry("pipeline.structure.make:make"),
    needs=needing(Surface),
    takes=needing(Mat),
    gives={Structure: "structure.json"},
    settings=StructureSettings,
    units={"mean_pore": "um", "bubble_point": "um", "mean_flow_pore": "um"},
    asked=True,
    tables=Entry("pipeline.structure.tables:tables"),
    section=Entry("pipeline.report.page.structure_section:structure"),
)
