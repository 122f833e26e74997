"""The stage `micrograph`: the mat as a microscope would show it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pipeline.line.stage import Entry, Stage, needing
from pipeline.microscope.settings import MicrographSettings
from pipeline.nouns.fibers import Mat
from pipeline.nouns.micrographs import Micrographs


def _file(case: Any) -> Iterable[Path]:
    return () if case.micrograph.file is None else (case.micrograph.file,)


MICROGRAPH = Stage(
    name="micrograph",
    about="The mat as a microscope would show it, beside a picture of the real medium.",
    make=Entry("pipeline.microscope.make:make"),
    needs=needing(Mat),
    gives={Micrographs: "micrographs.json"},
    settings=MicrographSettings,
    sources=_file,
    units={"pixel": "nm", "width": "um", "height": "um"},
    obstacle=Entry("pipeline.microscope.make:obstacle"),
    asked=True,
    section=Entry("pipeline.report.page.micrograph_section:micrograph"),
)
