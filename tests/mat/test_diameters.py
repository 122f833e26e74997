"""Drawn diameters against the moments of their distributions."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError
from scipy import stats

from pipeline.geometry.triangles import Floats
from pipeline.mat.diameters import draw_diameters
from pipeline.mat.settings import Diameters

N = 50_000


def drawn(settings: Any) -> Floats:
    return draw_diameters(TypeAdapter(Diameters).validate_python(settings), N, np.random.default_rng(7))


def test_uniform_diameters_fill_their_range() -> None:
    sample = drawn({"distribution": "uniform", "min": 2e-6, "max": 3e-6})
    assert stats.kstest(sample, stats.uniform(2e-6, 1e-6).cdf).pvalue > 1e-3


def test_normal_diameters_are_truncated_not_clipped() -> None:
    # at a tenth of the mean unless told otherwise
    sample = drawn({"distribution": "normal", "mean": 1e-6, "std": 0.5e-6})
    assert sample.min() >= 0.1e-6
    assert stats.kstest(sample, stats.truncnorm(-1.8, np.inf, 1e-6, 0.5e-6).cdf).pvalue > 1e-3


def test_lognormal_diameters_have_their_median_and_geometric_deviation() -> None:
    sample = np.log(drawn({"distribution": "lognormal", "median": 1e-6, "geometric_std": 1.6}))
    assert stats.kstest(sample, stats.norm(math.log(1e-6), math.log(1.6)).cdf).pvalue > 1e-3


def test_bounds_of_a_lognormal_are_kept() -> None:
    sample = drawn({"distribution": "lognormal", "median": 1e-6, "geometric_std": 2, "min": 0.8e-6, "max": 1.5e-6})
    assert 0.8e-6 <= sample.min() < sample.max() <= 1.5e-6


def test_the_mixture_of_figure_3c_has_both_its_kinds() -> None:
    sample = drawn(
        {
            "distribution": "mixture",
            "parts": [
                {"weight": 75, "diameter": {"distribution": "uniform", "min": 200e-9, "max": 600e-9}},
                {"weight": 25, "diameter": {"distribution": "uniform", "min": 2.0e-6, "max": 3.5e-6}},
            ],
        }
    )
    fine = sample < 1e-6
    assert fine.mean() == pytest.approx(0.75, abs=4 * math.sqrt(0.75 * 0.25 / N))
    assert sample[fine].mean() == pytest.approx(400e-9, rel=0.01)
    assert sample[~fine].mean() == pytest.approx(2.75e-6, rel=0.01)
    assert sample[~fine].min() >= 2.0e-6


@pytest.mark.parametrize(
    "settings",
    [
        1.4e-6,
        {"distribution": "uniform", "min": 1e-6, "max": 3e-6},
        {"distribution": "normal", "mean": 1e-6, "std": 0.3e-6, "max": 1.4e-6},
        {"distribution": "lognormal", "median": 1e-6, "geometric_std": 1.8, "min": 0.4e-6},
        {"distribution": "mixture", "parts": [{"weight": 3, "diameter": "1 um"}, {"weight": 1, "diameter": "4 um"}]},
    ],
)
def test_moments_are_those_of_the_draws(settings: Any) -> None:
    known = TypeAdapter(Diameters).validate_python(settings)
    sample = drawn(settings)
    for power in (-1, 1, 2, 3):
        powers = sample**power
        # four standard errors of the mean of the draws, and rounding where all are alike
        off = 4.0 * powers.std() / math.sqrt(N) + 1e-9 * powers.mean()
        assert known.moment(power) == pytest.approx(powers.mean(), abs=off)


def test_the_mean_that_a_distribution_states_is_the_mean_of_its_draws() -> None:
    for settings in (
        1.4e-6,
        {"distribution": "uniform", "min": 2e-6, "max": 3e-6},
        {"distribution": "normal", "mean": 1e-6, "std": 0.1e-6},
        {"distribution": "lognormal", "median": 1e-6, "geometric_std": 1.6},
    ):
        stated = TypeAdapter(Diameters).validate_python(settings).mean
        assert drawn(settings).mean() == pytest.approx(stated, rel=0.01)


@pytest.mark.parametrize(
    ("settings", "reason"),
    [
        ({"distribution": "uniform", "min": 3e-6, "max": 2e-6}, "must exceed min"),
        ({"distribution": "normal", "mean": 1e-6, "std": 0.01e-6, "min": 2e-6}, "less than 1 %"),
        ({"distribution": "lognormal", "median": 1e-6, "geometric_std": 1.0}, "greater than 1"),
        ({"distribution": "weibull"}, "must be one of"),
        ({"distribution": "mixture", "parts": [{"weight": 1, "diameter": 1e-6}]}, "two or more"),
        (-1e-6, "greater than 0"),
    ],
)
def test_impossible_distributions_are_refused(settings: Any, reason: str) -> None:
    with pytest.raises(ValidationError, match=reason):
        TypeAdapter(Diameters).validate_python(settings)
