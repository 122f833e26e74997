"""The stage `surface`: the fibers' outside."""

# SPDX-License-Identifier: GPL-3.0-or-later

from typing import Any

from pipeline.line.stage import Entry, Stage
from pipeline.nouns.fibers import Mat
from pipeline.nouns.surface import Surface
from pipeline.nouns.surface_file import SurfaceFile
from pipeline.surface.settings import SurfaceSettings


def _needs(case: Any) -> tuple[type, ...]:
    return (SurfaceFile,) if case.mat.generator == "surface" else (Mat,)


SURFACE = Stage(
    name="surface",
    about="The fibers as a closed surface.",
    make=Entry("pipeline.surface.make:make"),
    needs=_needs,
    gives={Surface: "surface.npz"},
    settings=SurfaceSettings,
    units={"solidity": "%"},
)
