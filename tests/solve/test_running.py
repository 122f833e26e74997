# SPDX-License-Identifier: GPL-3.0-or-later

import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.errors import StageError
from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.nouns.flow import Flow
from pipeline.openfoam.environment import openfoam_missing
from pipeline.solve.bed import Bed
from pipeline.solve.running import seconds_spent, settling, solve
from pipeline.solve.settings import OpenFoamSettings
from pipeline.solve.states import saved
from tests.openfoam import AIR
from tests.sample_meshes import duct
from tests.security.inputs import in_time

SIZE = (10e-6, 10e-6, 20e-6)
# a bar of 4 um in a slab of 10 um
BED = Bed(face_area=1e-10, thickness=10e-6, pressure_factor=1.0, fiber_length=10e-6)


def bar_case(folder: Path, flow: Flow = AIR, cells: int = 10) -> Path:
    mesh = duct((cells, cells, 2 * cells), SIZE, jitter=0.2).face_mesh()
    write_openfoam(mesh, folder, flow)
    return folder


@pytest.mark.openfoam
def test_drag_balances_the_pressure_drop_and_mass_is_kept(tmp_path: Path) -> None:
    told: list[tuple[str, float | None]] = []

    def listen(what: str, done: float | None = None) -> None:
        told.append((what, done))

    found = solve(bar_case(tmp_path / "case"), tmp_path / "work", AIR, BED, progress=listen)
    assert found.converged
    assert found.flow_rate == pytest.approx(0.025 * 1e-10, rel=1e-9)
    assert abs(found.force_balance_error) < 0.01
    assert abs(found.mass_balance_error) < 1e-5
    assert found.permeability == pytest.approx(1.8e-5 * 0.025 * 10e-6 / found.pressure_drop, rel=1e-12)
    # with f = 1 the diameter is the root of Darcy's permeability
    assert found.effective_fiber_diameter == pytest.approx(found.permeability**0.5, rel=1e-12)
    assert found.f_star == pytest.approx(found.drag / (10e-6 * 1.8e-5 * 0.025), rel=1e-12)
    iterations = [what for what, _ in told if "pressure drop" in what and "residuals" in what]
    assert iterations
    assert all(0 <= done <= 1 for _, done in told if done is not None)


@pytest.mark.openfoam
def test_creeping_flow_scales_with_velocity_and_viscosity(tmp_path: Path) -> None:
    # Stokes: the pressure drop is proportional to both
    fast = replace(AIR, face_velocity=0.05, viscosity=3.6e-5)
    drops = [
        solve(
            bar_case(tmp_path / name, flow, 6), tmp_path / f"{name}.work", flow, BED, OpenFoamSettings(tolerance=1e-6)
        ).pressure_drop
        for name, flow in (("slow", AIR), ("fast", fast))
    ]
    assert drops[1] / drops[0] == pytest.approx(4.0, rel=2e-3)


@pytest.mark.openfoam
def test_two_cores_give_the_same_pressure_drop(tmp_path: Path) -> None:
    case = bar_case(tmp_path / "case", cells=4)
    one, two = (
        solve(case, tmp_path / f"work{cores}", AIR, BED, OpenFoamSettings(cores=cores, tolerance=1e-5))
        for cores in (1, 2)
    )
    # the multigrid of each part differs, and the solver itself stops at residuals of 1e-5
    assert two.pressure_drop == pytest.approx(one.pressure_drop, rel=1e-3)
    # both settled where their last look says
    for work, found in ((tmp_path / "work1", one), (tmp_path / "work2", two)):
        (curve,) = settling(work, AIR, "no_slip").curves
        assert curve.iterations[-1] == found.iterations
        assert curve.pressure_drop[-1] == found.pressure_drop
        assert seconds_spent(work) > 0.0


