# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import pytest

from pipeline.geometry.box import Box
from pipeline.geometry.cells import cell_faces, polygons_of
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.quality.judge import cell_fields, judge, measure
from pipeline.quality.settings import QualitySettings
from tests.sample_meshes import TetMesh, boundary_of, duct


def bricks(sizes: list[float], shear: float = 0.0) -> FaceMesh:
    """Bricks of unit cross section in a row along x, their lengths given; `shear` slants the planes between them."""
    x = np.concatenate([[0.0], np.cumsum(sizes)])
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    points = np.array([[px + shear * y, y, z] for px in x for y, z in square])
    n = len(sizes)
    between = [[4 * k + c for c in range(4)] for k in range(1, n)]
    ends = [[3, 2, 1, 0], [4 * n + c for c in range(4)]]
    walls = [[4 * k + a, 4 * k + b, 4 * k + 4 + b, 4 * k + 4 + a] for k in range(n) for a, b in
             ((0, 1), (1, 2), (2, 3), (3, 0))]  # fmt: skip
    faces = [*between, *ends, *walls]
    owner = [*range(n - 1), 0, n - 1, *np.repeat(np.arange(n), 4).tolist()]
    patches = (Patch("ends", n - 1, 2), Patch("walls", n + 1, 4 * n))
    offsets = np.arange(0, 4 * len(faces) + 1, 4)
    return FaceMesh(points, np.array(faces).ravel(), offsets, np.array(owner), np.arange(1, n), n, patches)


def regular_tetrahedron(size: float) -> FaceMesh:
    points = size * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.0]])
    tets = np.array([[0, 2, 1, 3]])
    faces = boundary_of(tets)
    box = Box((0, 0, 0), (1, 1, 1))
    return TetMesh(points, tets, faces, np.zeros(4, np.int64), ("all",), box).face_mesh()


@pytest.mark.parametrize("size", [1e-7, 1.0, 1e4])
def test_a_regular_tetrahedron_has_its_closed_form_at_every_size(size: float) -> None:
    report = judge(regular_tetrahedron(size))
    edge = 2 * math.sqrt(2) * size
    volume = edge**3 / (6 * math.sqrt(2))
    assert report.volume == pytest.approx(volume, rel=1e-13)
    assert report.metrics["face_area"].max == pytest.approx(math.sqrt(3) / 4 * edge**2, rel=1e-13)
    # four areas' components along each axis are equal, so only the surface over that of a cube counts:
    # sum of |S| by component is 3 * 4 * A / sqrt(3)
    surface = 12 * (math.sqrt(3) / 4 * edge**2) / math.sqrt(3)
    assert report.metrics["aspect_ratio"].max == pytest.approx(surface / 6 / volume ** (2 / 3), rel=1e-12)
    assert report.metrics["skewness"].max == pytest.approx(0.0, abs=1e-12)
    assert report.metrics["face_pyramid"].min == pytest.approx(0.25, rel=1e-12)
    # one cell has no internal face to measure
    assert "non_orthogonality" not in report.metrics


def test_bricks_in_a_row_have_the_ratios_of_their_lengths() -> None:
    metrics = judge(bricks([1.0, 3.0, 3.0])).metrics
    assert metrics["volume_ratio"].min == pytest.approx(1 / 3, rel=1e-13)
    # half of 1 over half of 1 + 3
    assert metrics["face_weight"].min == pytest.approx(0.25, rel=1e-13)
    assert metrics["non_orthogonality"].max == pytest.approx(0.0, abs=1e-6)
    # 3 x 1 against 1 x 1
    assert metrics["aspect_ratio"].max == pytest.approx(3.0, rel=1e-13)
    # internal faces in one direction only carry no gradient across
    assert metrics["determinant"].max == 0.0


@pytest.mark.parametrize("angle", [10.0, 45.0, 69.0])
def test_slanted_bricks_are_non_orthogonal_by_their_slant(angle: float) -> None:
    metric = judge(bricks([1.0, 1.0, 1.0], math.tan(math.radians(angle)))).metrics["non_orthogonality"]
    assert metric.max == pytest.approx(angle, rel=1e-9)
    assert metric.mean == pytest.approx(angle, rel=1e-9)


def test_a_face_above_the_limit_warns_and_is_counted_and_placed() -> None:
    settings = QualitySettings(non_orthogonality=30.0, determinant=1e-9)
    mesh = duct((6, 6, 12), hole=False, jitter=0.2).face_mesh()
    report = judge(mesh, settings)
    metric = report.metrics["non_orthogonality"]
    values = dict(measure(mesh))["non_orthogonality"]
    assert metric.over_limit == int((values > 30).sum()) > 0
    index, value, place = metric.worst[0]
    assert value == metric.max == values[index]
    assert place == pytest.approx(mesh.polyhedra().centers[index], rel=1e-12)
    assert any("internal faces above 30 degree" in reason for reason in report.reasons)


