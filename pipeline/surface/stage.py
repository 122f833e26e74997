"""The stage `surface`: the fibers' outside."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pipeline.line.stage import Entry, Stage, needing
from pipeline.nouns.fibers import Mat
from pipeline.nouns.surface import Surface
from pipeline.surface.settings import SurfaceSettings

SURFACE = Stage(
    name="surface",
    about="The fibers as a closed surface.",
    make=Entry("pipeline.surface.make:make"),
    needs=needing(Mat),
    gives={Surface: "surface.npz"},
    settings=SurfaceSettings,
    units={"solidity": "%"},
)