@pytest.mark.openfoam
def test_a_run_that_ends_early_says_so_and_is_continued(tmp_path: Path) -> None:
    case = bar_case(tmp_path / "case", cells=6)
    early = solve(case, tmp_path / "work", AIR, BED, OpenFoamSettings(max_iterations=25, window=20, tolerance=1e-6))
    assert not early.converged
    assert early.iterations == 25
    whole = solve(case, tmp_path / "work", AIR, BED, OpenFoamSettings(tolerance=1e-6))
    assert whole.converged
    assert (tmp_path / "work/postProcessing/inletPressure/25").is_dir()
    fresh = solve(case, tmp_path / "fresh", AIR, BED, OpenFoamSettings(tolerance=1e-6))
    assert whole.pressure_drop == pytest.approx(fresh.pressure_drop, rel=1e-4)


@pytest.mark.openfoam
def test_a_run_killed_at_once_leaves_no_solver_behind_and_goes_on(tmp_path: Path) -> None:
    import psutil

    bar_case(tmp_path / "case", cells=10)
    program = (
        "from pathlib import Path; from pipeline.solve.running import solve; from tests.openfoam import AIR\n"
        "from pipeline.solve.settings import OpenFoamSettings; from tests.solve.test_running import BED\n"
        f"solve(Path({str(tmp_path / 'case')!r}), Path({str(tmp_path / 'work')!r}), AIR, BED,"
        " OpenFoamSettings(tolerance=1e-9))"
    )
    victim = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 60
    log = tmp_path / "work/log.simpleFoam"
    while not (log.exists() and "Time = 20\n" in log.read_text()):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    solvers = [child for child in psutil.Process(victim.pid).children(recursive=True) if child.name() == "simpleFoam"]
    assert len(solvers) == 1
    victim.kill()
    victim.wait()
    psutil.wait_procs(solvers, timeout=10)
    assert not solvers[0].is_running()
    assert "SIMPLE solution converged" not in log.read_text()
    assert solve(tmp_path / "case", tmp_path / "work", AIR, BED).converged


@pytest.mark.openfoam
def test_another_case_in_the_same_place_starts_over(tmp_path: Path) -> None:
    settings = OpenFoamSettings(max_iterations=5)
    solve(bar_case(tmp_path / "case", cells=4), tmp_path / "work", AIR, BED, settings)
    fast = replace(AIR, face_velocity=0.05)
    found = solve(bar_case(tmp_path / "case", fast, cells=4), tmp_path / "work", fast, BED, settings)
    assert found.iterations == 5
    assert found.flow_rate == pytest.approx(0.05e-10, rel=1e-9)


@pytest.mark.openfoam
def test_a_diverged_run_is_an_error_with_the_end_of_its_log(tmp_path: Path) -> None:
    # next to no relaxation at a Reynolds number of 1e10: numbers grow to 1e160 and no trap is sprung
    wild = replace(AIR, face_velocity=1e6, viscosity=1e-9)
    with pytest.raises(StageError, match=r"(?s)simpleFoam diverged after \d+ iterations; .* which ends:\n.*\w"):
        solve(bar_case(tmp_path / "case", wild, cells=4), tmp_path / "work", wild, BED)


@pytest.mark.openfoam
def test_a_broken_case_is_an_error_that_names_the_cause(tmp_path: Path) -> None:
    case = bar_case(tmp_path / "case", cells=4)
    (case / "0/p").unlink()
    with pytest.raises(StageError, match=r"(?s)before its first iteration.*cannot find file"):
        solve(case, tmp_path / "work", AIR, BED)


def test_without_openfoam_the_reason_and_the_cure_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert "simpleFoam not found on the PATH; on Debian" in str(openfoam_missing())
    case = bar_case(tmp_path / "case", cells=4)
    with pytest.raises(StageError, match="decomposePar and mpirun"):
        solve(case, tmp_path / "work", AIR, BED, OpenFoamSettings(cores=2))
    assert not (tmp_path / "work").exists()


