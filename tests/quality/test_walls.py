"""The verdict knows the fibers: good cells around missing fibers are no good mesh."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace

import pytest

from pipeline.nouns.fidelity import FiberWalls, Fidelity
from pipeline.quality.judge import judge
from pipeline.quality.table import summary
from pipeline.quality.walls import with_walls
from tests.sample_meshes import duct

# a mesh of sound cells
REPORT = replace(judge(duct(jitter=0.1).face_mesh()), verdict="pass", reasons=())


def walls(number: int, **other: float) -> FiberWalls:
    sound = {"diameter": 1e-6, "area": 9.0, "mean_deviation": 0.01, "typical_deviation": 0.05, "radius_error": 0.0}
    return FiberWalls(number, **{**sound, "in_air": 0.0, **other})


def fidelity(*fibers: FiberWalls) -> Fidelity:
    return Fidelity(0.01, 0.05, 0.2, fibers)


def test_fibers_in_their_places_leave_the_verdict_of_the_cells() -> None:
    judged = with_walls(REPORT, fidelity(walls(0), walls(1)), 0.5)
    assert (judged.verdict, judged.reasons, judged.fibers) == (REPORT.verdict, REPORT.reasons, 2)
    assert judged.metrics["wall_deviation"].max == 0.05
    assert "2 fibers stand where they should" in summary(judged)
    assert "fibers" not in summary(REPORT)


@pytest.mark.parametrize(
    ("fault", "word"),
    [({"in_air": 0.4}, "40% of its axis"), ({"typical_deviation": 0.7}, "0.7 of its diameters"),
     ({"radius_error": 0.245}, "radius is off by +2")],
)  # fmt: skip
def test_one_fiber_that_is_lost_or_off_fails_the_mesh_by_its_number(fault: dict[str, float], word: str) -> None:
    judged = with_walls(REPORT, fidelity(walls(0), walls(1, **fault), walls(2)), 0.5)
    assert judged.verdict == "fail"
    assert not judged.passed
    assert "fiber 1 of 3" in judged.reasons[0]
    assert word in judged.reasons[0]


def test_a_fiber_without_walls_is_no_value_of_the_metric() -> None:
    # it lies within others: there is nothing to measure
    judged = with_walls(REPORT, fidelity(walls(0), walls(1, area=0.0, typical_deviation=0.0)), 0.5)
    assert judged.metrics["wall_deviation"].min == 0.05
