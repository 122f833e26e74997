"""The whole line on the smoke case, held against OpenFOAM, VTK and the laws it must keep."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from pipeline.case import Case, read_case
from pipeline.geometry.tets import volumes
from pipeline.line import store
from pipeline.line.run import Run, run
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.nouns.patches import FIBERS, PATCHES
from pipeline.nouns.quality import QualityReport
from pipeline.solve.settings import SolveSettings
from tests.openfoam import figures, foam, patches

SMOKE = Path(__file__).parents[2] / "cases" / "smoke.toml"


def command(*words: str | Path) -> list[str]:
    return [sys.executable, "-m", "pipeline.cli", *map(str, words)]


def json_of(path: Path) -> dict[str, object]:
    content = json.loads(path.read_text())
    assert isinstance(content, dict)
    return content


def test_the_fixed_keys_of_the_results_are_there(smoke: Run) -> None:
    measures = json_of(smoke.folder / "mat" / "measures.json")
    assert {"fibers", "segments", "coverage", "thickness", "solidity"} <= measures.keys()
    quality = json_of(smoke.folder / "quality" / "quality.json")
    assert {"cells", "points", "faces", "metrics", "verdict"} <= quality.keys()
    metrics = quality["metrics"]
    assert isinstance(metrics, dict)
    figures_of = {"min", "mean", "p99", "max", "limit", "over_limit"}
    for name in [
        "non_orthogonality",
        "skewness",
        "aspect_ratio",
        "determinant",
        "face_weight",
        "volume_ratio",
        "volume",
    ]:
        assert figures_of <= metrics[name].keys()
    comparison = json_of(smoke.folder / "compare" / "comparison.json")
    assert isinstance(comparison["models"], dict)
    for model in ("davies", "kuwabara", "happel"):
        assert {"nominal", "surface", "mesh"} <= comparison["models"][model].keys()


def test_volume_is_kept_from_the_surface_to_the_mesh(smoke: Run) -> None:
    domain, mesh = smoke.read(FluidDomain), smoke.read(FaceMesh)
    solid = domain.box.volume - domain.volume
    assert mesh.volume == pytest.approx(domain.volume, abs=smoke.case.tetmesh.volume_error * solid)
    # no wall is moved for the volume's sake: air that is bridged where fibers meet is a percent of the fibers
    assert mesh.volume == pytest.approx(domain.volume, abs=0.01 * solid)
    fidelity = smoke.read(TetmeshMeasures).fidelity
    assert fidelity is not None
    assert np.mean(np.abs(fidelity.radius_error)) < 0.01
    comparison = smoke.read(Comparison)
    assert comparison.solidity["mesh"] == pytest.approx(comparison.solidity["surface"], rel=0.01)
    assert comparison.solidity["nominal"] > comparison.solidity["surface"]  # overlaps are counted twice there


def test_the_mesh_fills_the_duct_and_its_planes_are_flat(smoke: Run) -> None:
    mesh, box = smoke.read(FaceMesh), smoke.read(FluidDomain).box
    assert tuple(patch.name for patch in mesh.patches) == PATCHES
    shape = mesh.polyhedra()
    assert (shape.volumes > 0).all()
    vectors = shape.areas[mesh.internal :]
    np.testing.assert_allclose(vectors.sum(axis=0), 0, atol=1e-12 * np.abs(vectors).sum())
    walls = {"inlet": (2, 0), "outlet": (2, 1), "xmin": (0, 0), "xmax": (0, 1), "ymin": (1, 0), "ymax": (1, 1)}
    for name, (axis, end) in walls.items():
        plane = (box.lower, box.upper)[end][axis]
        corners = mesh.points[mesh.triangles()[mesh.patch(name)]]
        assert (corners[..., axis] == plane).all()  # to the bit: OpenFOAM's symmetry plane asks for 3e-8 rad
    inlet = np.linalg.norm(shape.areas[mesh.patch("inlet")], axis=1).sum()
    assert inlet == pytest.approx(box.face_area, rel=1e-12)


def test_the_fibers_patch_lies_on_the_fibers(smoke: Run) -> None:
    from scipy.spatial import cKDTree

    mesh, domain = smoke.read(FaceMesh), smoke.read(FluidDomain)
    unit = 2 * domain.radius.mean()
    triangles = domain.triangles[domain.patch == PATCHES.index(FIBERS)]
    weights = np.random.default_rng(0).dirichlet(np.ones(3), (len(triangles), 60))
    cloud = np.einsum("tsk,tkx->tsx", weights, domain.points[triangles]).reshape(-1, 3)
    on_wall = np.unique(mesh.triangles()[mesh.patch(FIBERS)])
    distance, _ = cKDTree(cloud).query(mesh.points[on_wall])
    # .04 of an envelope; what repairing may move a wall, the move onto the fibers, and the gaps of the sampled cloud
    assert np.percentile(distance, 99) < 0.1 * unit


def test_finished_stages_are_reused_and_forced_ones_are_made_again(smoke: Run) -> None:
    again = run(smoke.case, smoke.folder, until="compare")
    assert {outcome.how for outcome in again} == {"reused"}
    before = (smoke.folder / "mat" / "mat.npz").read_bytes()
    forced = run(smoke.case, smoke.folder, until="compare", force=frozenset({"mat"}))
    assert [outcome.how for outcome in forced] == ["made", *["reused"] * 6]  # the same mat, byte by byte
    assert (smoke.folder / "mat" / "mat.npz").read_bytes() == before


def test_another_seed_makes_every_stage_again_and_another_limit_only_quality(smoke: Run, tmp_path: Path) -> None:
    run(smoke.case, tmp_path, until="enclosure")
    other = smoke.case.model_copy(update={"mat": smoke.case.mat.model_copy(update={"seed": 2})})
    assert {outcome.how for outcome in run(other, tmp_path, until="enclosure")} == {"made"}
    stricter = smoke.case.quality.model_copy(update={"skewness": 3.0})
    outcomes = run(smoke.case.model_copy(update={"quality": stricter}), smoke.folder, until="compare")
    assert [outcome.stage for outcome in outcomes if outcome.how == "made"] == ["quality"]
    run(smoke.case, smoke.folder, until="quality")


def test_a_damaged_file_is_made_again(smoke: Run, tmp_path: Path) -> None:
    run(smoke.case, tmp_path, until="surface")
    (tmp_path / "mat" / "mat.npz").write_bytes(b"damaged")
    assert [outcome.how for outcome in run(smoke.case, tmp_path, until="surface")] == ["made", "reused"]


def test_a_killed_run_leaves_whole_stages_and_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    # fTetWild takes seconds, enough to be killed in
    child = subprocess.Popen(
        command("run", SMOKE, "--out", folder, "--set", "tetmesh.engine=tetwild"),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    deadline = time.monotonic() + 120
    while not (folder / "enclosure").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    os.kill(child.pid, signal.SIGKILL)
    child.wait()
    assert not (folder / "tetmesh").exists()
    outcomes = run(read_case(SMOKE), folder, until="enclosure")
    assert {outcome.how for outcome in outcomes} == {"reused"}
    # what was half written stands aside, and nothing but stages stands in the folder
    left = {path.name for path in folder.iterdir()} - {".tetmesh.partial"}
    assert left == {"case.json", ".lock", "mat", "surface", "enclosure"}


def test_a_reopened_run_is_the_same(smoke: Run) -> None:
    assert Run.opened(smoke.folder).case == smoke.case


def test_pyvista_reads_the_written_mesh_with_its_patches(smoke: Run) -> None:
    import pyvista

    blocks = pyvista.read(smoke.folder / "export" / "vtk" / "mesh.vtm")
    internal = blocks["internal"]
    assert internal.n_cells == smoke.read(QualityReport).cells
    assert internal.volume == pytest.approx(smoke.read(FaceMesh).volume, rel=1e-6)
    assert set(blocks["boundary"].keys()) == set(PATCHES)


@pytest.mark.openfoam
def test_checkmesh_says_mesh_ok_and_agrees_to_five_digits(smoke: Run) -> None:
    text = foam(smoke.folder / "export" / "openfoam", "checkMesh")
    assert "Mesh OK." in text
    said, ours = figures(text), smoke.read(QualityReport)
    assert patches(text) == ours.patches
    assert set(patches(text)) == set(PATCHES)
    metrics = ours.metrics
    assert metrics["non_orthogonality"].max == pytest.approx(said["max_non_orthogonality"], rel=1e-5)
    assert metrics["non_orthogonality"].mean == pytest.approx(said["mean_non_orthogonality"], rel=1e-5)
    assert metrics["skewness"].max == pytest.approx(said["max_skewness"], rel=1e-5)
    assert metrics["aspect_ratio"].max == pytest.approx(said["max_aspect_ratio"], rel=1e-5)
    assert metrics["volume"].min == pytest.approx(said["min_volume"], rel=1e-5)
    assert ours.volume == pytest.approx(said["total_volume"], rel=1e-5)


@pytest.mark.openfoam
def test_the_written_case_converges_and_keeps_mass(smoke: Run, tmp_path: Path) -> None:
    import shutil

    case = tmp_path / "case"
    shutil.copytree(smoke.folder / "export" / "openfoam", case)
    text = foam(case, "simpleFoam")
    assert "SIMPLE solution converged" in text
    flows = {}
    for name in ("inletFlow", "outletFlow"):
        table = next((case / "postProcessing" / name).glob("*/*.dat")).read_text().splitlines()
        flows[name] = float(table[-1].split()[1])
    assert flows["outletFlow"] == pytest.approx(-flows["inletFlow"], rel=1e-5)
    flow = smoke.case.flow.flow()
    assert -flows["inletFlow"] == pytest.approx(flow.face_velocity * smoke.read(FluidDomain).box.face_area, rel=1e-9)
    table = next((case / "postProcessing" / "inletPressure").glob("*/*.dat")).read_text().splitlines()
    drop = flow.density * float(table[-1].split()[1])
    # correlations of random media spread by 2.5: this one must at least be in their company
    models = [row.mesh for row in smoke.read(Comparison).models.values()]
    assert 0.5 * min(models) < drop < 2 * max(models)


def test_without_openfoam_the_solver_is_skipped_with_the_reason(smoke: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    case = smoke.case.model_copy(update={"solve": SolveSettings(engine="openfoam")})
    outcomes = run(case, smoke.folder, until="solve")
    skipped = next(outcome for outcome in outcomes if outcome.stage == "solve")
    assert skipped.how == "skipped"
    assert "OpenFOAM" in str(skipped.counts["reason"]) or "PATH" in str(skipped.counts["reason"])


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["mat.side=20"], 2, "mat.side"),
        (["mat.fiber_diameter=-1 um"], 2, "mat.fiber_diameter"),
        (["mat.relaxation_slope=steep"], 2, "mat.relaxation_slope"),
        (["mat.colour=red"], 2, "mat.colour: unknown key"),
        (["mat.stop.coverage=1e7"], 2, "fibers"),
        (["enclosure.inlet=0.1 nm", "mat.stop.count=3"], 1, "enclosure.inlet"),
        (["tetmesh.engine=tetwild", "tetmesh.tetwild.time_limit=0.01 s"], 1, "tetmesh.tetwild.time_limit"),
        (["tetmesh.engine=tetwild", "tetmesh.memory_limit=1 MB"], 1, "tetmesh.memory_limit"),
        (["tetmesh.memory_limit=0.1 MB"], 1, "tetmesh.memory_limit"),
    ],
)
def test_nonsense_gets_one_clear_error_and_nothing_half_written(
    words: list[str], code: int, message: str, tmp_path: Path
) -> None:
    options = [part for word in words for part in ("--set", word)]
    done = subprocess.run(
        command("run", SMOKE, "--out", tmp_path / "run", *options), capture_output=True, text=True, check=False
    )
    assert done.returncode == code, done.stderr
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    left = [path.name for path in (tmp_path / "run").iterdir()] if (tmp_path / "run").exists() else []
    assert not [name for name in left if "partial" in name or name == "tetmesh"]
    if code == 2:
        assert left == []


def test_a_folder_that_cannot_be_written_is_a_clear_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = subprocess.run(
        command("run", SMOKE, "--out", tmp_path / "file" / "run"), capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "cannot write" in done.stderr
    assert "Traceback" not in done.stderr


def test_mesh_and_faces_are_the_same_mesh(smoke: Run) -> None:
    mesh: FaceMesh = smoke.read(FaceMesh)
    tets = mesh.tets()
    assert mesh.cells == len(tets)
    boundary = mesh.faces - mesh.internal
    assert mesh.faces == 2 * mesh.cells + boundary // 2
    cells = volumes(mesh.points, tets)
    assert (cells > 0).all()
    assert math.isclose(float(cells.sum()), mesh.volume, rel_tol=1e-12)
    assert math.isclose(float(mesh.polyhedra().volumes.sum()), mesh.volume, rel_tol=1e-12)


def test_doctor_and_schema_answer() -> None:
    doctor = subprocess.run(command("doctor"), capture_output=True, text=True, check=False)
    assert doctor.returncode == 0, doctor.stdout + doctor.stderr
    assert "numpy" in doctor.stdout
    schema = subprocess.run(command("schema"), capture_output=True, text=True, check=True)
    assert json.loads(schema.stdout)["title"] == Case.__name__


def test_manifests_say_what_made_each_stage(smoke: Run) -> None:
    for stage in ("mat", "surface", "enclosure", "tetmesh", "quality", "export", "compare"):
        manifest = smoke.manifest(stage)
        assert manifest is not None
        assert {"key", "parameters", "inputs", "code", "libraries", "seconds", "counts", "files"} <= manifest.keys()
        for name, digest in manifest["files"].items():
            assert store.file_digest(smoke.folder / stage / name) == digest
            assert re.fullmatch("[0-9a-f]{64}", digest)


def test_pyvistas_own_reader_takes_the_openfoam_case(smoke: Run) -> None:
    import pyvista

    reader = pyvista.OpenFOAMReader(smoke.folder / "export" / "openfoam" / "case.foam")
    blocks = reader.read()
    internal = blocks["internalMesh"]
    assert internal.n_cells == smoke.read(QualityReport).cells
    # its points are 32-bit floats
    assert internal.volume == pytest.approx(smoke.read(FaceMesh).volume, rel=1e-4)
    # a MultiBlock iterates over its blocks, not over their names
    faces = {name: blocks["boundary"][name].n_cells for name in blocks["boundary"].keys()}  # noqa: SIM118
    assert faces == smoke.read(QualityReport).patches