@pytest.mark.openfoam
@pytest.mark.parametrize("cores", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_two_solves_of_one_case_give_the_same_digits(cores: int, tmp_path: Path) -> None:
    case = bar_case(tmp_path / "case", cells=6)
    settings = OpenFoamSettings(cores=cores)
    found = [solve(case, tmp_path / f"work{k}", AIR, BED, settings) for k in range(2)]
    assert found[0] == found[1]
    assert found[0].converged
    # whoever looks later at the tables and fields finds the same too
    assert saved(tmp_path / "work0")[-1] == found[0].iterations
    files = [
        {
            str(path.relative_to(tmp_path / f"work{k}")): path.read_bytes()
            for path in (tmp_path / f"work{k}").rglob("*")
            # how many states stay depends on how far the solver went before it was ended
            if path.is_file() and (path.name.endswith(".dat") or path.parent.name == str(found[0].iterations))
        }
        for k in range(2)
    ]
    assert files[0] == files[1]
    assert len(files[0]) > 5


@pytest.mark.openfoam
def test_a_solve_that_is_killed_again_and_again_ends_with_the_digits_of_one_that_is_not(tmp_path: Path) -> None:
    case = bar_case(tmp_path / "case", cells=9)
    program = (
        "from pathlib import Path; from pipeline.solve.running import solve; from tests.openfoam import AIR\n"
        "from tests.solve.test_running import BED\n"
        f"solve(Path({str(case)!r}), Path({str(tmp_path / 'work')!r}), AIR, BED)"
    )
    log, seen = tmp_path / "work/log.simpleFoam", 0
    for _ in range(2):
        victim = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        # 25 more iterations: past the next saved state
        while victim.poll() is None and not (log.exists() and log.read_text().count("\nTime = ") >= seen + 25):
            assert time.monotonic() < deadline
            time.sleep(0.01)
        victim.kill()
        victim.wait()
        seen = log.read_text().count("\nTime = ")
    assert solve(case, tmp_path / "work", AIR, BED) == solve(case, tmp_path / "fresh", AIR, BED)


@pytest.mark.openfoam
def test_fields_that_were_half_written_are_not_gone_on_from(tmp_path: Path) -> None:
    case = bar_case(tmp_path / "case", cells=6)
    settings = OpenFoamSettings(max_iterations=40, tolerance=1e-9)
    solve(case, tmp_path / "work", AIR, BED, settings)
    half = tmp_path / "work/60"
    half.mkdir()
    (half / "U").write_text("FoamFile { cut")
    (tmp_path / "work/system/controlDict").write_text("cut too")
    again = solve(case, tmp_path / "work", AIR, BED, OpenFoamSettings(max_iterations=80, tolerance=1e-9))
    fresh = solve(case, tmp_path / "fresh", AIR, BED, OpenFoamSettings(max_iterations=80, tolerance=1e-9))
    assert again == fresh


@pytest.mark.openfoam
def test_a_solution_that_was_found_already_is_not_computed_again(tmp_path: Path) -> None:
    case = bar_case(tmp_path / "case", cells=6)
    first = solve(case, tmp_path / "work", AIR, BED)
    log = (tmp_path / "work/log.simpleFoam").read_text()
    assert solve(case, tmp_path / "work", AIR, BED) == first
    assert (tmp_path / "work/log.simpleFoam").read_text() == log


@pytest.mark.openfoam
@pytest.mark.parametrize("name", ["it's with blanks", 'a "größe";$HOME(c)'])
def test_a_case_is_solved_wherever_it_lies(name: str, tmp_path: Path) -> None:
    case = bar_case(tmp_path / name / "case", cells=4)
    for cores in (1, 2) if "blanks" in name else (1,):
        settings = OpenFoamSettings(cores=cores)
        assert solve(case, tmp_path / name / f"work{cores}", AIR, BED, settings).converged


@pytest.mark.openfoam
def test_what_a_case_holds_beside_its_files_is_not_copied(tmp_path: Path) -> None:
    # a pipe and a device would be read for good, and a link may lead to all of a disk
    case = bar_case(tmp_path / "case", cells=4)
    os.mkfifo(case / "constant" / "pipe")
    (case / "system" / "endless").symlink_to("/dev/zero")
    (case / "disk").symlink_to("/")
    with in_time():
        solve(case, tmp_path / "work", AIR, BED, OpenFoamSettings(max_iterations=5))
    assert {path.name for path in (tmp_path / "work").rglob("*")}.isdisjoint({"pipe", "endless", "disk"})
