"""`fibertwin solve` on a run that is there; minutes, for the mesh and the solver."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Fibertwin


@pytest.mark.slow
@pytest.mark.openfoam
def test_a_run_is_solved_and_a_solution_that_had_not_settled_is_continued(fibertwin: Fibertwin, tmp_path: Path) -> None:
    assert fibertwin("run", "smoke", "--until", "compare", "--out", tmp_path, "--quiet").code == 0
    first = json.loads(
        fibertwin(
            "solve", tmp_path, "--set", "solve.engine=openfoam", "--set", "solve.openfoam.max_iterations=20", "--json"
        ).out
    )
    assert first["converged"] is False
    second = fibertwin(
        "solve", tmp_path, "--set", "solve.engine=openfoam", "--set", "solve.openfoam.max_iterations=500", "--json"
    )
    solution = json.loads(second.out)
    assert second.code == 0
    assert solution["converged"]
    # the sides are symmetry planes: nothing but the fibers holds the air back
    assert abs(solution["force_balance_error"]) < 5e-3
