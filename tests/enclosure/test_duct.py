"""The air around the fibers: volumes add up, patches lie where their names say."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import pytest

from pipeline.enclosure.duct import enclose, fiber_spacing
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.errors import CaseError, StageError
from pipeline.geometry.triangles import area_vectors
from pipeline.nouns.fibers import Mat
from pipeline.nouns.patches import FIBERS, PATCHES
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite
from tests.surface.mats import CROSSING, EVERY_MAT, RADIUS, SIDE, WRAPPING, WRAPPING_A_CORNER, mat_of

PLENUMS = EnclosureSettings(inlet=5e-6, outlet=7e-6)


@pytest.mark.parametrize("mat", EVERY_MAT.values(), ids=EVERY_MAT.keys())
def test_solid_and_air_fill_the_duct(mat: Mat) -> None:
    surface = unite(mat, SurfaceSettings())
    domain = enclose(surface, PLENUMS)
    assert surface.volume + domain.volume == pytest.approx(domain.box.volume, rel=1e-9)


@pytest.mark.parametrize("mat", EVERY_MAT.values(), ids=EVERY_MAT.keys())
def test_patches_lie_on_their_planes_and_point_outward(mat: Mat) -> None:
    domain = enclose(unite(mat, SurfaceSettings()), PLENUMS)
    corners = domain.points[domain.triangles]
    area = area_vectors(domain.points, domain.triangles)
    planes = {"xmin": (0, 0.0), "xmax": (0, SIDE), "ymin": (1, 0.0), "ymax": (1, SIDE)}
    planes |= {"inlet": (2, -5e-6), "outlet": (2, SIDE + 7e-6)}
    for name, (axis, place) in planes.items():
        mine = domain.patch == PATCHES.index(name)
        assert (corners[mine][:, :, axis] == place).all()
        outward = -1 if name in ("xmin", "ymin", "inlet") else 1
        assert (outward * area[mine][:, axis] > 0).all()
    # nothing of the fibers' patch may lie on a plane: there it would be a wall across the flow or the symmetry
    fibers = corners[domain.patch == PATCHES.index(FIBERS)]
    for axis, place in planes.values():
        assert not (fibers[:, :, axis] == place).all(axis=1).any()


def test_the_inlet_and_outlet_are_whole_rectangles() -> None:
    domain = enclose(unite(CROSSING, SurfaceSettings()), PLENUMS)
    area = np.linalg.norm(area_vectors(domain.points, domain.triangles), axis=1)
    for name in ("inlet", "outlet"):
        assert area[domain.patch == PATCHES.index(name)].sum() == pytest.approx(SIDE**2, rel=1e-12)


def test_fiber_triangles_keep_their_fiber() -> None:
    domain = enclose(unite(CROSSING, SurfaceSettings()), PLENUMS)
    is_fiber = domain.patch == PATCHES.index(FIBERS)
    assert (domain.fiber[~is_fiber] == -1).all()
    middle = domain.points[domain.triangles].mean(axis=1)[is_fiber] - 5e-6
    distance = np.stack([np.hypot(middle[:, 1], middle[:, 2]), np.hypot(middle[:, 0], middle[:, 2])])
    assert distance[domain.fiber[is_fiber], np.arange(len(middle))].max() < 1.02 * RADIUS


def test_plenums_are_three_fiber_spacings_when_not_given() -> None:
    surface = unite(CROSSING, SurfaceSettings())
    box = enclose(surface, EnclosureSettings()).box
    assert box.lower[2] == pytest.approx(-3 * fiber_spacing(surface))
    assert box.upper[2] == pytest.approx(SIDE + 3 * fiber_spacing(surface))


def test_the_spacing_of_a_square_array_is_its_pitch() -> None:
    # one fiber across a cell of 10 um: the pitch is the cell's side
    assert fiber_spacing(unite(mat_of([(5, 0, 5), (5, 10, 5)]), SurfaceSettings())) == pytest.approx(SIDE, rel=1e-3)


def test_fibers_that_touch_the_end_of_a_plenum_are_refused() -> None:
    standing = unite(mat_of([(5, 5, 1), (5, 5, 13)]), SurfaceSettings())
    with pytest.raises(StageError, match=r"touches the end of the outlet.*enclosure\.outlet at least 3\.14e-06"):
        enclose(standing, EnclosureSettings(inlet=5e-6, outlet=3e-6))
    assert enclose(standing, EnclosureSettings(inlet=5e-6, outlet=3.2e-6)).volume > 0


def test_fibers_that_close_the_duct_are_refused() -> None:
    wall = mat_of(*([(0, y, 5), (10, y, 5)] for y in range(11)))
    with pytest.raises(StageError, match="no air leads from the inlet to the outlet"):
        enclose(unite(wall, SurfaceSettings()), PLENUMS)


def test_a_pocket_against_a_side_is_left_out_and_told() -> None:
    # three touching fibers along y leave a gap in their middle; two fibers across stop it: a pocket at each side
    height = 5 + 0.65 * np.sqrt(3)
    bundle = [[(x, 0, z), (x, 10, z)] for x, z in ((4.35, 5), (5.65, 5), (5.0, height))]
    stopper = [[(0, 3, z), (10, 3, z)] for z in (5.0, height)]
    told: list[str] = []
    surface = unite(mat_of(*bundle, *stopper), SurfaceSettings())
    domain = enclose(surface, PLENUMS, lambda what, done=None: told.append(what))
    pockets = domain.box.volume - surface.volume - domain.volume
    assert 0 < pockets < 2e-3 * surface.volume
    assert any("2 closed pockets" in line for line in told)


def test_cyclic_sides_want_a_periodic_mat() -> None:
    cyclic = EnclosureSettings(inlet=5e-6, outlet=5e-6, sides="cyclic")
    for mat in (WRAPPING, WRAPPING_A_CORNER):
        assert enclose(unite(mat, SurfaceSettings()), cyclic).volume > 0
    slanted = unite(mat_of([(0, 4, 5), (10, 6, 5)]), SurfaceSettings())
    with pytest.raises(CaseError, match=r"needs a periodic mat: .* points on the sides across x have no partner"):
        enclose(slanted, cyclic)
