"""Every wall face keeps the fiber that it stands for, from the mesher into the files that users open."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import pyvista
from foamlib import FoamFieldFile

from pipeline.case import validate
from pipeline.enclosure.duct import enclose
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.formats.vtk import write_vtk
from pipeline.line import store
from pipeline.mat.generate import generate
from pipeline.mesh.fill import fill
from pipeline.mesh.wall_error import fidelity, wall_deviation
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.patches import FIBERS
from pipeline.surface.union import unite
from tests.openfoam import AIR, foam
from tests.sample_meshes import duct


@cache
def meshed(engine: str, seed: int, edge: float = 0.8) -> tuple[FluidDomain, FaceMesh]:
    """Mesh a few fibers of three diameters that touch each other."""
    case = validate(
        {
            "mat": {
                "generator": "layered", "side": "5 um", "relaxation_slope": 0.2, "seed": seed, "stop": {"count": 4},
                "fiber_diameter": {"distribution": "uniform", "min": "0.7 um", "max": "2 um"},
            },
            "enclosure": {"inlet": "2 um", "outlet": "2 um"},
            "tetmesh": {"engine": engine, "edge": edge},
        },
        "walls",
    )  # fmt: skip
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    return domain, fill(domain, case.tetmesh)[0]


def distances(places: Floats, domain: FluidDomain) -> Floats:
    """Distance from each place to the surface of each fiber by its axes, one by one: (fibers, n) array."""
    nearest = np.full((len(domain.radius), len(places)), np.inf)
    for start, end, fiber in zip(domain.pieces.start, domain.pieces.end, domain.pieces.fiber, strict=True):
        line = end - start
        share = np.clip((places - start) @ line / (line @ line), 0.0, 1.0)
        off = np.linalg.norm(places - start - share[:, None] * line, axis=1) - domain.radius[fiber]
        nearest[fiber] = np.minimum(nearest[fiber], off)
    return nearest


@pytest.mark.parametrize(
    ("engine", "seed"),
    [
        ("lattice", 1),
        ("lattice", 2),
        pytest.param("tetwild", 3, marks=pytest.mark.slow),
        pytest.param("snappy", 4, marks=pytest.mark.openfoam),
    ],
)
def test_a_wall_face_stands_for_the_fiber_whose_surface_is_nearest_to_its_center(engine: str, seed: int) -> None:
    domain, mesh = meshed(engine, seed)
    off = distances(mesh.polyhedra().centers[mesh.patch(FIBERS)], domain)
    # fibers that are cut flat at an end are told by their round ends here: a hair of difference, in a few faces
    own = off[mesh.fiber, np.arange(len(mesh.fiber))]
    assert (own <= off.min(axis=0) + 1e-9 * domain.mean_diameter).mean() > 0.995
    # chords of .8 diameters have a sagitta of .2 radii; crevices are filled to about an edge
    assert np.abs(own / domain.radius[mesh.fiber]).mean() < 0.2
    assert set(mesh.fiber.tolist()) == set(range(len(domain.radius)))


def test_the_fibers_of_the_walls_are_kept_with_the_mesh(tmp_path: Path) -> None:
    _, mesh = meshed("lattice", 1)
    store.save(mesh, tmp_path / "mesh.npz")
    np.testing.assert_array_equal(store.load(FaceMesh, tmp_path / "mesh.npz").fiber, mesh.fiber)


def test_a_mesh_whose_walls_name_the_wrong_number_of_fibers_is_none() -> None:
    mesh = duct().face_mesh()
    walls = mesh.patch(FIBERS).stop - mesh.patch(FIBERS).start
    assert len(mesh.fiber) == 0
    with pytest.raises(ValueError, match=f"3 of {walls} faces of fibers name their fiber"):
        replace(mesh, fiber=np.zeros(3, np.int64))


def numbered(mesh: FaceMesh) -> FaceMesh:
    """Number the walls of a duct by where they stand, from one side to the other."""
    along = mesh.polyhedra().centers[mesh.patch(FIBERS), 0]
    return replace(mesh, fiber=np.argsort(np.argsort(along)))


def test_vtk_and_openfoam_files_number_the_fiber_of_each_wall_face(tmp_path: Path) -> None:
    mesh = numbered(duct((4, 4, 8)).face_mesh())
    centers = mesh.polyhedra().centers[mesh.patch(FIBERS)]
    write_vtk(mesh, tmp_path / "vtk", {})
    walls = pyvista.read(tmp_path / "vtk/boundary/fibers.vtp")
    np.testing.assert_array_equal(walls["fiber"], mesh.fiber)
    np.testing.assert_allclose(walls.cell_centers().points, centers, atol=1e-12)
    assert "fiber" not in pyvista.read(tmp_path / "vtk/boundary/inlet.vtp").cell_data
    write_openfoam(mesh, tmp_path / "foam", AIR)
    field = FoamFieldFile(tmp_path / "foam/0/fiber")
    np.testing.assert_array_equal(field.boundary_field[FIBERS]["value"], mesh.fiber)
    assert field.internal_field == -1
    # a mesh of others' making has none to tell
    write_openfoam(duct().face_mesh(), tmp_path / "plain", AIR)
    assert not (tmp_path / "plain/0/fiber").exists()


@pytest.mark.openfoam
def test_openfoam_takes_the_fibers_apart_with_the_mesh(tmp_path: Path) -> None:
    mesh = numbered(duct((4, 4, 8), (10e-6, 10e-6, 20e-6)).face_mesh())
    write_openfoam(mesh, tmp_path / "case", AIR)
    foam(tmp_path / "case", "decomposePar")
    found = [values_on_walls(tmp_path / f"case/processor{k}/0/fiber") for k in range(2)]
    np.testing.assert_array_equal(np.sort(np.concatenate(found)), np.arange(len(mesh.fiber)))


def values_on_walls(path: Path) -> Ints:
    value = FoamFieldFile(path).boundary_field[FIBERS]["value"]
    return np.asarray(value, np.int64)


@pytest.mark.parametrize("seed", [1, 2])
def test_99_percent_of_the_walls_lie_within_the_typical_deviation(seed: int) -> None:
    # by the axes, one fiber after the other, at the three places of every triangle that integrate quadratics exactly
    domain, mesh = meshed("lattice", seed)
    which = mesh.patch(FIBERS)
    corners = mesh.points[mesh.corners[mesh.offsets[which.start] : mesh.offsets[which.stop]].reshape(-1, 3)]
    places = 0.5 * (corners + np.roll(corners, 1, axis=1))
    off = distances(places.reshape(-1, 3), domain)
    diameter = 2.0 * domain.radius[off.argmin(axis=0)]
    away = np.abs(off.min(axis=0)) / diameter
    area = np.repeat(np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1), 3)
    fiber = np.repeat(mesh.fiber, 3)
    found = fidelity(mesh, domain)
    assert wall_deviation(mesh, domain)[1] == found.typical_deviation
    told = [(np.ones(len(fiber), bool), found.typical_deviation)]
    told += [(fiber == walls.fiber, walls.typical_deviation) for walls in found.fibers]
    for of, typical in told:
        # flat ends are told by round ones here: a hair of difference, in a few places
        assert area[of & (away <= 1.01 * typical)].sum() >= 0.989 * area[of].sum()
        assert area[of & (away < 0.99 * typical)].sum() <= 0.99 * area[of].sum()
