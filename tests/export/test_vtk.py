# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest

from pipeline.export.formats.vtk import volume_grid, write_vtk
from pipeline.nouns.mesh import FaceMesh, Patch
from tests.sample_meshes import duct


def test_pyvista_reads_the_same_cells_patches_and_volume(tmp_path: Path) -> None:
    import pyvista as pv

    mesh = duct((5, 5, 10), (10e-6, 10e-6, 20e-6), jitter=0.2).face_mesh()
    shape = mesh.polyhedra()
    write_vtk(mesh, tmp_path, {"volume": shape.volumes})
    blocks = pv.read(tmp_path / "mesh.vtm")
    volume, boundary = blocks["internal"], blocks["boundary"]
    assert volume.n_cells == mesh.cells
    assert (volume.celltypes == pv.CellType.TETRA).all()
    # doubles, cell by cell in the solver's order and never inside out
    assert volume.points.dtype == np.float64
    assert volume.compute_cell_sizes()["Volume"] == pytest.approx(shape.volumes, rel=1e-12)
    assert np.array_equal(volume["volume"], shape.volumes)
    assert boundary.keys() == [patch.name for patch in mesh.patches]
    for patch in mesh.patches:
        areas = np.linalg.norm(shape.areas[patch.start : patch.start + patch.count], axis=1)
        assert boundary[patch.name].n_cells == patch.count
        assert boundary[patch.name].area == pytest.approx(areas.sum(), rel=1e-12)


def test_patches_face_outward(tmp_path: Path) -> None:
    import pyvista as pv

    write_vtk(duct().face_mesh(), tmp_path, {})
    inlet = pv.read(tmp_path / "boundary/inlet.vtp").compute_normals(point_normals=False, consistent_normals=False)
    assert np.allclose(inlet["Normals"], [0, 0, -1])


def test_other_cells_than_tetrahedra_are_polyhedra_of_the_same_volume(tmp_path: Path) -> None:
    import pyvista as pv

    # a prism of height 2 on half a unit square, and on its roof a pyramid of height 3, volume 1 and 1/2
    prism_and_pyramid = FaceMesh(
        np.array([*([x, y, z] for z in (0.0, 2.0) for x, y in ((0, 0), (1, 0), (0, 1))), [0.2, 0.3, 5.0]]),
        np.array([3, 4, 5, 0, 2, 1, 0, 1, 4, 3, 1, 2, 5, 4, 2, 0, 3, 5, 3, 4, 6, 4, 5, 6, 5, 3, 6]),
        np.array([0, 3, 6, 10, 14, 18, 21, 24, 27]),
        np.array([0, 0, 0, 0, 0, 1, 1, 1]),
        np.array([1]),
        2,
        (Patch("prism", 1, 4), Patch("roof", 5, 3)),
    )
    assert not prism_and_pyramid.tetrahedral
    assert prism_and_pyramid.volume == pytest.approx(1.5, rel=1e-14)
    write_vtk(prism_and_pyramid, tmp_path, {})
    blocks = pv.read(tmp_path / "mesh.vtm")
    cells = blocks["internal"]
    assert (cells.celltypes == pv.CellType.POLYHEDRON).all()
    assert [cells.get_cell(k).n_faces for k in range(2)] == [5, 4]
    assert cells.compute_cell_sizes()["Volume"] == pytest.approx([1.0, 0.5], rel=1e-6)
    assert [blocks["boundary"]["prism"].get_cell(k).n_points for k in range(4)] == [3, 4, 4, 4]
    roof = volume_grid(prism_and_pyramid, np.array([False, True]), scale=2.0)
    assert roof.n_cells == 1
    assert roof.get_cell(0).bounds[-1] == 10.0
