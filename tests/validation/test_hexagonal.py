"""What a user reads of the bundled hexagonal array: half of its fibers lie in a side and count by half."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import pytest

from pipeline.case import read_case
from pipeline.line.run import Run, run
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.flow import Solution

CASE = Path(__file__).parents[2] / "cases" / "verification" / "hexagonal.toml"


def test_the_hexagonal_array_has_its_solidity_and_its_drag(tmp_path: Path) -> None:
    content = read_case(CASE, ("tetmesh.edge=0.4",)).content()
    content["tetmesh"] = {"engine": "lattice", "edge": 0.4, "growth": 0.4, "largest_edge": 1.0}
    case = type(read_case(CASE)).model_validate(content)
    run(case, tmp_path, until="solve", without=frozenset({"quality", "export", "report"}))
    results = Run(case, tmp_path)
    assert results.read(Comparison).solidity["nominal"] == pytest.approx(0.1, rel=1e-12)
    # 25.13 in the endless array; the first and the last of three rows feel the plenums. Fibers in a side that count
    # whole gave 14.3
    assert results.read(Solution).f_star == pytest.approx(24.6, rel=0.02)
