"""Laws that drawn numbers follow are found again, and the case file takes them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from pipeline.case import read_case
from pipeline.micrograph.case import case_of
from pipeline.micrograph.laws import DiameterLaw, OrientationLaw, diameter_laws, orientation_law
from pipeline.micrograph.measure import Interval, Measured

UM = 1e-6


def test_the_law_that_drew_the_diameters_is_the_best_one() -> None:
    random = np.random.default_rng(0)
    lognormal = diameter_laws(UM * random.lognormal(0, 0.5, 500))[0]
    assert lognormal.name == "lognormal"
    # the standard error of a mean of logarithms is 0.5 / sqrt(500) = 0.022, of its deviation 0.016
    assert lognormal.parameters["median"] == pytest.approx(UM, rel=3 * 0.022)
    assert math.log(lognormal.parameters["geometric_std"]) == pytest.approx(0.5, abs=3 * 0.016)
    normal = diameter_laws(UM * random.normal(5, 1.2, 500))[0]
    assert normal.name == "normal"


@pytest.mark.parametrize("ratio", [3.0, 5.0])
def test_two_kinds_of_fiber_are_told_apart(ratio: float) -> None:
    random = np.random.default_rng(1)
    both = np.concatenate([random.lognormal(0, 0.2, 60), ratio * random.lognormal(0, 0.2, 30)])
    law = diameter_laws(UM * both)[0]
    assert law.name == "mixture"
    # 60 and 30 fibers: standard errors of the medians are 2.6 and 3.7 %
    assert law.parameters["median_1"] == pytest.approx(UM, rel=0.08)
    assert law.parameters["median_2"] == pytest.approx(ratio * UM, rel=0.11)
    assert law.parameters["share"] == pytest.approx(2 / 3, abs=0.06)


def test_directions_without_a_preference_are_isotropic_and_others_keep_their_axis() -> None:
    random = np.random.default_rng(2)
    length = random.uniform(1, 2, 400)
    assert orientation_law(random.uniform(0, math.pi, 400), length).law == "isotropic"
    axis = math.radians(70)
    law = orientation_law((axis + 0.5 * random.vonmises(0, 2.0, 400)) % math.pi, length)
    assert law.law == "von_mises"
    assert law.axis == pytest.approx(70, abs=5)
    assert law.concentration == pytest.approx(2.0, rel=0.2)


def test_likelihoods_are_those_of_densities() -> None:
    # the criterion of a normal law, from the closed form of its likelihood
    x = np.array([1.0, 2.0, 4.0, 3.0, 2.5, 2.2])
    likelihood = -0.5 * len(x) * (1 + math.log(2 * math.pi * x.var()))
    law = next(law for law in diameter_laws(x) if law.name == "normal")
    assert law.aic == pytest.approx(4 - 2 * likelihood + 2 * 2 * 3 / 3)


@pytest.mark.parametrize(
    "law",
    [
        DiameterLaw("normal", {"mean": 1.4 * UM, "std": 0.3 * UM}, 0.0),
        DiameterLaw("lognormal", {"median": 1.4 * UM, "geometric_std": 1.3}, 0.0),
        DiameterLaw(
            "mixture",
            {"share": 0.7, "median_1": UM, "geometric_std_1": 1.2, "median_2": 4 * UM, "geometric_std_2": 1.1},
            0.0,
        ),
    ],
)
def test_the_case_of_a_picture_is_a_case_with_its_laws(law: DiameterLaw, tmp_path: Path) -> None:
    some = Interval(1.4 * UM, 1.3 * UM, 1.5 * UM)
    measured = Measured(
        np.full(3, 1.4 * UM), np.full(3, 9 * UM), np.zeros(3), (), np.zeros(0, int), some, some, some, 1.4 * UM, 0.0,
        (law,), OrientationLaw("isotropic", 0.0, 0.0, 0.0), 0.3, 0.0, 1.0, 0.0, (),
    )  # fmt: skip
    path = tmp_path / "my_filter.toml"
    path.write_text(case_of(measured, "read from a.png\nwith two lines", 'a "b"\\c.png', 25e-9), encoding="utf-8")
    case = read_case(path)
    mat = case.mat
    assert case.micrograph.file == tmp_path / 'a "b"\\c.png'
    assert case.micrograph.pixel == 25e-9
    assert mat.fiber_diameter.distribution == law.name
    turned = dataclasses.replace(measured, orientation=OrientationLaw("von_mises", 30.0, 2.0, 0.7))
    path.write_text(case_of(turned, "read from a.png", "a.png", 25e-9), encoding="utf-8")
    assert read_case(path).mat.orientation.concentration == 2.0
