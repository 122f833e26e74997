"""Random numbers by counting, intervals, and the most penetrating size."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.capture.intervals import share_interval
from pipeline.capture.random_numbers import uniforms
from pipeline.capture.size_curve import most_penetrating_size


def test_streams_are_uniform_and_independent_of_each_other() -> None:
    numbers = uniforms(1, 0, 0, 2000, 50, 0)
    # 100,000 numbers: mean and correlations scatter by 1/sqrt(n) of their spread; six of those
    assert numbers.mean() == pytest.approx(0.5, abs=6 * 0.2887 / 316)
    assert numbers.var() == pytest.approx(1 / 12, rel=6 * 0.9 / 316)
    for one, other in ((numbers[1:], numbers[:-1]), (numbers[:, 1:], numbers[:, :-1])):
        assert np.corrcoef(one.ravel(), other.ravel())[0, 1] == pytest.approx(0, abs=6 / 310)
    assert len(np.unique(numbers)) == numbers.size
    assert np.array_equal(uniforms(1, 0, 7, 1, 3, 5)[0], numbers[7, 5:8])
    assert not np.isin(uniforms(1, 1, 0, 100, 50, 0), numbers).any()


@pytest.mark.parametrize("share", [0.01, 0.5, 0.97])
def test_intervals_hold_the_truth_in_nineteen_of_twenty_experiments_or_more(share: float) -> None:
    hits = np.random.default_rng(1).binomial(200, share, 400)
    held = [low <= share <= high for low, high in (share_interval(int(k), 200) for k in hits)]
    # exact intervals hold it in 95 % at least; four deviations of 400 draws below that
    assert np.mean(held) > 0.95 - 4 * 0.011


def test_the_worst_size_of_a_parabola_is_found_between_the_sizes_and_its_interval_holds_it() -> None:
    worst, particles = 210e-9, 20_000
    sizes = np.geomspace(30e-9, 3e-6, 7)
    depth = 0.5 + 0.4 * np.log(sizes / worst) ** 2
    caught = np.round(particles * -np.expm1(-depth)).astype(int)
    found = most_penetrating_size(sizes, caught, np.full(7, particles), 1)
    assert found.inside
    assert found.diameter == pytest.approx(worst, rel=2e-3)
    assert found.low < worst < found.high
    assert found.penetration == pytest.approx(np.exp(-0.5), rel=1e-3)


def test_efficiency_that_rises_with_size_has_its_worst_size_at_the_end() -> None:
    found = most_penetrating_size(np.array([1e-7, 1e-6]), np.array([100, 900]), np.full(2, 1000), 1)
    assert found.diameter == pytest.approx(1e-7)
    assert not found.inside
