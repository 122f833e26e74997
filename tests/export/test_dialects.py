"""What others write is read as they meant it: random meshes in random dialects, then damaged."""

# SPDX-License-Identifier: GPL-3.0-or-later

import shutil
from pathlib import Path

import numpy as np
import pytest

from pipeline.export.read import read_mesh
from pipeline.quality.judge import judge
from tests.export.dialects import DIALECTS

TRIED = 12
"""Of each format in a run of the tests; ``make fuzz`` tries as many as one likes."""


@pytest.mark.parametrize("seed", range(TRIED))
@pytest.mark.parametrize("name", DIALECTS)
def test_a_mesh_is_the_same_in_every_dialect(name: str, seed: int, tmp_path: Path) -> None:
    path, meant = DIALECTS[name](np.random.default_rng(seed), tmp_path)
    found = read_mesh(path)
    report = judge(found)
    # small fields of NASTRAN have four digits
    assert report.volume == pytest.approx(meant.volume, rel=5e-3 if name == "NASTRAN" else 1e-5)
    assert found.cells == len(meant.cells)
    assert report.patches == meant.patches
    assert report.metrics["volume"].over_limit == report.metrics["openness"].over_limit == 0
    shutil.rmtree(tmp_path)
