"""The stage `enclosure`: the mat in its duct."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.enclosure.settings import EnclosureSettings
from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.surface import Surface

ENCLOSURE = Stage(
    name="enclosure",
    about="The duct around the mat.",
    make=Entry("pipeline.enclosure.make:make"),
    needs=needing(Surface),
    gives={FluidDomain: "domain.npz"},
    settings=EnclosureSettings,
    units={"fluid_volume": "um3"},
    section=Entry("pipeline.report.page.sections:duct"),
)
