"""Fibers from what was measured of a picture."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.case import validate_as
from pipeline.errors import CaseError
from pipeline.mat.settings import Constant, Lognormal, Mixture, Normal, Part, Uniform
from pipeline.twin.fibers import FiberLaws, fibers_of, scaled
from pipeline.twin.settings import MeasuredFilter

UM = 1e-6
TOLD: dict[str, Any] = {
    "fibers": 120,
    "diameter": {
        "mean": 1.04e-6,
        "mean_interval": [0.98e-6, 1.1e-6],
        "length_weighted": {"mean": 1.1e-6, "std": 0.3e-6},
        "laws": [{"name": "lognormal", "aic": 3.0, "median": 1e-6, "geometric_std": 1.3}],
    },
    "orientation": {"law": "von_mises", "axis": 20.0, "concentration": 2.0, "order": 0.7},
    "picture": "web.png",
    "pixel": 25e-9,
}


def laws_of(path: Path, content: Any) -> FiberLaws:
    path.write_text(json.dumps(content), encoding="utf-8")
    return fibers_of(
        validate_as(MeasuredFilter, {"micrograph": str(path), "solidity": 0.08, "thickness": "60 um"}, "test")
    )


def told_of(path: Path, content: Any) -> FiberLaws | str:
    try:
        return laws_of(path, content)
    except CaseError as problem:
        return str(problem)


def test_what_measure_tells_is_taken_over(tmp_path: Path) -> None:
    laws = laws_of(tmp_path / "web.json", TOLD)
    assert laws.diameters == Lognormal(median=UM, geometric_std=1.3)
    assert laws.directions.law == "von_mises"
    assert laws.mean.value == 1.04e-6
    # the wider half of the interval
    assert laws.mean.tolerance == pytest.approx(0.06e-6, rel=1e-9)


def test_a_json_of_anything_else_is_told(tmp_path: Path) -> None:
    random = np.random.default_rng(3)
    refused = 0
    for _ in range(300):
        broken = json.loads(json.dumps(TOLD))
        at: Any = broken
        while True:
            keys = list(at) if isinstance(at, dict) else list(range(len(at)))
            key = keys[random.integers(len(keys))]
            if isinstance(at[key], dict | list) and at[key] and random.random() < 0.8:
                at = at[key]
                continue
            at[key] = [None, "x", -1.0, [], {}, 1e400, True][random.integers(7)]
            break
        told = told_of(tmp_path / "web.json", broken)
        if isinstance(told, str):
            refused += 1
            assert "measure --json" in told
            assert "\n" not in told
        else:
            assert 0 < told.side < np.inf
    assert refused > 150


def test_a_law_of_fibers_twice_as_thick_has_twice_the_mean() -> None:
    # mixtures of all laws, with bounds or without
    random = np.random.default_rng(1)
    plain: list[Constant | Uniform | Normal | Lognormal] = [
        Constant(diameter=UM),
        Uniform(min=UM, max=3 * UM),
        Normal(mean=2 * UM, std=0.3 * UM, max=4 * UM),
        Lognormal(median=UM, geometric_std=1.4, min=0.3 * UM),
    ]
    mixed = Mixture(parts=tuple(Part(weight=random.uniform(0.1, 1), diameter=each) for each in plain))
    for law in (*plain, mixed):
        twice = scaled(law, 2.0)
        assert twice.mean == pytest.approx(2.0 * law.mean, rel=1e-12)
        assert type(law).model_validate(twice.model_dump()) == twice
