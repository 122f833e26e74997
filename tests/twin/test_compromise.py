"""The medium that goes with what was measured, by a model simple enough to know the answer."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import pytest

from pipeline.twin.compromise import Medium, nearest, values_of
from pipeline.twin.measurement import Measurement

GLASS = 2500.0
MEAN = 1e-6


def drop(medium: Medium) -> float:
    """Of a square law of solidity: no filter's, but known."""
    return 1e12 * medium.thickness * (medium.solidity / medium.scale) ** 2 * 1e-6


def measured(tolerance: float, **values: float) -> dict[str, Measurement]:
    return {
        "fiber_diameter": Measurement(MEAN, 0.03 * MEAN),
        **{name: Measurement(value, tolerance * value) for name, value in values.items()},
    }


def test_what_any_two_tell_of_a_medium_gives_the_medium_again() -> None:
    random = np.random.default_rng(0)
    for _ in range(20):
        true = Medium(math.exp(random.uniform(-3.5, -1.7)), math.exp(random.uniform(-11.5, -8.5)), 1.0)
        all_of = values_of(true, MEAN, GLASS, drop)
        names = random.permutation(["basis_weight", "solidity", "thickness", "pressure_drop"])[: random.integers(2, 5)]
        found, alone = nearest(measured(0.05, **{str(name): all_of[name] for name in names}), GLASS, drop, (0.001, 0.9))
        assert not alone
        # any two of them tell solidity and thickness
        assert found.solidity == pytest.approx(true.solidity, rel=2e-3), names
        assert found.thickness == pytest.approx(true.thickness, rel=2e-3), names
        assert found.scale == pytest.approx(1.0, rel=2e-3)


def test_a_contradiction_is_told_with_what_each_quantity_would_have_to_be() -> None:
    # 8 % of 60 um of glass weigh 12 g/m2, not 16
    found, alone = nearest(measured(0.05, solidity=0.08, thickness=6e-5, basis_weight=16e-3), GLASS, drop, (0.001, 0.9))
    # the other two are held within half of their tolerances, 2.5 %, which bring the one nearer by as much each
    assert alone["basis_weight"] == pytest.approx(12e-3 * 1.025**2, rel=1e-3)
    assert alone["solidity"] == pytest.approx(16e-3 / (GLASS * 6e-5) * 0.975 / 1.025, rel=1e-3)
    assert alone["thickness"] == pytest.approx(16e-3 / (GLASS * 0.08) * 0.975 / 1.025, rel=1e-3)
    assert "fiber_diameter" not in alone
    values = values_of(found, MEAN, GLASS, drop)
    off = [
        name for name, each in measured(0.05, solidity=0.08, thickness=6e-5).items() if abs(each.miss(values[name])) > 1
    ]
    assert len(off) <= 1


def test_a_solidity_that_fibers_do_not_reach_is_left_at_their_limit() -> None:
    found, alone = nearest(measured(0.05, solidity=0.4, thickness=2e-5), GLASS, drop, (0.01, 0.18))
    assert found.solidity == pytest.approx(0.18, rel=1e-3)
    assert found.thickness == pytest.approx(2e-5, rel=0.05)
    assert alone["solidity"] == pytest.approx(0.18, rel=1e-3)
