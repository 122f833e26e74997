"""What counts as a mesh that does not keep its fibers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import pytest

from pipeline.nouns.fidelity import NEAREST, FiberWalls, Fidelity


def walls(largest: float) -> Fidelity:
    """One fiber whose walls are true, beside a wall somewhere else."""
    return Fidelity(0.01, 0.04, largest, (FiberWalls(0, 1e-6, 10.0, 0.01, 0.04, 0.0, 0.0),))


@pytest.mark.parametrize(("largest", "deviation", "told"), [
    (0.4, 0.5, False),
    # a rim between crossing fibers stands less than a diameter off both
    (1.2, 0.5, False),
    # a dent in a plane of the duct takes a thousandth of the walls, and moved a drag by 4 %
    (NEAREST, 0.5, True),
    (NEAREST, 2.0, False),
    (2.5, 2.0, True),
])  # fmt: skip
def test_walls_far_from_every_fiber_are_a_fault_however_few(largest: float, deviation: float, told: bool) -> None:
    assert bool(walls(largest).faults(deviation)) == told
