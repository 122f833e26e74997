"""Fibers where nobody would lay them: a mesh that keeps every limit, or one clear error."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.enclosure.duct import enclose
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.mesh.fill import fill
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.quality.judge import judge
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite

UM = 1e-6
SIDE = 5.0  # um, of the plan; a fiber is 1 um thick unless it says otherwise
Line = tuple[tuple[float, float, float], tuple[float, float, float], float]
"""Ends of a straight fiber and its diameter [um]."""


def along_x(y: float, z: float, diameter: float = 1.0) -> Line:
    return (0.0, y, z), (SIDE, y, z), diameter


def along_y(x: float, z: float, diameter: float = 1.0) -> Line:
    return (x, 0.0, z), (x, SIDE, z), diameter


ODD: dict[str, tuple[Line, ...]] = {
    "touches a side along its length": (along_x(0.5, 1.0),),
    "grazes a side by a hundredth": (along_x(0.49, 1.0),),
    "leaves a gap of a hundredth to a side": (along_x(0.51, 1.0),),
    "lies half in a side": (along_x(0.0, 1.0),),
    "two that touch exactly": (along_x(2.0, 1.0), along_x(3.0, 1.0)),
    "two that cross and touch exactly": (along_x(2.5, 1.0), along_y(2.5, 2.0)),
    "two in one place": (along_x(2.5, 1.0), along_x(2.5, 1.0)),
    "two that nearly coincide": (along_x(2.5, 1.0), along_x(2.52, 1.01)),
    "ends on a side": (((2.0, 2.5, 1.0), (SIDE, 2.5, 1.0), 1.0),),
    "ends just before a side": (((2.0, 2.5, 1.0), (SIDE - 0.02, 2.5, 1.0), 1.0),),
    "runs along the flow": (((2.5, 2.5, 0.6), (2.5, 2.5, 3.0), 1.0),),
    "an edge of the duct cuts it": (((0.0, 0.4, 1.0), (0.4, 0.0, 1.0), 1.0),),
    "one to twenty": (along_x(2.5, 1.0, 2.0), along_y(2.5, 2.5, 0.1)),
}


def meshed(
    lines: tuple[Line, ...], engine: str, edge: float = 0.8, volume_error: float = 0.02
) -> tuple[str, TetmeshMeasures]:
    """Verdict and measures of the mesh around straight fibers."""
    nodes = UM * np.array([end for low, high, _ in lines for end in (low, high)])
    radius = 0.5 * UM * np.array([diameter for _, _, diameter in lines])
    slab = Box((0.0, 0.0, 0.0), (SIDE * UM, SIDE * UM, 4.0 * UM))
    mat = Mat(nodes, 2 * np.arange(len(lines) + 1), radius, slab, -1, "odd")
    domain = enclose(unite(mat, SurfaceSettings()), EnclosureSettings(inlet=2 * UM, outlet=2 * UM))
    mesh, measures = fill(domain, TetmeshSettings(engine=engine, edge=edge, volume_error=volume_error))
    return judge(mesh).verdict, measures


@pytest.mark.slow
@pytest.mark.parametrize("kind", ODD)
def test_ftetwild_meshes_every_odd_place_within_every_limit(kind: str) -> None:
    verdict, measures = meshed(ODD[kind], "tetwild")
    assert verdict == "pass"
    assert abs(measures.volume_error) < 0.02


@pytest.mark.parametrize("kind", ODD)
def test_the_lattice_meshes_every_odd_place_within_every_limit(kind: str) -> None:
    verdict, measures = meshed(ODD[kind], "lattice")
    assert verdict == "pass"
    assert measures.faulty_cells == 0
    # what a case allows unless it says otherwise
    assert abs(measures.volume_error) < 0.02


def near_a_side(seed: int) -> tuple[Line, ...]:
    """One fiber along a side or slightly askew, one that ends near another side, both off it by parts of a diameter."""
    generator = np.random.default_rng(seed)
    gap, end = 10.0 ** generator.uniform(-4, -0.5, 2) * generator.choice([-1.0, 1.0], 2)
    askew, height = generator.choice([0.0, 0.003, 0.1]), generator.uniform(0.6, 1.4)
    along = (0.0, 0.5 + gap, height), (SIDE, 0.5 + gap + askew, height), 1.0
    ending = (1.5, 3.2, height + generator.uniform(0.8, 1.6)), (SIDE - abs(end), 3.4, height + 1.2), 1.0
    return along, ending


@pytest.mark.parametrize("seed", range(6))
def test_fibers_that_nearly_touch_sides_are_meshed_within_every_limit(seed: int) -> None:
    verdict, measures = meshed(near_a_side(seed), "lattice")
    assert verdict == "pass"
    assert abs(measures.volume_error) < 0.02


def test_a_mesh_whose_fibers_lost_volume_names_the_one_that_lost_most() -> None:
    # chords of an edge of 2 diameters on circles cannot keep half a percent
    lines = (along_x(1.0, 1.0, 0.4), along_x(3.5, 1.0, 1.0))
    with pytest.raises(StageError, match=r"volume to .* fiber 1 of 2 \(d 1 um, through \(2.5, 3.5, 1\) um\).*tetmesh"):
        meshed(lines, "lattice", edge=2.0, volume_error=0.005)


def test_a_fiber_along_the_flow_keeps_its_axis_though_the_lattice_rounds_its_rims() -> None:
    # a twelfth of the axis at each end lies less than half a radius within the flat ends
    verdict, measures = meshed(ODD["runs along the flow"], "lattice")
    assert verdict == "pass"
    assert measures.fidelity is not None
    assert measures.fidelity.fibers[0].in_air == 0.0


def test_a_fiber_thicker_than_the_duct_is_one_clear_error() -> None:
    with pytest.raises(StageError, match=r"(close|no air).*(side|solidity|coverage)"):
        meshed((((0.0, 2.5, 2.5), (SIDE, 2.5, 2.5), 5.2),), "tetwild")
