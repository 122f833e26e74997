"""A solve that was stopped goes on where it was, to the same bits, whatever it finds of what was kept."""

# SPDX-License-Identifier: GPL-3.0-or-later

import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import pipeline.solve.stokes.kept as kept_module
from pipeline.line.store import read_json
from pipeline.nouns.arrays import Floats
from pipeline.progress import Progress
from pipeline.solve.stokes.creeping import creep
from pipeline.solve.stokes.duct import Duct
from pipeline.solve.stokes.inertia import with_inertia
from pipeline.solve.stokes.kept import KeptIterations, KeptSolve, keep_flow, kept_flow
from pipeline.solve.stokes.krylov import gmres
from pipeline.solve.stokes.solver import duct_of
from pipeline.solve.stokes.system import DuctFlow, System
from tests.processes.kills import CASE
from tests.solve.rows import rows


class StoppedError(Exception):
    """Somebody pulled the plug."""


@pytest.fixture(name="at_once")
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_module, "EVERY", 0.0)


def equations(size: int = 300) -> tuple[Floats, Floats]:
    """Linear equations that take some rounds of iterations."""
    draw = np.random.default_rng(3)
    matrix = np.diag(np.geomspace(1.0, 300.0, size)) + 0.1 * draw.standard_normal((size, size))
    return matrix, draw.standard_normal(size)


def iterated(memory: KeptIterations | None, stop: int = 10**9, restart: int = 20) -> tuple[Floats, int, list[int]]:
    """Solve the equations, stopped after so many products; give the solution, its iterations, and the products."""
    matrix, right = equations()
    count: list[int] = []

    def times(x: Floats) -> Floats:
        if len(count) == stop:
            raise StoppedError
        count.append(1)
        return matrix @ x

    def settled(iterations: int, x: Floats) -> bool:
        size = float(np.linalg.norm(right - matrix @ x))
        if memory is not None:
            memory.history.append((iterations, size))
            memory.residuals.append(size)
        return size < 1e-8

    found, iterations, done = gmres(
        times, lambda x: x, right, np.zeros_like(right), settled, restart=restart, memory=memory
    )
    assert done
    return found, iterations, count


@pytest.mark.usefixtures("at_once")
def test_iterations_that_were_stopped_anywhere_end_in_the_same_bits_with_fewer_products(tmp_path: Path) -> None:
    found, iterations, products = iterated(None)
    assert iterations > 60, "less than three rounds test little"
    draw = random.Random(7)
    for number in range(5):
        stop = draw.randrange(3, len(products))
        solve = KeptSolve(tmp_path / str(number))
        with pytest.raises(StoppedError):
            iterated(KeptIterations(solve, "flow"), stop)
        again = KeptSolve(tmp_path / str(number))
        memory = KeptIterations(again, "flow")
        same, count, fewer = iterated(memory)
        assert (same == found).all()
        assert count == iterations
        assert [at for at, _ in memory.history] == sorted({at for at, _ in memory.history})
        # a product at the start of each round, and the last vector of a round, are made again
        assert len(fewer) <= len(products) - stop + 4
        # twenty of the twenty-one products of a round are iterations
        assert again.iterations > stop * 20 / 21 - 4


def flow_of(system: System, folder: Path | None, told: Callable[[int], None], inertia: float = 0.0) -> DuctFlow:
    kept = KeptSolve(folder)
    size = system.duct.matrices.unknowns, system.duct.matrices.vertices
    flow = kept_flow(kept, "slip", *size)
    if flow is None:
        memory = KeptIterations(kept, "slip")
        flow = creep(system, 1e-4, 500, lambda at, *_: told(at), None, memory)
        keep_flow(kept, "slip", flow)
    if inertia:
        flow = with_inertia(system, inertia, 1e-4, 500, lambda at, *_: told(at), flow, kept, "carried")
    return flow


def small_duct() -> Duct:
    mesh, domain = rows(0.1, around=4, outward=2, radius=5e-6)
    return duct_of(mesh.face_mesh(), domain, "symmetry")


def stopped_at(moment: int) -> Callable[[int], None]:
    def told(at: int) -> None:
        if at >= moment:
            raise StoppedError

    return told


@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize("inertia", [0.0, pytest.param(5.0, marks=pytest.mark.slow)])
def test_a_flow_that_was_stopped_is_the_same_flow(tmp_path: Path, inertia: float) -> None:
    duct = small_duct()
    whole = flow_of(System(duct, 0.05), None, lambda _: None, inertia)
    # in the first round, and in the last step
    for moment in (18, whole.iterations - 1):
        place = tmp_path / str(moment)
        with pytest.raises(StoppedError):
            flow_of(System(duct, 0.05), place, stopped_at(moment), inertia)
        again = flow_of(System(duct, 0.05), place, lambda _: None, inertia)
        assert (again.velocity == whole.velocity).all()
        assert (again.force == whole.force).all()
        assert (again.drop, again.history, again.error) == (whole.drop, whole.history, whole.error)


