"""Pores, surface and tortuosity of media that closed forms know."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from pathlib import Path

import numpy as np
import pytest

from pipeline.case import read_case, validate
from pipeline.geometry.box import Box
from pipeline.line.results import Results
from pipeline.line.run import Run, run
from pipeline.line.store import write_json
from pipeline.mat.generate import generate
from pipeline.mat.settings import ArraySettings
from pipeline.nouns.fibers import Mat
from pipeline.nouns.structure import Structure
from pipeline.nouns.surface import Surface
from pipeline.structure.area import fiber_area, specific_surface
from pipeline.structure.measure import structure_of
from pipeline.structure.voxels import Room, room_in
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite

UM = 1e-6


def perrins(solidity: float) -> float:
    """Relative conductivity across a square array of insulating cylinders (Perrins et al. 1979, to their 8th power)."""
    third = 0.305827 * solidity**4 / (1 - 1.402958 * solidity**8)
    return 1 - 2 * solidity / (1 + solidity - third - 0.013362 * solidity**8)


def square(solidity: float, rows: int = 1, depth: float = 1.0) -> Surface:
    """A square array of fibers of 1 um along y."""
    mat = generate(
        ArraySettings(arrangement="square", solidity=solidity, fiber_diameter=UM, rows=rows, depth=depth * UM)
    )
    return unite(mat, SurfaceSettings())


def test_between_the_cylinders_of_a_square_array_the_largest_pore_fills_the_diagonal() -> None:
    surface = square(0.1, rows=2)
    pitch = math.sqrt(math.pi / 0.4)
    found = structure_of(room_in(surface, 16), periodic=False)
    # pitch sqrt(2) - d fits between four fibers; its middle lies within half a voxel's diagonal of a voxel's
    assert found.pores.largest == pytest.approx((pitch * math.sqrt(2) - 1) * UM, abs=1.5 * found.voxel)
    # pitch - d passes between two
    assert found.bubble_point == pytest.approx((pitch - 1) * UM, abs=1.5 * found.voxel)
    # all gaps are alike: what passes the throats carries everything
    assert found.mean_flow_pore == found.bubble_point


@pytest.mark.parametrize(("solidity", "per_diameter"), [(0.05, 8), (0.1, 8), (0.2, 12)])
def test_a_gas_diffuses_across_a_square_array_as_rayleigh_knows(solidity: float, per_diameter: int) -> None:
    found = structure_of(room_in(square(solidity), per_diameter), periodic=False)
    # measured: +.13, +.37 and +.25 %; halving the voxels takes it to a third or less
    assert found.relative_diffusivity == pytest.approx(perrins(solidity), rel=6e-3)
    assert found.tortuosity == pytest.approx((1 - solidity) / perrins(solidity), rel=1e-2)


def test_the_error_of_the_tortuosity_falls_with_the_square_of_the_voxels() -> None:
    surface = square(0.1)
    coarse, fine = (
        structure_of(room_in(surface, per), periodic=False).relative_diffusivity / perrins(0.1) - 1 for per in (5, 15)
    )
    # second order would be 9
    assert abs(coarse / fine) > 5


def test_the_surface_of_parallel_fibers_is_that_of_cylinders() -> None:
    for arrangement in ("square", "hexagonal"):
        mat = generate(ArraySettings(arrangement=arrangement, solidity=0.1, fiber_diameter=UM, rows=3))
        surface = unite(mat, SurfaceSettings())
        # 4 alpha / d; of fibers in a symmetry plane half of the points count
        found = specific_surface(surface, 1000.0)
        assert found.per_volume == pytest.approx(0.4 / UM, rel=1e-9)
        # the tubes have the cylinders' volume to 2e-4
        assert found.per_solid == pytest.approx(4 / UM, rel=3e-4)
        assert found.per_mass == pytest.approx(found.per_solid / 1000)


def test_crossing_fibers_hide_what_each_has_within_the_other() -> None:
    # two equal cylinders at right angles: 16 r^2 bounds the solid they share (Steinmetz), half of it on each
    nodes = np.array([[0, 5, 2], [10, 5, 2], [5, 0, 2], [5, 10, 2.0]]) * UM
    slab = Box((0, 0, 0), (10 * UM, 10 * UM, 4 * UM))
    mat = Mat(nodes, np.array([0, 2, 4]), np.full(2, 0.5 * UM), slab, -1, "two crossing fibers")
    area = fiber_area(unite(mat, SurfaceSettings()))
    assert area == pytest.approx((2 * math.pi * 10 - 16 * 0.25) * UM**2, rel=2e-3)


def test_ends_within_the_plan_have_caps() -> None:
    nodes = np.array([[2, 5, 2], [8, 5, 2.0]]) * UM
    slab = Box((0, 0, 0), (10 * UM, 10 * UM, 4 * UM))
    mat = Mat(nodes, np.array([0, 2]), np.full(1, 0.5 * UM), slab, -1, "a fiber with two ends")
    for settings, ends in ((SurfaceSettings(), math.pi / 2), (SurfaceSettings(caps="hemisphere"), math.pi)):
        area = fiber_area(unite(mat, settings))
        assert area == pytest.approx((math.pi * 6 + ends) * UM**2, rel=1e-9)


def tubes(*radii: float, width: int = 29) -> Room:
    """A block with round tubes along z, side by side, by the exact distance."""
    x, y = np.meshgrid(np.arange(width * len(radii)) + 0.5, np.arange(width) + 0.5, indexing="ij")
    apart = np.stack([r - np.hypot(x - (k + 0.5) * width, y - 0.5 * width) for k, r in enumerate(radii)])
    return Room(np.repeat(apart.max(axis=0)[:, :, None], 10, axis=2), UM)


def test_tubes_side_by_side_are_measured_as_what_they_are() -> None:
    found = structure_of(tubes(5.3, 12.4), periodic=False)
    # spheres have their middles in voxels' middles, up to .7 voxels off the axis
    assert found.bubble_point == pytest.approx(24.8 * UM, abs=1.5 * UM)
    assert found.pores.largest == found.bubble_point
    # the wide tube has 12.4^2 / (12.4^2 + 5.3^2) of the air
    share = 12.4**2 / (12.4**2 + 5.3**2)
    assert float(np.interp(14 * UM, found.pores.diameter, found.pores.share)) == pytest.approx(share, abs=0.01)
    # straight ways: nothing but the porosity holds a gas up
    assert found.tortuosity == pytest.approx(1.0, rel=1e-5)
    # and it carries 12.4^4 / (12.4^4 + 5.3^4) = 97 % of the flow
    assert found.mean_flow_pore == found.bubble_point


def test_finer_voxels_than_a_large_pore_needs_cost_no_more_and_tell_the_same() -> None:
    from pipeline.structure import measure

    wide, fine = tubes(45.3, width=101), tubes(45.3 / 2, width=51)
    assert wide.distance.max() > measure._WIDEST > fine.distance.max()
    one = structure_of(Room(np.repeat(wide.distance, 2, axis=2), UM), periodic=False)
    # on every second voxel a sphere's middle lies within a wider voxel's half diagonal of the axis
    assert one.bubble_point == pytest.approx(90.6 * UM, abs=3 * UM)
    assert one.pores.largest == one.bubble_point
    assert one.mean_flow_pore == one.bubble_point
    assert one.tortuosity == pytest.approx(1.0, rel=1e-5)


def test_half_of_the_flow_through_many_tubes_is_found_by_poiseuille() -> None:
    radii = (12.1, 11.0, 9.9, 8.8)
    found = structure_of(tubes(*radii), periodic=False)
    flow = np.cumsum(np.array(radii) ** 4) / np.sum(np.array(radii) ** 4)
    # the two widest carry 68 %, the widest alone 41 %: the second one's size is where half is reached
    assert flow[0] < 0.5 < flow[1]
    assert found.mean_flow_pore == pytest.approx(2 * radii[1] * UM, abs=1.5 * UM)


def test_a_throat_and_not_the_chamber_behind_it_is_the_bubble_point() -> None:
    room = tubes(12.0)
    narrowed = room.distance.copy()
    narrowed[:, :, 4:6] = tubes(4.0).distance[:, :, 4:6]
    found = structure_of(Room(narrowed, UM), periodic=False)
    assert found.bubble_point == pytest.approx(8 * UM, abs=1.5 * UM)
    assert found.pores.largest == pytest.approx(24 * UM, abs=1.5 * UM)
    # wet, the chamber behind the throat stays full until spheres of 8 um enter
    assert found.mean_flow_pore <= found.bubble_point
    plate = np.abs(np.arange(10) - 4.5) - 2.0
    closed = structure_of(Room(np.minimum(room.distance, plate), UM), periodic=False)
    assert (closed.bubble_point, closed.mean_flow_pore, closed.tortuosity) == (0.0, 0.0, 0.0)


def test_a_pore_across_the_side_of_a_periodic_medium_is_one_pore() -> None:
    room = tubes(12.0)
    shifted = np.roll(room.distance, 14, axis=0)
    one, other = (structure_of(Room(shifted, UM), periodic=periodic) for periodic in (True, False))
    # seen by periods the tube is whole; by mirrors two halves stand back to back, which are as wide
    assert one.pores.mean == pytest.approx(structure_of(room, periodic=True).pores.mean, rel=1e-9)
    assert other.pores.largest == pytest.approx(one.pores.largest, rel=1e-9)
    assert one.tortuosity == pytest.approx(1.0, rel=1e-5)


def test_random_spheres_never_hold_a_voxel_that_a_larger_one_holds() -> None:
    from pipeline.geometry.spheres import covered_by

    random = np.random.default_rng(4)
    for _ in range(4):
        shape = tuple(random.integers(7, 11, 3).tolist())
        middles = random.uniform(0, shape, (6, 3))
        place = np.moveaxis(np.indices(shape), 0, -1) + 0.5
        room = np.linalg.norm(place[..., None, :] - middles, axis=-1).min(axis=-1) - 1.0
        found = covered_by(room, room, False)
        # by force, with the medium mirrored at its sides
        assert room.max() < min(shape[:2])
        wide = np.pad(room, [(shape[0],) * 2, (shape[1],) * 2, (0, 0)], mode="symmetric").ravel()
        far = np.moveaxis(np.indices((3 * shape[0], 3 * shape[1], shape[2])), 0, -1).reshape(-1, 3)
        apart = np.linalg.norm(place.reshape(-1, 1, 3) - (far - [shape[0], shape[1], 0] + 0.5), axis=-1)
        exact, shrunk = (
            np.where((apart <= wide - less) & (wide > 0), wide, 0.0).max(axis=1).reshape(shape) for less in (-1e-9, 0.3)
        )
        assert (found <= exact).all()
        # a sphere is left out where a neighbor's covers it but for a tenth of a voxel, and so on, a few times
        assert (found >= shrunk).all()
        assert np.abs(found - exact).mean() < 0.02


def test_the_stage_runs_when_asked_and_tells_the_same_as_the_surface_alone(tmp_path: Path) -> None:
    case = read_case(
        Path("cases/smoke.toml"), ("structure.voxels_per_diameter=4", "structure.fiber_density=1.38 g/cm^3")
    )
    outcomes = run(case, tmp_path, until="structure")
    assert [outcome.stage for outcome in outcomes] == ["mat", "surface", "structure"]
    results = Run.opened(tmp_path)
    found, surface = results.read(Structure), results.read(Surface)
    # the voxels' air is that of the surface to the steps of their middles
    assert found.porosity == pytest.approx(1 - surface.solidity, abs=0.01)
    assert 0 < found.bubble_point <= found.pores.largest
    assert found.pores.p10 < found.pores.median < found.pores.p90
    assert found.tortuosity > 1
    # the same medium without its axes, as triangles alone
    body = Surface(
        surface.points, surface.triangles, surface.fiber, surface.radius, surface.slab,
        type(surface.pieces)(*(np.zeros((0, 3)),) * 2, np.zeros(0, np.int64), np.zeros((0, 2), bool)),
    )  # fmt: skip
    exact, sampled = room_in(surface, 4), room_in(body, 4)
    # polygons of twenty sides lie within a hundredth of a radius of the circle; points stand for triangles
    # off the sides, beyond which axes run on and triangles do not
    off = np.abs(exact.distance - sampled.distance)[5:-5, 5:-5]
    assert off.max() < 0.5
    assert off.mean() < 0.06


def test_a_medium_too_large_for_its_voxels_is_told_what_would_do() -> None:
    from pipeline.errors import StageError

    with pytest.raises(StageError, match=r"voxels_per_diameter to \d"):
        room_in(square(0.1, rows=20, depth=80.0), 64)


def test_too_few_voxels_to_a_fiber_are_refused() -> None:
    from pipeline.errors import CaseError

    with pytest.raises(CaseError, match=r"structure\.voxels_per_diameter"):
        validate({"structure": {"voxels_per_diameter": 0.5}}, "a case")


def test_the_page_shows_pores_and_permeability_where_they_are(tmp_path: Path) -> None:
    from pipeline.line.stages import LINE
    from pipeline.nouns.permeability import RESULT, AlongAxis, Permeability
    from pipeline.report.page.structure_section import structure

    case = read_case(Path("cases/smoke.toml"))
    assert structure(Results(case, tmp_path, LINE)) is None
    found = structure_of(tubes(5.3, 12.4), periodic=False)
    section = structure(Results(case, tmp_path, LINE, loaded={Structure: found}))
    assert section is not None
    assert len(section.parts) == 1
    # both sizes that let air through are drawn and told in micrometers: the wide tube's
    assert repr(section.parts[0]).count("24.8") >= 2
    along = AlongAxis(3e-12, 5.0, 2e-5, 4e-10, "run")
    tensor = ((3e-12, 0.0, 0.0), (0.0, 3e-12, 0.0), (0.0, 0.0, 3e-12))
    write_json(tmp_path / RESULT, Permeability("a", "slip", 0.1, along, along, along, tensor, 1.0))
    section = structure(Results(case, tmp_path, LINE))
    assert section is not None
    assert "('z, through the mat', '3', '5', '20')" in repr(section.parts[0])