def slanted_cubes(angle: float, n: int = 3) -> FaceMesh:
    """Stack n x n x n unit cubes, layer upon layer shifted so that the lines between their centers lean by `angle`."""
    grid = np.stack(np.meshgrid(*(np.arange(n + 1),) * 3, indexing="ij"), axis=-1).astype(float).reshape(-1, 3)
    low = np.stack(np.meshgrid(*(np.arange(n),) * 3, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    around = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    cubes = np.ravel_multi_index(tuple(np.moveaxis(low + around, -1, 0)), (n + 1,) * 3)
    found = cell_faces(polygons_of("hexahedron", cubes), np.repeat(np.arange(n**3), 6))
    points = grid + math.tan(math.radians(angle)) * grid[:, 2:] * np.array([1.0, 0.0, 0.0])
    corners, internal = found.polygons.ravel(), len(found.neighbour)
    patches = (Patch("all", internal, len(found.owner) - internal),)
    return FaceMesh(points, corners, np.arange(0, len(corners) + 1, 4), found.owner, found.neighbour, n**3, patches)


@pytest.mark.parametrize(("angle", "verdict"), [(0.0, "pass"), (69.0, "pass"), (71.0, "warn"), (75.0, "warn")])
def test_faces_between_70_and_90_degrees_are_a_warning(angle: float, verdict: str) -> None:
    report = judge(slanted_cubes(angle))
    metric = report.metrics["non_orthogonality"]
    assert metric.max == pytest.approx(angle, abs=1e-5)
    # the lines between 3 layers lean off their 2 x 9 faces, and the 2 x 9 faces across x lean off their lines
    assert metric.over_limit == {"pass": 0, "warn": 2 * 9 + 2 * 9}[verdict]
    assert report.verdict == verdict
    assert report.passed is (verdict == "pass")


def test_a_stricter_limit_of_the_user_counts() -> None:
    cubes = slanted_cubes(0.0)
    weights = judge(cubes, QualitySettings(face_weight=0.6))
    assert weights.metrics["face_weight"].over_limit == 54
    assert weights.verdict == "warn"
    assert judge(cubes, QualitySettings(aspect_ratio=0.5)).verdict == "fail"


def test_a_folded_cell_of_a_micrometer_does_not_slip_through() -> None:
    # checkMesh compares pyramids with 1e-15 m3 and sees nothing here
    mesh = bricks([1e-6, 1e-6, 1e-6])
    points = mesh.points * np.array([1.0, 1e-6, 1e-6])
    points[4:8, 0] = 2.5e-6
    folded = FaceMesh(points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, mesh.cells, mesh.patches)
    report = judge(folded)
    assert report.verdict == "fail"
    assert report.metrics["volume"].over_limit == 1
    assert report.metrics["face_pyramid"].over_limit > 0


def test_parts_that_do_not_touch_are_noted_and_unused_points_fail() -> None:
    one = bricks([1.0, 1.0])
    n = len(one.points)
    points = np.concatenate([one.points, one.points + 10.0, [[5.0, 5.0, 5.0]]])
    inner = slice(0, 1)

    def twice(pick: slice) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
        mine = one.corners.reshape(-1, 4)[pick]
        return np.concatenate([mine, mine + n])

    corners = np.concatenate([twice(inner), twice(slice(1, None))]).ravel()
    owner = np.concatenate([[0, 2], one.owner[1:], one.owner[1:] + 2])
    faces = len(owner)
    patches = (Patch("walls", 2, faces - 2),)
    mesh = FaceMesh(points, corners, np.arange(0, 4 * faces + 1, 4), owner, np.array([1, 3]), 4, patches)
    report = judge(mesh)
    # checkMesh says "Mesh OK" of bodies that do not touch, and fails on points without faces
    assert report.notes == ("2 parts of the mesh share no face, the smallest has 2 cells",)
    assert "1 points belong to no face" in " ".join(report.reasons)
    assert report.verdict == "fail"


def test_metrics_do_not_depend_on_the_unit_of_length() -> None:
    mesh = duct(jitter=0.2)
    small = TetMesh(mesh.points * 1e-6, mesh.tets, mesh.faces, mesh.patch, mesh.patches, mesh.slab)
    large, tiny = dict(measure(mesh.face_mesh())), dict(measure(small.face_mesh()))
    for name in QualitySettings.model_fields:
        # an angle near 0 knows half the digits of its cosine, in degrees
        assert tiny[name] == pytest.approx(large[name], rel=1e-7, abs=1e-5), name


def test_a_cell_shows_the_worst_of_its_faces() -> None:
    mesh = duct(jitter=0.2).face_mesh()
    fields, values = cell_fields(mesh), dict(measure(mesh))
    for name, worst in (("non_orthogonality", max), ("skewness", max), ("face_weight", min), ("volume_ratio", min)):
        of_cell: list[list[float]] = [[] for _ in range(mesh.cells)]
        for face, value in enumerate(values[name].tolist()):
            of_cell[mesh.owner[face]].append(value)
            if face < mesh.internal:
                of_cell[mesh.neighbour[face]].append(value)
        assert fields[name].tolist() == [worst(found) for found in of_cell]
