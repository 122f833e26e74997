# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import pytest
from scipy import stats

from pipeline.study.summary import estimate


def test_the_interval_is_students() -> None:
    values = [9.1, 10.4, 8.7, 11.0, 10.2]
    low, high = stats.t.interval(0.95, len(values) - 1, np.mean(values), stats.sem(values))
    found = estimate(values)
    assert found.mean - found.half_width == pytest.approx(low, rel=1e-12)
    assert found.mean + found.half_width == pytest.approx(high, rel=1e-12)


def test_the_interval_holds_the_truth_in_95_of_100_samples() -> None:
    rng = np.random.default_rng(1)
    samples = [estimate(sample) for sample in rng.normal(3.0, 2.0, (4000, 5)).tolist()]
    held = np.mean([abs(each.mean - 3.0) <= each.half_width for each in samples])
    # 4 standard deviations of a share of 4000
    assert held == pytest.approx(0.95, abs=4 * math.sqrt(0.95 * 0.05 / 4000))


def test_one_run_has_a_mean_but_no_interval() -> None:
    found = estimate([2.0, math.nan])
    assert (found.n, found.mean) == (1, 2.0)
    assert math.isnan(found.half_width)


def test_no_run_has_no_mean() -> None:
    assert math.isnan(estimate([math.nan]).mean)
