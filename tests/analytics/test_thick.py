"""A thick medium from a solved slab: exact for what is even along the flow, and wide where it is not."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from pipeline.analytics.models.thick import Slab, slab_of, thicken
from pipeline.errors import CaseError
from pipeline.geometry.box import Box
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from tests.cli.conftest import Fibertwin
from tests.cli.conftest import fibertwin as fibertwin  # the fixture
from tests.report.contents import CAPTURE, SOLUTION

SIDE, PITCH = 10e-6, 2e-6
STAIRS = 0.02
"""Pressure falls in steps from row to row: a slope through fourteen of them is good to about 1 / 14^2, and more."""


def rows(heights: list[float], thickness: float, drag: float = 1e-9) -> tuple[Mat, Solution]:
    """One fiber across the plan at each height, all with one drag."""
    nodes = [[x, 0.5 * SIDE, z] for z in heights for x in (0.0, SIDE)]
    count = len(heights)
    mat = Mat(
        np.array(nodes),
        2 * np.arange(count + 1),
        np.full(count, 0.5e-6),
        Box((0, 0, 0), (SIDE, SIDE, thickness)),
        -1,
        "",
    )
    drop = count * drag / SIDE**2
    return mat, dataclasses.replace(SOLUTION, pressure_drop=drop, drag_per_fiber=(drag,) * count)


def even(count: int) -> tuple[Mat, Solution]:
    return rows([(k + 0.5) * PITCH for k in range(count)], count * PITCH)


def test_a_slab_of_equal_rows_scales_by_its_rows() -> None:
    slab = slab_of(*even(20))
    # every row of pitch 2 um takes 1 nN over (10 um)^2, 10 Pa
    assert slab.gradient == pytest.approx(10.0 / PITCH, rel=STAIRS)
    assert slab.solid_ratio == pytest.approx(1.0, rel=STAIRS)
    found = thicken([slab], 100 * PITCH, 0.025)
    assert found.pressure_drop == pytest.approx(1000.0, rel=STAIRS)
    # equal layers, equal ends: what is left of the interval is that layers are not cut between rows
    assert found.high - found.low < 0.1 * found.pressure_drop


def test_thin_ends_stay_ends_and_widen_the_interval() -> None:
    # twenty even rows, and a row by itself far out on either side
    inside = [10e-6 + (k + 0.5) * PITCH for k in range(20)]
    slab = slab_of(*rows([1e-6, *inside, 59e-6], 60e-6))
    assert slab.gradient == pytest.approx(10.0 / PITCH, rel=STAIRS)
    thick = thicken([slab], 60e-6 + 100 * PITCH, 0.025)
    assert thick.pressure_drop == pytest.approx(220.0 + 1000.0, rel=STAIRS)
    assert thick.by_proportion == pytest.approx(220.0 * thick.thickness / 60e-6)
    # the interval reaches as far as the plain proportion
    assert thick.low <= thick.by_proportion * (1 + 1e-9)


def test_a_medium_as_thick_as_the_slab_is_the_slab() -> None:
    slab = slab_of(*even(20))
    same = thicken([slab], slab.thickness, 0.025, capture=CAPTURE)
    assert same.pressure_drop == pytest.approx(slab.pressure_drop)
    assert same.penetration == pytest.approx(CAPTURE.penetration)
    # twice the fibers pass the square of it
    twice = thicken([slab], 2 * slab.thickness, 0.025, capture=CAPTURE)
    assert twice.penetration == pytest.approx([each**2 for each in CAPTURE.penetration], rel=STAIRS)


def test_the_drop_grows_with_the_velocity_and_particles_are_not_told_at_another() -> None:
    slab = slab_of(*even(20))
    fast = thicken([slab], 100 * PITCH, 0.05, 2.0, CAPTURE)
    assert fast.pressure_drop == pytest.approx(2000.0, rel=STAIRS)
    assert fast.penetration == ()


def test_several_slabs_tell_their_scatter_and_few_take_what_is_known_of_seeds() -> None:
    def slab(drop: float, **known: float) -> Slab:
        return Slab(10e-6, drop, drop / 10e-6, (1e-6, 9e-6), 1.0, (), seed_spread=known.get("spread"))

    many = thicken([slab(drop) for drop in (9.0, 10.0, 11.0)], 100e-6, 0.025)
    # Student's 4.303 for three, times the standard deviation 1 of 10, over the root of 3
    assert (many.high - many.low) / 2 / many.pressure_drop == pytest.approx(4.3027 * 0.1 / np.sqrt(3), rel=1e-4)
    one = thicken([slab(10.0, spread=0.1)], 100e-6, 0.025)
    assert (one.high - one.low) / 2 / one.pressure_drop == pytest.approx(0.2)


def test_what_cannot_be_scaled_is_refused() -> None:
    mat, solution = even(20)
    with pytest.raises(CaseError, match="no drag per fiber"):
        slab_of(mat, dataclasses.replace(solution, drag_per_fiber=()))
    with pytest.raises(CaseError, match="less than the slab's 40 um"):
        thicken([slab_of(mat, solution)], 30e-6, 0.025)


def test_the_command_refuses_what_would_change_the_slab(fibertwin: Fibertwin, tmp_path: Path) -> None:
    for words, said in (
        (("--from", tmp_path), "--from needs the thickness"),
        (("--from", tmp_path, "--thickness", "1 mm", "--solidity", "5 %"), "--solidity would change it"),
        (("smoke", "--from", tmp_path, "--thickness", "1 mm"), "takes the place of a case"),
    ):
        answer = fibertwin("predict", *words)
        assert answer.code == 2
        assert said in answer.err
    assert fibertwin("predict", "--from", tmp_path, "--thickness", "1 mm").code == 1


def test_the_json_of_a_thick_medium_has_no_infinities() -> None:
    found = thicken([slab_of(*even(20))], 1e-3, 0.025, capture=CAPTURE)
    assert json.loads(json.dumps(dataclasses.asdict(found), allow_nan=False))["slabs"] == 1
