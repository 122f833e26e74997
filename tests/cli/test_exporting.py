"""`fibertwin export`, and what becomes of a run when one of its formats cannot be written."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh

from pipeline.export.formats.registry import WRITTEN
from pipeline.export.read import read_mesh
from pipeline.line.manifest import damaged, read_manifest
from pipeline.line.places import remove
from pipeline.line.run import Run
from pipeline.mat.exchange import read_fibers
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.surface import Surface
from tests.cli.conftest import Fibertwin
from tests.cli.conftest import fibertwin as fibertwin  # the fixture

LATTICE = ("--set", "tetmesh.engine=lattice")


@pytest.fixture(scope="module", name="finished")
def _finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from pipeline.case import read_case
    from pipeline.cli.bundled import bundled
    from pipeline.line.run import run

    folder = tmp_path_factory.mktemp("runs") / "smoke"
    run(read_case(bundled()["smoke"], ("tetmesh.engine=lattice", 'export.formats=["openfoam"]')), folder, "export")
    return folder


@pytest.mark.parametrize("name", WRITTEN)
def test_any_format_is_written_of_a_finished_run(fibertwin: Fibertwin, finished: Path, name: str) -> None:
    before = {stage.name: read_manifest(stage) for stage in finished.iterdir() if stage.is_dir()}
    said = fibertwin("export", finished, "--format", name, "--json")
    assert said.code == 0
    place = Path(json.loads(said.out)[name])
    assert any(path.is_file() for path in place.rglob("*"))
    # nothing was run again, and what the run made still holds
    assert {stage: read_manifest(finished / stage) for stage in before} == before
    assert not damaged(finished / "export", read_manifest(finished / "export") or {})


def test_what_it_writes_is_what_the_run_has(fibertwin: Fibertwin, finished: Path, tmp_path: Path) -> None:
    said = fibertwin(
        "export", finished, "--out", tmp_path, "--set", "export.length_unit=mm", "--quiet",
        *(word for name in ("csv", "spaceclaim", "stl", "fluent", "nastran") for word in ("--format", name)),
    )  # fmt: skip
    assert (said.code, said.out, said.err) == (0, "", "")
    run = Run.opened(finished)
    mat, surface, mesh = run.read(Mat), run.read(Surface), run.read(FaceMesh)
    assert np.array_equal(read_fibers(tmp_path / "csv/fibers.csv").nodes, mat.nodes)
    assert len(np.loadtxt(tmp_path / "spaceclaim/cylinders.txt")) == mat.segments
    solid = trimesh.load_mesh(tmp_path / "stl/surface.stl")
    assert solid.volume == pytest.approx(surface.volume * 1e9, rel=1e-5)
    for file in ("fluent/mesh.msh", "nastran/mesh.bdf"):
        found = read_mesh(tmp_path / file)
        # nastran's nine digits and more
        assert found.volume == pytest.approx(mesh.volume, rel=1e-8)
        assert {patch.name: patch.count for patch in found.patches} == {p.name: p.count for p in mesh.patches}


def test_the_fibers_patch_of_vtk_has_the_number_of_the_fiber_it_lies_on(
    fibertwin: Fibertwin, finished: Path, tmp_path: Path
) -> None:
    import pyvista as pv

    assert fibertwin("export", finished, "--format", "vtk", "--out", tmp_path, "--quiet").code == 0
    wall = pv.read(tmp_path / "vtk/boundary/fibers.vtp")
    mat = Run.opened(finished).read(Mat)
    centers, number = wall.cell_centers().points, np.asarray(wall.cell_data["fiber"])
    start = mat.segment_starts()
    begin, end = mat.nodes[start], mat.nodes[start + 1]
    axis = end - begin
    # distance of each face from each segment's wall
    share = np.clip(np.einsum("fsk,sk->fs", centers[:, None] - begin, axis) / (axis**2).sum(axis=1), 0, 1)
    away = np.linalg.norm(centers[:, None] - begin - share[..., None] * axis, axis=2) - mat.radius[mat.segment_fibers()]
    own = np.where(mat.segment_fibers() == number[:, None], away, np.inf).min(axis=1)
    # all lie on their own fiber's wall, within a tenth of its diameter, but for bridges where fibers meet
    assert (np.abs(own) < 0.2 * mat.radius.max()).mean() > 0.98
    assert len(np.unique(number)) > 1


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((), "--format is missing"),
        (("--format", "dwg"), "unknown; known: openfoam, vtk"),
        (("--format", "med"), "needs HDF5"),
        (("--format", "stl", "--set", "mat.seed=2"), "only keys of export"),
        (("--format", "openfoam", "--set", "export.encoding=ascii"), "choose a folder with --out"),
    ],
)
def test_a_wrong_command_is_one_line(fibertwin: Fibertwin, finished: Path, words: tuple[str, ...], told: str) -> None:
    said = fibertwin("export", finished, *words)
    assert said.code == 2
    assert told in said.err
    assert said.err.count("\n") == 1


def test_a_format_that_fails_leaves_the_others_and_the_run(
    fibertwin: Fibertwin, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import dataclasses

    from pipeline.errors import StageError
    from pipeline.export import write

    def fails(*_: object) -> None:
        raise StageError("it does not like Tuesdays")

    broken = {**WRITTEN, "su2": dataclasses.replace(WRITTEN["su2"], write=fails)}
    monkeypatch.setattr(write, "WRITTEN", broken)
    out = tmp_path / "run"
    said = fibertwin(
        "run", "smoke", "--out", out, *LATTICE, "--set", 'export.formats=["su2", "openfoam", "gmsh"]', "--until",
        "compare",
    )  # fmt: skip
    assert said.code == 1
    assert "export: cannot write su2: it does not like Tuesdays" in said.err
    assert sorted(path.name for path in (out / "export").iterdir()) == ["gmsh", "manifest.json", "openfoam"]
    assert (out / "compare/comparison.json").is_file()


def test_a_lone_format_that_fails_is_an_error_of_its_stage(fibertwin: Fibertwin, tmp_path: Path) -> None:
    # cyclic sides are Fluent's own business
    said = fibertwin(
        "run", "smoke", "--out", tmp_path / "run", "--set", 'export.formats=["fluent"]', "--set", "mat.periodic=true",
        "--set", "enclosure.sides=cyclic", *LATTICE, "--until", "export", "--quiet",
    )  # fmt: skip
    assert said.code in (1, 2)
    assert said.err.count("error: ") == 1


def test_a_folder_in_which_somebody_keeps_something_else_stays(
    fibertwin: Fibertwin, finished: Path, tmp_path: Path
) -> None:
    (tmp_path / "stl" / "mine").mkdir(parents=True)
    (tmp_path / "stl" / "mine" / "thesis").write_text("three years")
    said = fibertwin("export", finished, "--format", "stl", "--out", tmp_path, "--quiet")
    assert said.code == 1
    assert "stl holds 2 files and folders that this export does not write, first mine; move them" in said.err
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["mine", "stl", "thesis"]
    # what an export wrote is written again
    for _ in range(2):
        assert fibertwin("export", finished, "--format", "csv", "--out", tmp_path, "--quiet").code == 0


@pytest.mark.parametrize("place", ["export", "export/csv", "export/.csv.partial"])
def test_no_link_in_a_run_blocks_an_export_or_is_followed(
    fibertwin: Fibertwin, finished: Path, tmp_path: Path, place: str
) -> None:
    run, outside = tmp_path / "run", tmp_path / "outside"
    shutil.copytree(finished, run)
    outside.mkdir()
    remove(run / place)
    (run / place).symlink_to(outside)
    for _ in range(2):
        said = fibertwin("export", run, "--format", "csv", "--quiet")
        assert said.code == 0, said.err
    assert not list(outside.iterdir())
    assert [path.name for path in (run / "export" / "csv").iterdir()] == ["fibers.csv"]
