"""A mesh in tiles is the mesh in one piece: no gap, no overlap, and nothing that a cut made worse."""

# SPDX-License-Identifier: GPL-3.0-or-later

from functools import cache

import numpy as np
import pytest

from pipeline.case import Case, validate
from pipeline.enclosure.duct import enclose
from pipeline.errors import CaseError
from pipeline.geometry.adjacency import cell_volumes
from pipeline.mat.generate import generate
from pipeline.mesh.engines.lattice.lattice import lattice_mesh, lattice_part
from pipeline.mesh.fill import fill
from pipeline.mesh.tiles.faces import Tile, beside_others, name_toward, tile_of
from pipeline.mesh.tiles.make import PieceMesh, make_piece
from pipeline.mesh.tiles.plan import TilePlan, plan
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import PATCHES, SIDES
from pipeline.progress import silent
from pipeline.quality.judge import judge
from pipeline.surface.union import unite


def mat(seed: int, side: str = "17 um", coverage: float = 0.35, **tetmesh: object) -> Case:
    return validate(
        {
            "mat": {
                "generator": "layered", "side": side, "fiber_diameter": "1.4 um", "relaxation_slope": 0.15,
                "seed": seed, "stop": {"coverage": coverage},
            },
            "enclosure": {"inlet": "3 um", "outlet": "3 um"},
            "tetmesh": {"engine": "lattice", "edge": 0.6, "largest_edge": 1.2, **tetmesh},
        },
        "tiles",
    )  # fmt: skip


@cache
def duct_of(case: Case) -> FluidDomain:
    return enclose(unite(generate(case.mat), case.surface), case.enclosure)


@cache
def meshed(case: Case) -> FaceMesh:
    return fill(duct_of(case), case.tetmesh)[0]


def in_tiles(case: Case, counts: tuple[int, int]) -> tuple[TilePlan, dict[int, PieceMesh], list[Tile]]:
    domain = duct_of(case)
    cut = plan(domain, case.tetmesh, counts)
    made: dict[int, PieceMesh] = {}
    for piece in cut.pieces():
        made[piece.number] = make_piece(piece, cut, domain, case.tetmesh, {k: made[k] for k in piece.before})
    tiles = []
    for number in range(cut.tiles):
        piece_mesh = made[cut.strips + number]
        tiles.append(tile_of(number, piece_mesh, np.ones(len(piece_mesh.tets), bool)))
    return cut, made, tiles


def corners(mesh: FaceMesh, name: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return mesh.points[mesh.triangles()[mesh.patch(name)]]


@pytest.mark.parametrize(
    ("seed", "counts"),
    [
        (1, (2, 2)),
        *(pytest.param(seed, (2, 2) if seed % 2 else (1, 2), marks=pytest.mark.slow) for seed in range(2, 22)),
    ],
)
def test_tiles_fit_face_by_face_and_are_together_the_mesh_in_one_piece(seed: int, counts: tuple[int, int]) -> None:
    case = mat(seed)
    whole = meshed(case)
    _, made, tiles = in_tiles(case, counts)
    for number, tile in enumerate(tiles):
        assert number not in tile.neighbors
        for other in tile.neighbors:
            here = corners(tile.mesh, name_toward(number, other))
            there = corners(tiles[other].mesh, name_toward(other, number))
            # the same corner first, then the other way round, to the last bit
            np.testing.assert_array_equal(here, there[:, [0, 2, 1]])
    # walls near a cut are fitted apart from those behind it: a millionth of the air
    assert sum(tile.mesh.volume for tile in tiles) == pytest.approx(whole.volume, rel=1e-4)
    # what repairing cannot move at the rim of a strip it splits, and the tile behind keeps that
    assert sum(tile.mesh.cells for tile in tiles) == pytest.approx(whole.cells, rel=0.01)
    # nothing but the duct's planes, the fibers and other tiles bounds a tile; a vertex where a fiber leaves by a side
    # moves a little elsewhere, a thousandth of that side
    shape = whole.polyhedra()
    for name in (*SIDES, "inlet", "outlet", "fibers"):
        area = sum(np.linalg.norm(t.mesh.polyhedra().areas[t.mesh.patch(name)], axis=1).sum() for t in tiles)
        assert area == pytest.approx(np.linalg.norm(shape.areas[whole.patch(name)], axis=1).sum(), rel=1e-3)
    for number in range(len(tiles)):
        beside, own = beside_others(made[len(made) - len(tiles) + number])
        report = judge(beside, case.quality, own=own)
        assert report.verdict == "pass", report.reasons


def test_a_part_of_the_lattice_is_the_whole_lattice_there() -> None:
    # graded: cubes of four sizes
    case = mat(1, growth=1.0, largest_edge=3.0)
    domain = duct_of(case)
    whole, _ = lattice_mesh(domain, case.tetmesh, silent)
    low, high = np.array([5e-6, 0.0, domain.box.lower[2]]), np.array([9e-6, 7e-6, domain.box.upper[2]])
    part = lattice_part(
        domain, case.tetmesh, low, high,
        lambda places: np.where(((places > low) & (places < high)).all(axis=1), 0, -1),
    )  # fmt: skip
    cells = np.sort(whole.points[whole.tets].sum(axis=1) @ np.array([1.0, 2.0, 3.0]))
    found = part.points[part.tets].sum(axis=1) @ np.array([1.0, 2.0, 3.0])
    assert len(found) > 1000
    # each of its cells is one of the whole's, with the same vertices to rounding
    nearest = cells[np.clip(np.searchsorted(cells, found), 1, len(cells) - 1)]
    before = cells[np.clip(np.searchsorted(cells, found), 1, len(cells) - 1) - 1]
    assert np.minimum(np.abs(found - nearest), np.abs(found - before)).max() < 1e-12 * domain.box.size[0]
    # and they fill the part but for half a cell at its rim
    volume = cell_volumes(part.points, part.tets).sum()
    here = ((m := whole.points[whole.tets].mean(axis=1)) > low).all(axis=1) & (m < high).all(axis=1)
    assert volume == pytest.approx(cell_volumes(whole.points, whole.tets[here]).sum(), rel=0.05)


def test_one_tile_is_the_mesh_itself() -> None:
    case = mat(1)
    whole = meshed(case)
    _, _, (tile,) = in_tiles(case, (1, 1))
    assert tile.neighbors == ()
    assert [patch.name for patch in tile.mesh.patches] == list(PATCHES)
    # the same lattice, whose vertices are numbered in another order, in which repairing takes its turns
    assert tile.mesh.cells == pytest.approx(whole.cells, rel=1e-3)
    assert tile.mesh.volume == pytest.approx(whole.volume, rel=1e-6)


def test_what_cannot_be_cut_is_refused_with_what_can() -> None:
    domain = duct_of(mat(1))
    with pytest.raises(CaseError, match=r"9 tiles along x are 1\.89 um wide, .* takes 7\.\d+ um; take at most 2"):
        plan(domain, mat(1).tetmesh, (9, 1))
    with pytest.raises(CaseError, match=r'tiles need tetmesh\.engine = "lattice".*; it is "tetwild"'):
        plan(domain, mat(1).tetmesh.changed(engine="tetwild"), (2, 2))
