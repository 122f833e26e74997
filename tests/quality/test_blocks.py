"""The verdict on a mesh is the same however it is cut into blocks, and large meshes fit into memory."""

# SPDX-License-Identifier: GPL-3.0-or-later

import tracemalloc

import numpy as np
import pytest

from pipeline.geometry import threads
from pipeline.mesh.engines.snappy.joining import joined
from pipeline.nouns.mesh import FaceMesh
from pipeline.quality import judge as judging
from pipeline.quality.judge import judge, judge_with_fields
from pipeline.quality.loops import worst_rows
from pipeline.quality.settings import QualitySettings
from tests.sample_meshes import cylinder, duct


def polyhedra() -> FaceMesh:
    """Tetrahedra of which many are joined with a neighbor, so that there are polyhedra, concave ones too."""
    mesh = duct(jitter=0.2).face_mesh()
    into = np.arange(mesh.cells)
    taken = np.zeros(mesh.cells, bool)
    for face in np.random.default_rng(5).permutation(mesh.internal):
        own, other = mesh.owner[face], mesh.neighbour[face]
        if not taken[own] and not taken[other] and own % 2 == 0:
            into[own] = other
            taken[[own, other]] = True
    return joined(mesh, into)[0]


MESHES = {"tetrahedra": lambda: duct(jitter=0.24).face_mesh(), "hexahedra": lambda: cylinder(0.1, 1e-6),
          "polyhedra": polyhedra}  # fmt: skip


@pytest.mark.parametrize("kind", MESHES)
def test_neither_blocks_nor_cores_change_a_digit(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = MESHES[kind]()
    # limits that some of the cells break, so that counts and places are compared too
    settings = QualitySettings(non_orthogonality=20.0, skewness=0.3, face_weight=0.45, volume_ratio=0.7)
    own = np.random.default_rng(2).random(mesh.cells) < 0.7
    seen = []
    for cores, least in ((1, 1000), (2, 7), (5, 50)):
        monkeypatch.setattr(threads, "cores", lambda cores=cores: cores)
        monkeypatch.setattr(judging, "cores", lambda cores=cores: cores)
        monkeypatch.setattr(threads, "_LEAST", least)
        monkeypatch.setattr(judging, "_LARGE", 1)
        report, fields = judge_with_fields(mesh, settings)
        seen.append((report, judge(mesh, settings, own=own), fields.values.tolist()))
    assert seen[1] == seen[0]
    assert seen[2] == seen[0]
    assert seen[0][0].metrics["volume_ratio"].over_limit > seen[0][1].metrics["volume_ratio"].over_limit > 0


def test_joined_cells_keep_volume_and_closed_surfaces() -> None:
    mesh, whole = polyhedra(), duct(jitter=0.2).face_mesh()
    report = judge(mesh)
    assert mesh.cells < whole.cells
    assert report.volume == pytest.approx(judge(whole).volume, rel=1e-13)
    assert report.metrics["openness"].max < 1e-14
    # two tetrahedra that are one cell have six faces, of which some look at each other from behind
    assert np.bincount(np.concatenate([mesh.owner, mesh.neighbour])).max() >= 6
    assert report.metrics["concavity"].over_limit > 0


def test_the_worst_are_those_that_sorting_finds() -> None:
    generator = np.random.default_rng(3)
    for count in (0, 1, 4, 5, 6, 1000):
        # whole numbers, so that many are equal: then the first of them count
        values = generator.integers(0, 20, count).astype(float)
        few = min(5, count)
        assert worst_rows(values, few, True).tolist() == np.argsort(-values, kind="stable")[:few].tolist()
        assert worst_rows(values, few, False).tolist() == np.argsort(values, kind="stable")[:few].tolist()


def test_judging_holds_a_few_numbers_per_cell() -> None:
    mesh = duct((24, 24, 24), jitter=0.2).face_mesh()
    judge_with_fields(mesh)
    tracemalloc.start()
    report, fields = judge_with_fields(mesh)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert report.cells == mesh.cells == fields.values.shape[1]
    # ten million cells in 4 GiB, of which the mesh itself takes 1: 300 bytes a cell for all that is made of them
    assert peak < 300 * mesh.cells
