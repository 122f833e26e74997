"""`fibertwin converge`: a pressure drop with its interval, and what is told where meshes differ by chance."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import os
from pathlib import Path

import pytest

from pipeline.case import Case, read_case
from pipeline.errors import CaseError, StageError
from pipeline.nouns.convergence import MeshRung, convergence_tables
from pipeline.progress import Progress, silent
from pipeline.report.page.converged import read_convergence
from pipeline.study import converge as module
from pipeline.study.converge import converge
from tests.cli.conftest import Fibertwin, fibertwin
from tests.security.inputs import in_time

__all__ = ["fibertwin"]
SMOKE = Path(__file__).parent.parent.parent / "cases" / "smoke.toml"


def faked(monkeypatch: pytest.MonkeyPatch, order: float, chance: float = 0.0, refused: str = "") -> None:
    """Let runs give 5 Pa with an error of the mesh of this order, and by chance some more on the middle mesh."""

    def rung(case: Case, folder: Path, name: str, progress: Progress) -> MeshRung:
        if name == refused:
            raise StageError("no mesh")
        spacing = case.tetmesh.edge
        drop = 5.0 - spacing**order + (chance if name == "own" else 0.0) + 0.5 * (case.mat.seed - 1)
        return MeshRung(spacing, 1000, spacing, drop, 1.1 * drop, drop, 1.0)

    monkeypatch.setattr(module, "_rung", rung)


@pytest.mark.parametrize("order", [1.5, 2.0, 3.0])
def test_a_power_law_gives_its_order_and_an_interval_that_holds_the_limit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, order: float
) -> None:
    faked(monkeypatch, order)
    found = converge(read_case(SMOKE), tmp_path, 3, silent)
    assert found.order == pytest.approx(order, rel=1e-3)
    assert found.pressure_drop.low <= 5.0 <= found.pressure_drop.high
    # no slip is a tenth more in these runs, and seeds lie half a pascal apart
    assert found.contributions.slip == pytest.approx(0.1)
    own = found.rungs[1].pressure_drop
    assert found.seeds == pytest.approx((own, own + 0.5, own + 1.0))
    assert found.contributions.seed == pytest.approx(0.5 / (own + 0.5))
    assert found.contributions.mesh == pytest.approx(own / found.pressure_drop.value - 1)


def test_meshes_that_differ_by_chance_have_no_order_and_their_spread_for_an_interval(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    faked(monkeypatch, 2.0, chance=0.6)
    found = converge(read_case(SMOKE), tmp_path, 1, silent)
    drops = [rung.pressure_drop for rung in found.rungs]
    assert found.order is None
    assert found.pressure_drop.value == drops[-1]
    assert found.pressure_drop.high - found.pressure_drop.value == pytest.approx(max(drops) - min(drops))
    assert found.contributions.seed is None


def test_what_cannot_be_solved_beside_the_case_is_told_and_the_number_stands(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    faked(monkeypatch, 2.0, refused="larger box")
    found = converge(read_case(SMOKE), tmp_path, 1, silent)
    assert found.contributions.box is None
    assert found.notes == ("larger box: no mesh",)
    assert any("larger box: no mesh" in row for table in convergence_tables(found) for row in table.rows)


def test_seeds_of_a_mat_that_no_seed_draws_are_refused(tmp_path: Path) -> None:
    case = read_case(SMOKE.parent / "verification" / "square.toml")
    with pytest.raises(CaseError, match="always the same"):
        converge(case, tmp_path, 2, silent)


@pytest.mark.slow
def test_the_command_leaves_its_result_a_plot_and_the_budget_on_the_page(fibertwin: Fibertwin, tmp_path: Path) -> None:
    said = fibertwin("converge", "smoke", "--out", tmp_path, "--json")
    assert said.code == 0
    found = json.loads((tmp_path / "convergence.json").read_text())
    assert json.loads(said.out) == found
    drop = found["pressure_drop"]
    assert drop["low"] < drop["value"] < drop["high"]
    assert set(found["contributions"]) == {"mesh", "slip", "box", "seed"}
    assert len(found["rungs"]) == 3
    assert (tmp_path / "convergence.svg").is_file()
    assert "pressure drop and what moves it" in (tmp_path / "report" / "report.html").read_text()


@pytest.mark.parametrize("obstacle", ["pipe", "device", "link", "text", "deep"])
def test_what_somebody_put_in_the_place_of_the_result_is_none(obstacle: str, tmp_path: Path) -> None:
    path = tmp_path / "convergence.json"
    match obstacle:
        case "pipe":
            os.mkfifo(path)
        case "device":
            path.symlink_to("/dev/zero")
        case "link":
            (tmp_path / "outside.json").write_text("{}")
            path.symlink_to(tmp_path / "outside.json")
        case "text":
            path.write_bytes(b"\xff{")
        case _:
            path.write_text("[" * 100_000)
    with in_time():
        assert read_convergence(tmp_path) is None


def test_runs_beside_a_case_stay_within_its_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "convergence").symlink_to(outside)
    faked(monkeypatch, 2.0)
    converge(read_case(SMOKE), tmp_path / "run", 2, silent)
    assert not list(outside.iterdir())
    assert (tmp_path / "run" / "convergence" / "coarse").is_dir()
