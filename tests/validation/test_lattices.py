"""Lattices of fibers as files, whose solidity is the one asked for."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from pathlib import Path

import numpy as np
import pytest

from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.nouns.flow_field import FlowField
from pipeline.solve.stokes.nodes import number_nodes
from validation.closed_flows import brick
from validation.lattices import EXACT, LatticeRung, fibers, lattice_case, mean_pressure, pitch
from validation.tables import lattice_table


@pytest.mark.parametrize(("lattice", "solidity"), [(name, share) for name, shares in EXACT.items() for share in shares])
def test_a_lattice_has_the_solidity_that_was_asked_for(lattice: str, solidity: float, tmp_path: Path) -> None:
    file = tmp_path / "fibers.csv"
    file.write_text(fibers(lattice, solidity), encoding="ascii")
    mat = generate(lattice_case(lattice, solidity, 0.5, "lattice", file).mat, None)
    nominal = measure(mat).solidity
    # the cubic lattice's three cylinders share 8 sqrt(2) a^3 of their summed volume
    shared = 8.0 * math.sqrt(2.0) / pitch(lattice, solidity) ** 3 if lattice == "cubic" else 0.0
    assert nominal - shared == pytest.approx(solidity, rel=1e-9)


def test_the_table_shows_the_error_of_the_resistance_on_three_meshes() -> None:
    rungs = [
        LatticeRung("crossed", 0.1, "lattice", 0.5, 1000 * k, 0.2 / k, 1.8, 1.83853, 0.03 / k**3, 0.0, 0.0, 30, 1.0)
        for k in (1, 2, 3)
    ]
    row = "| crossed | 0.1 | lattice | 1.8385 | +3.00 % (1,000) | +0.38 % (2,000) | +0.11 % (3,000) | 3.0 | 3.0 |"
    assert row in lattice_table(rungs)


def test_the_mean_pressure_about_a_plane_of_a_linear_field_is_that_of_the_plane() -> None:
    # pressure falls by 2 Pa per unit along z in a box of one by one by three: any even weight gives the plane's value
    points, cells = brick(np.zeros(3), np.array([1.0, 1.0, 3.0]), (2, 2, 24))
    nodes = number_nodes(cells, len(points))
    field = FlowField(
        positions=np.concatenate([points, nodes.middles(points)]),
        cells=nodes.cells,
        velocity=np.zeros((nodes.count, 3)),
        pressure=-2.0 * points[:, 2],
        curved=np.zeros(len(cells), bool),
        slip_length=0.0,
    )
    for height, reach in ((1.5, 0.7), (1.0, 1.0), (2.0, 0.5)):
        assert mean_pressure(field, height, reach) == pytest.approx(-2.0 * height, rel=1e-3)
