"""Surfaces in files, read back by somebody else's reader."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest
import pyvista
import trimesh

from pipeline.surface.files import write_surface
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite

from .mats import CROSSING, SIDE


def test_files_hold_the_closed_surface(tmp_path: Path) -> None:
    surface = unite(CROSSING, SurfaceSettings())
    stl, ply = write_surface(surface, tmp_path / "surface")
    # an STL repeats its points for each triangle; trimesh merges within 1e-8, hence at size one, not at micrometers
    solid = trimesh.load_mesh(stl, process=False).apply_scale(1 / SIDE).process(merge_norm=True)
    assert solid.is_watertight
    solid.apply_scale(SIDE)  # 32-bit numbers keep 7 digits
    assert solid.volume == pytest.approx(surface.volume, rel=1e-5)
    mesh = pyvista.read(ply)
    assert isinstance(mesh, pyvista.PolyData)
    assert mesh.n_open_edges == 0
    assert mesh.n_cells == len(surface.triangles)


def test_the_ply_keeps_every_digit_and_each_fiber(tmp_path: Path) -> None:
    surface = unite(CROSSING, SurfaceSettings())
    mesh = trimesh.load_mesh(write_surface(surface, tmp_path)[1], process=False)
    assert np.array_equal(mesh.vertices, surface.points)
    assert np.array_equal(mesh.faces, surface.triangles)
    assert np.array_equal(mesh.metadata["_ply_raw"]["face"]["data"]["fiber"], surface.fiber)
