"""A turned mat is the same medium, and lets through what its axes say."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import math
from pathlib import Path

import numpy as np
import pytest

from pipeline.case import read_case
from pipeline.cli.permeating import permeability_of_case
from pipeline.errors import CaseError
from pipeline.mat.generate import generate
from pipeline.mat.settings import Constant, LayeredSettings, Stop
from pipeline.nouns.fibers import Mat
from pipeline.nouns.permeability import RESULT, read_permeability
from pipeline.study.permeability import turned
from tests.solve.test_stokes import row_drag

UM = 1e-6


def deposit(periodic: bool) -> Mat:
    return generate(
        LayeredSettings(
            side=12 * UM,
            fiber_diameter=Constant(diameter=UM),
            relaxation_slope=0.15,
            stop=Stop(coverage=1.0),
            periodic=periodic,
            seed=3,
        )
    )


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_turned_mat_has_the_same_fibers_over_its_new_faces(axis: str) -> None:
    mat = deposit(periodic=False)
    other = turned(mat, axis)
    assert other.segment_lengths() == pytest.approx(mat.segment_lengths())
    # the plan's area times the length is the slab, wider by half a diameter where its top and its bottom were
    assert other.slab.volume == pytest.approx(mat.slab.volume * (1 + 0.5 * UM / mat.thickness))
    assert other.thickness == mat.slab.size["xyz".index(axis)]
    level = next(index for index in range(2) if other.slab.size[index] != mat.slab.size[0])
    # nothing but air touches the sides where the mat's faces were
    heights = other.nodes[:, level]
    assert heights.min() == pytest.approx(0.75 * UM, rel=1e-6)
    # turned, not mirrored
    before, after = mat.nodes[1:4] - mat.nodes[:3], other.nodes[1:4] - other.nodes[:3]
    assert np.linalg.det(after) == pytest.approx(np.linalg.det(before))


def test_a_turned_periodic_mat_keeps_what_leaves_through_its_sides() -> None:
    from pipeline.mat.windows import lengths_within

    mat = deposit(periodic=True)
    other = turned(mat, "x")
    start = other.segment_starts()
    within = lengths_within(other.slab, other.nodes[start], other.nodes[start + 1])
    # by periods every piece of every fiber lies within the plan once
    assert within.sum() == pytest.approx(mat.segment_lengths().sum(), rel=1e-9)


def test_a_body_is_not_turned(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_bytes(b"")
    case = tmp_path / "a.toml"
    case.write_text(
        '[mat]\ngenerator = "surface"\nfile = "a.stl"\nunit = "um"\n[flow]\nface_velocity = "2.5 cm/s"\n'
        'temperature = "293 K"\n',
        encoding="utf-8",
    )
    from pipeline.progress import silent
    from pipeline.study.permeability import permeability

    with pytest.raises(CaseError, match="a body is not turned"):
        permeability(read_case(case), tmp_path, silent)


def drummond_tahir_along(solidity: float) -> float:
    """Permeability over radius squared along a square array (Drummond & Tahir 1984, eq. 45)."""
    return (-math.log(solidity) - 1.476 + 2 * solidity - 0.5 * solidity**2) / (4 * solidity)


def drummond_tahir_across(solidity: float) -> float:
    """Permeability over radius squared across a square array (Drummond & Tahir 1984, eq. 31)."""
    last = (2 * solidity - 0.796 * solidity**2) / (1 + 0.489 * solidity - 1.605 * solidity**2)
    return (-math.log(solidity) - 1.476 + last) / (8 * solidity)


@pytest.mark.slow
def test_a_square_array_lets_through_what_drummond_and_tahir_say(tmp_path: Path) -> None:
    found = {}
    for depth in (8, 16):
        case = tmp_path / f"array_{depth}.toml"
        case.write_text(
            '[mat]\ngenerator = "array"\narrangement = "square"\nsolidity = 0.1\nfiber_diameter = "1 um"\nrows = 2\n'
            f'depth = "{depth} um"\n[flow]\nface_velocity = "2.5 cm/s"\ntemperature = "293 K"\n'
            'fiber_wall = "no_slip"\n',
            encoding="utf-8",
        )
        permeability_of_case(case, tmp_path / f"run_{depth}", (), False, True)
        result = read_permeability(tmp_path / f"run_{depth}")
        assert result is not None
        assert json.loads((tmp_path / f"run_{depth}" / RESULT).read_text())["tensor"][2][2] == result.z.permeability
        found[depth] = result
    # one row alone, along x, has 4.2 % more drag than in the array (Tamada & Fujikawa 1957); the default mesh adds 3 %
    assert found[8].x.permeability == pytest.approx(math.pi / (0.4 * row_drag(0.1)) * UM**2, rel=0.04)
    # of two rows, along z, each has half of that
    across = drummond_tahir_across(0.1) * 0.25 * UM**2
    assert found[8].x.permeability < found[8].z.permeability < across
    assert found[8].z.permeability == pytest.approx(across, rel=0.06)
    # along, what both ends add is the same at twice the length: the difference is the array's alone
    long, short = found[16].y, found[8].y
    resistance = (long.length / long.permeability - short.length / short.permeability) / (long.length - short.length)
    assert 1 / resistance == pytest.approx(drummond_tahir_along(0.1) * 0.25 * UM**2, rel=0.05)
