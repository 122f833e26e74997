"""Every bundled case goes through the whole line, with few fibers on a coarse mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import pytest

from pipeline.case import read_case
from pipeline.line.run import Run, run
from pipeline.mat.settings import BoxSettings, LayeredSettings
from pipeline.nouns.quality import QualityReport

CASES = Path(__file__).parent.parent / "cases"
COARSE = ("tetmesh.edge=0.9", "tetmesh.growth=0.6", "surface.sides=8")


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_a_bundled_case_runs_whole(path: Path, tmp_path: Path) -> None:
    case = read_case(path, COARSE)
    if isinstance(case.mat, LayeredSettings | BoxSettings):
        case = read_case(path, (*COARSE, "mat.stop.count=6"))
    run(case, tmp_path, until="compare")
    assert Run(case, tmp_path).read(QualityReport).verdict in ("pass", "warn")
