"""A solution carries what is known of its error: its mesh's and, where a seed drew the mat, another seed's."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from pipeline.analytics.measured_errors import mesh_error, seed_spread
from pipeline.case import read_case
from pipeline.cli.bundled import found
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.flow import Solution, SolvingCost
from pipeline.nouns.surface import Surface
from pipeline.solve.make import with_known_errors
from pipeline.solve.tables import solution_table

SOLVED = Solution(7.5, 1e-8, 1e-9, 1e-12, 0.0, 0.0, 30, True, engine="stokes")


def results(case: str, *overrides: str) -> Any:
    """What the stage reads, of a plan of 20 um and fibers of 1.4 um."""
    nouns = {
        Comparison: SimpleNamespace(fiber_diameter=1.4e-6),
        Surface: SimpleNamespace(slab=SimpleNamespace(face_area=400e-12)),
    }
    return SimpleNamespace(case=read_case(found(Path(case)), overrides), read=nouns.__getitem__)


def test_the_default_case_knows_its_mesh_and_its_seeds() -> None:
    solution = with_known_errors(SOLVED, results("default"))
    known = mesh_error("tetwild", "stokes", 0.6)
    assert known is not None
    assert solution.mesh_error == (known.mean, known.low, known.high)
    assert solution.seed_spread == pytest.approx(seed_spread((20.0 / 1.4) ** 2))
    shown = {row[0]: row[1] for row in solution_table(solution, SolvingCost(1.0, 1)).rows}
    assert shown["this mesh"].startswith(f"{100.0 * known.mean:+.1f} %")
    assert "±" in shown["another seed"]


def test_an_edge_that_was_not_measured_and_a_mat_that_no_seed_draws_have_none() -> None:
    solution = with_known_errors(SOLVED, results("default", "tetmesh.edge=0.1"))
    assert solution.mesh_error is None
    assert solution.seed_spread is not None
    array = with_known_errors(SOLVED, results("cases/verification/square.toml"))
    assert array.seed_spread is None
