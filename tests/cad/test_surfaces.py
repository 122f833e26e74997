"""The fibers' surface in drawing programs' files, read back by somebody else's readers."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pymeshlab
import pytest
import pyvista
import trimesh

from pipeline.cad.surfaces import PER_METER, LengthUnit, on_grid, write_obj, write_ply, write_stl
from pipeline.geometry.triangles import Floats, enclosed_volume, unmatched_edges
from pipeline.nouns.surface import Surface
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite
from tests.surface.mats import CROSSING

WRITERS: dict[str, Callable[[Surface, Path, LengthUnit], None]] = {
    "stl": write_stl, "ply": write_ply, "obj": write_obj,
}  # fmt: skip


@pytest.fixture(scope="module")
def surface() -> Surface:
    return unite(CROSSING, SurfaceSettings())


@pytest.mark.parametrize("unit", ["um", "mm", "m"])
@pytest.mark.parametrize("kind", WRITERS)
def test_every_file_says_its_unit_in_words(surface: Surface, kind: str, unit: LengthUnit, tmp_path: Path) -> None:
    WRITERS[kind](surface, tmp_path / f"it.{kind}", unit)
    words = {"um": b"micrometers", "mm": b"millimeters", "m": b", in meters"}[unit]
    assert words in (tmp_path / f"it.{kind}").read_bytes()[:200]


@pytest.mark.parametrize("kind", WRITERS)
def test_trimesh_finds_it_watertight_as_it_loads_it(surface: Surface, kind: str, tmp_path: Path) -> None:
    WRITERS[kind](surface, tmp_path / f"it.{kind}", "um")
    # it joins points within 1e-8: in meters that is a hundredth of a micrometer, and nothing was closed
    solid = trimesh.load(tmp_path / f"it.{kind}")
    assert solid.is_watertight
    # numbers of 32 bits keep 7 digits
    assert solid.volume == pytest.approx(surface.volume * PER_METER["um"] ** 3, rel=1e-5)


@pytest.mark.parametrize("kind", WRITERS)
def test_pymeshlab_finds_no_open_edge_and_none_with_three_faces(surface: Surface, kind: str, tmp_path: Path) -> None:
    WRITERS[kind](surface, tmp_path / f"it.{kind}", "um")
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(tmp_path / f"it.{kind}"))
    meshes.meshing_remove_duplicate_vertices()
    found = meshes.get_topological_measures()
    assert (found["boundary_edges"], found["non_two_manifold_edges"]) == (0, 0)


def joined(points: Floats, within: float) -> tuple[Floats, np.ndarray[tuple[int, ...], np.dtype[np.int64]]]:
    """Join points that lie within a distance of one another, as gmsh does: by cells of that size."""
    cells = np.round(points / within).astype(np.int64)
    _, first, same = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    return points[first], same.reshape(-1)


@pytest.mark.parametrize("unit", ["um", "m"])
def test_a_tolerance_of_1e_8_of_the_whole_joins_the_corners_and_no_others(
    surface: Surface, unit: LengthUnit, tmp_path: Path
) -> None:
    # gmsh's Geometry.Tolerance, times the box's diagonal
    write_stl(surface, tmp_path / "it.stl", unit)
    corners = np.asarray(trimesh.load_mesh(tmp_path / "it.stl", process=False).triangles).reshape(-1, 3)
    _, same = joined(corners, 1e-8 * float(np.linalg.norm(np.ptp(corners, axis=0))))
    triangles = same.reshape(-1, 3)
    assert unmatched_edges(triangles) == 0
    assert not (triangles == np.roll(triangles, 1, axis=1)).any()


def test_the_ply_keeps_every_digit_and_each_fiber(surface: Surface, tmp_path: Path) -> None:
    write_ply(surface, tmp_path / "it.ply", "m")
    mesh = trimesh.load_mesh(tmp_path / "it.ply", process=False)
    assert np.array_equal(mesh.vertices, surface.points)
    assert np.array_equal(mesh.faces, surface.triangles)
    assert np.array_equal(mesh.metadata["_ply_raw"]["face"]["data"]["fiber"], surface.fiber)
    assert pyvista.read(tmp_path / "it.ply").n_open_edges == 0


def test_the_obj_has_a_group_for_each_fiber(surface: Surface, tmp_path: Path) -> None:
    write_obj(surface, tmp_path / "it.obj")
    lines = (tmp_path / "it.obj").read_text().splitlines()
    starts = [k for k, line in enumerate(lines) if line.startswith("g ")]
    sizes = dict(zip((lines[k] for k in starts), np.diff([*starts, len(lines)]) - 1, strict=True))
    assert sizes == {f"g fiber_{k}": int((surface.fiber == k).sum()) for k in np.unique(surface.fiber)}


def test_points_that_a_grid_joins_take_their_triangles_along() -> None:
    # a tetrahedron whose one edge is shorter than the grid's spacing of 2^-23: nothing is left of it
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1e-9, 0], [0, 0, 1.0]])
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    # and beside it a whole one
    whole = np.array([[0, 5, 0], [1, 5, 0], [0, 6, 0], [0, 5, 1.0]])
    both = np.concatenate([points, whole])
    grid, triangles = on_grid(both, np.concatenate([tetrahedron, tetrahedron + 4]))
    assert len(triangles) == 4
    assert unmatched_edges(triangles) == 0
    assert enclosed_volume(grid, triangles) == pytest.approx(1 / 6, rel=1e-6)