def listening() -> tuple[list[str], Progress]:
    said: list[str] = []

    def listener(what: str, done: float | None = None) -> None:
        said.append(what)

    return said, listener


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flipped(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)


def of_another_mesh(path: Path) -> None:
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    np.savez(path, **{name: value[..., :-1] if value.ndim else value for name, value in arrays.items()})


def not_finite(path: Path) -> None:
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    np.savez(path, **{name: np.full_like(value, np.nan) for name, value in arrays.items()})


def a_link(path: Path) -> None:
    path.rename(path.with_suffix(".elsewhere"))
    path.symlink_to(path.with_suffix(".elsewhere"))


def of_text(path: Path) -> None:
    path.write_text("no archive")


@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize("damage", [cut, flipped, of_another_mesh, not_finite, a_link, of_text])
def test_what_is_kept_and_damaged_is_left_with_the_reason_and_made_again(
    tmp_path: Path, damage: Callable[[Path], None]
) -> None:
    found, iterations, products = iterated(None)
    for number, stop in enumerate((15, 35, 60)):
        place = tmp_path / str(number)
        with pytest.raises(StoppedError):
            iterated(KeptIterations(KeptSolve(place), "flow"), stop)
        files = sorted(place.glob("*.npz"))
        assert files
        damage(files[len(files) // 2])
        said, listener = listening()
        same, count, again = iterated(KeptIterations(KeptSolve(place, listener), "flow"))
        if files[len(files) // 2].stem.endswith("round"):
            # where a round began is lost, so it begins at the start
            assert len(again) == len(products)
        assert (same == found).all()
        assert count == iterations
        assert any("of the run that was stopped is left, and made again: " in words for words in said), said


@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize("text", ["nan", "-1", "inf", "some time", "9" * 1000])
def test_a_time_that_is_none_is_not_counted(tmp_path: Path, text: str) -> None:
    iterated(KeptIterations(KeptSolve(tmp_path), "flow"))
    assert 0.0 < KeptSolve(tmp_path).before < 60.0
    (tmp_path / "seconds").write_text(text)
    said, listener = listening()
    assert KeptSolve(tmp_path, listener).before == 0.0
    assert len(said) == 1


def test_a_solve_that_takes_a_moment_writes_nothing(tmp_path: Path) -> None:
    iterated(KeptIterations(KeptSolve(tmp_path / "kept"), "flow"))
    assert not (tmp_path / "kept").exists()


@pytest.mark.usefixtures("at_once")
def test_where_nothing_can_be_written_the_flow_is_solved_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    said, listener = listening()
    found, _, _ = iterated(KeptIterations(KeptSolve(tmp_path / "file" / "kept", listener), "flow"))
    assert (found == iterated(None)[0]).all()
    # once, and with the system's reason
    assert sum("nothing is kept to go on from" in words for words in said) == 1


CHILD = """
import sys
from pathlib import Path
import pipeline.solve.stokes.kept as kept
from pipeline.case import read_case
from pipeline.line.run import run
kept.EVERY = 0.0
case = read_case(Path("case.toml"), ("tetmesh.engine=lattice",))
unread = frozenset({"quality", "export", "report"})
run(case, Path(sys.argv[1]), sys.argv[2], without=unread, progress=lambda what, done=None: print(what, flush=True))
"""


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_a_killed_process_goes_on_and_says_so(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(CASE)

    def started(run: Path, until: str) -> "subprocess.Popen[str]":
        return subprocess.Popen(
            [sys.executable, "-c", CHILD, str(run), until], cwd=tmp_path, stdout=subprocess.PIPE, text=True,
            stderr=subprocess.STDOUT,
        )  # fmt: skip

    def ended(child: "subprocess.Popen[str]") -> str:
        said, _ = child.communicate()
        assert child.returncode == 0, said
        return said

    ended(started(tmp_path / "meshed", "compare"))
    shutil.copytree(tmp_path / "meshed", tmp_path / "whole")
    ended(started(tmp_path / "whole", "solve"))
    draw = random.Random(5)
    for number in range(2):
        run = tmp_path / f"run{number}"
        shutil.copytree(tmp_path / "meshed", run)
        before, wanted = started(run, "solve"), draw.randrange(1, 40)
        while before.poll() is None and len(list(run.glob(".solve.kept/*/*.npz"))) < wanted:
            time.sleep(0.005)
        before.send_signal(signal.SIGKILL)
        before.communicate()
        there = list(run.glob(".solve.kept/*/*.npz"))
        said = ended(started(run, "solve"))
        assert there
        assert read_json(run / "solve" / "cost.json")["kept_iterations"] > 0
        assert "iterations are those of a run that was stopped" in said
        for file in ("solution.json", "flow.npz", "settling.json"):
            assert (run / "solve" / file).read_bytes() == (tmp_path / "whole" / "solve" / file).read_bytes()
        assert not (run / ".solve.kept").exists()
