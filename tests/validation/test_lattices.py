"""Lattices of fibers as files, whose solidity is the one asked for."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from pathlib import Path

import pytest

from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from validation.lattices import EXACT, LatticeRung, fibers, lattice_case, pitch
from validation.tables import lattice_table


@pytest.mark.parametrize(("lattice", "solidity"), [(name, share) for name, shares in EXACT.items() for share in shares])
def test_a_lattice_has_the_solidity_that_was_asked_for(lattice: str, solidity: float, tmp_path: Path) -> None:
    text, cells = fibers(lattice, solidity)
    file = tmp_path / "fibers.csv"
    file.write_text(text, encoding="ascii")
    mat = generate(lattice_case(lattice, solidity, 0.5, "lattice", file).mat, None)
    assert sorted(fiber for cell in cells for fiber in cell) == list(range(mat.fibers))
    nominal = measure(mat).solidity
    # the cubic lattice's three cylinders share 8 sqrt(2) a^3 of their summed volume
    shared = 8.0 * math.sqrt(2.0) / pitch(lattice, solidity) ** 3 if lattice == "cubic" else 0.0
    assert nominal - shared == pytest.approx(solidity, rel=1e-9)


def test_the_table_shows_the_error_of_the_resistance_on_three_meshes() -> None:
    rungs = [
        LatticeRung("crossed", 0.1, "lattice", 0.5, 1000 * k, 0.2, 1.8, 1.83853, 0.03 / k**3, 0.0, 0.0, 30, 1.0)
        for k in (1, 2, 3)
    ]
    row = "| crossed | 0.1 | lattice | 1.8385 | +3.00 % (1,000) | +0.38 % (2,000) | +0.11 % (3,000) |"
    assert row in lattice_table(rungs)
