"""Whole mats against the statistics of the method (mean and spread over 200 seeds)."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import pytest

from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.mat.settings import ArraySettings, LayeredSettings, Stop


def figure_10(seed: int = 0, **changes: object) -> LayeredSettings:
    """The mat of the paper's Fig. 10."""
    asked: dict[str, object] = {
        "side": 100e-6,
        "fiber_diameter": 1.4e-6,
        "relaxation_slope": 0.15,
        "stop": Stop(coverage=4),
        "seed": seed,
    }
    return LayeredSettings.model_validate(asked | changes)


def agrees(values: list[float], mean: float, spread: float) -> bool:
    """Whether the mean over K seeds lies within 4 standard errors of the mean over 200."""
    return abs(float(np.mean(values)) - mean) <= 4 * spread * math.sqrt(1 / len(values) + 1 / 200)


def test_mats_of_figure_10_have_the_papers_statistics() -> None:
    mats = [measure(generate(figure_10(seed))) for seed in range(30)]
    assert agrees([m.fibers for m in mats], 329.4, 5.9)
    assert agrees([m.segments for m in mats], 3372, 127)
    assert agrees([m.thickness * 1e6 for m in mats], 46.40, 2.35)
    assert agrees([m.solidity * 100 for m in mats], 9.62, 0.48)
    # the last fiber's coverage is at most sqrt(2) d / L
    assert all(4 <= m.coverage <= 4 + math.sqrt(2) * 0.014 for m in mats)


def test_fibers_end_exactly_on_the_sides_of_the_plan() -> None:
    mat = generate(figure_10())
    ends = mat.nodes[np.concatenate([mat.first[:-1], mat.first[1:] - 1]), :2]
    assert np.isin(ends, [0.0, mat.slab.upper[0]]).any(axis=1).all()
    assert (mat.nodes[:, :2] >= 0).all()
    assert (mat.nodes[:, :2] <= mat.slab.upper[0]).all()


def test_the_slab_reaches_from_the_ground_to_the_highest_fiber() -> None:
    mat = generate(figure_10())
    assert mat.nodes[:, 2].min() == 0.7e-6
    assert mat.thickness == mat.nodes[:, 2].max() + 0.7e-6


def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_mat() -> None:
    one, again, other = (generate(figure_10(seed)) for seed in (3, 3, 4))
    assert one.nodes.tobytes() == again.nodes.tobytes()
    assert one.first.tobytes() == again.first.tobytes()
    assert one.nodes.tobytes() != other.nodes.tobytes()


@pytest.mark.parametrize("arrangement", ["square", "hexagonal"])
@pytest.mark.parametrize("rows", [1, 2, 3])
def test_an_array_has_exactly_the_solidity_asked_for(arrangement: str, rows: int) -> None:
    # the fibers in the side planes of the hexagonal array count half
    settings = ArraySettings.model_validate(
        {"arrangement": arrangement, "solidity": 0.1, "fiber_diameter": 1e-6, "rows": rows}
    )
    assert measure(generate(settings)).solidity == pytest.approx(0.1, rel=1e-12)


def test_the_neighbors_in_a_hexagonal_array_are_all_one_pitch_away() -> None:
    mat = generate(ArraySettings(arrangement="hexagonal", solidity=0.1, fiber_diameter=1e-6, rows=2))
    left, right, above = mat.nodes[::2]
    assert math.dist(left, right) == pytest.approx(math.dist(left, above), rel=1e-12)
