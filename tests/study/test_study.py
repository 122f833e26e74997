# SPDX-License-Identifier: GPL-3.0-or-later

import csv
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pytest

import pipeline.study.study as study_module
from pipeline.errors import CaseError, FibertwinError, StageError
from pipeline.line.run import Run
from pipeline.line.store import read_json
from pipeline.mat.measures import measure
from pipeline.nouns.fibers import Mat
from pipeline.study.one import carry_out
from pipeline.study.plan import Task, plan
from pipeline.study.quantity import Results
from pipeline.study.settings import Reference, Study
from pipeline.study.study import StudyResult, carry_out_study
from pipeline.study.tables import write_tables
from pipeline.study.workers import SLURM, carried_out

CASE = """
[mat]
generator = "layered"
side = "10 um"
fiber_diameter = "1 um"
relaxation_slope = 0.15
max_fibers = 40
[mat.stop]
coverage = 1
"""


@pytest.fixture(name="study")
def _study(tmp_path: Path) -> Study:
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    return Study(
        case=tmp_path / "case.toml",
        sweep={"mat.relaxation_slope": [0.05, 0.2]},
        seeds=3,
        measure=("mat.solidity in %", "mat.thickness in um", "predict.efficiency.total"),
    )


@pytest.fixture(name="here")
def _here(monkeypatch: pytest.MonkeyPatch) -> list[Task]:
    """Carry out the runs in this process, and list them."""
    ran: list[Task] = []

    def one_by_one(
        tasks: Iterable[Task], workers: int | None, scheduler: str | None
    ) -> Iterator[tuple[Task, Results | BaseException]]:
        for task in tasks:
            ran.append(task)
            try:
                yield task, carry_out(task)
            except (FibertwinError, ZeroDivisionError) as problem:
                yield task, problem

    monkeypatch.setattr(study_module, "carried_out", one_by_one)
    return ran


def test_a_study_tells_what_single_runs_tell(study: Study, here: list[Task], tmp_path: Path) -> None:
    from pipeline.case import read_case
    from pipeline.mat.generate import generate

    result = carry_out_study(study, tmp_path / "out")
    run = result.points[1].runs[2]
    case = read_case(study.case, ("mat.relaxation_slope=0.2", f"mat.seed={run.seed}"))
    alone = measure(generate(case.mat))
    assert run.values[0] == pytest.approx(100 * alone.solidity, rel=1e-12)
    assert run.values[1] == pytest.approx(1e6 * alone.thickness, rel=1e-12)
    assert result.points[1].estimates[0].mean == pytest.approx(
        sum(each.values[0] for each in result.points[1].runs) / 3, rel=1e-12
    )
    # limp fibers pack closer
    assert result.points[1].estimates[0].mean > result.points[0].estimates[0].mean


def test_the_tables_have_a_line_per_run_and_per_combination(study: Study, here: list[Task], tmp_path: Path) -> None:
    result = carry_out_study(study, tmp_path / "out")
    runs, summary = write_tables(result, tmp_path)
    with runs.open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert [line["mat.seed"] for line in lines] == ["1", "2", "3", "1", "2", "3"]
    assert float(lines[0]["mat.solidity [%]"]) == pytest.approx(result.points[0].runs[0].values[0])
    with summary.open(encoding="utf-8") as file:
        means = list(csv.DictReader(file))
    assert [line["mat.relaxation_slope"] for line in means] == ["0.05", "0.2"]
    assert float(means[1]["mat.thickness [um] ci95"]) == pytest.approx(result.points[1].estimates[1].half_width)


def test_runs_go_seed_by_seed(study: Study, here: list[Task], tmp_path: Path) -> None:
    carry_out_study(study, tmp_path / "out")
    # whatever is finished has every combination about equally often
    assert [(task.seed, task.point) for task in here] == [(seed, point) for seed in (1, 2, 3) for point in (0, 1)]


@pytest.mark.parametrize(("until", "keep", "left_out"), [
    ("solve", "numbers", {"report"}),
    ("solve", "everything", set()),
    ("report", "numbers", set()),
])  # fmt: skip
def test_a_page_that_is_thrown_away_is_not_made(
    study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, until: str, keep: str, left_out: set[str]
) -> None:
    class ReachedError(Exception):
        pass

    asked: list[frozenset[str]] = []

    def spy(case: object, folder: Path, until: str, without: frozenset[str]) -> None:
        asked.append(without)
        raise ReachedError

    monkeypatch.setattr("pipeline.study.one.run", spy)
    with pytest.raises(ReachedError):
        carry_out(plan(study.model_copy(update={"until": until, "keep": keep}), tmp_path)[0])
    assert asked == [left_out]


def test_finished_runs_are_kept(study: Study, here: list[Task], tmp_path: Path) -> None:
    first = carry_out_study(study, tmp_path / "out")
    assert (first.made, first.reused, len(here)) == (6, 0, 6)
    again = carry_out_study(study, tmp_path / "out")
    assert (again.made, again.reused, len(here)) == (0, 6, 6)
    assert again.points == first.points
    shutil.rmtree(here[2].result)
    mended = carry_out_study(study, tmp_path / "out")
    assert (mended.made, mended.reused) == (1, 5)
    assert mended.points == first.points


def test_more_seeds_run_only_what_is_new(study: Study, here: list[Task], tmp_path: Path) -> None:
    carry_out_study(study, tmp_path / "out")
    more = carry_out_study(study.model_copy(update={"seeds": 5}), tmp_path / "out")
    assert (more.made, more.reused) == (4, 6)


def test_the_stages_are_kept_only_where_asked_for(study: Study, here: list[Task], tmp_path: Path) -> None:
    carry_out_study(study, tmp_path / "numbers")
    assert not list((tmp_path / "numbers" / "work").iterdir())
    everything = study.model_copy(update={"keep": "everything"})
    carry_out_study(everything, tmp_path / "all")
    mat = Run.opened(here[-1].work).read(Mat)
    assert isinstance(mat, Mat)
    assert measure(mat).solidity == pytest.approx(read_json(here[-1].result / "result.json")["mat"]["solidity"])


def test_a_failing_run_is_recorded_and_ends_nothing(study: Study, here: list[Task], tmp_path: Path) -> None:
    # forty straight fibers of 1 um pile up to 20 um, forty limp ones do not
    failing = study.model_copy(
        update={"set_": {"mat.stop.thickness": "12 um"}, "sweep": {"mat.relaxation_slope": [0.0, 0.5]}}
    )
    result = carry_out_study(failing, tmp_path / "out")
    assert [point.failed for point in result.points] == [0, 3]
    assert result.points[1].estimates[0].n == 0
    assert "max_fibers" in result.points[1].runs[0].error
    runs, summary, failures = write_tables(result, tmp_path)
    assert "max_fibers" in runs.read_text(encoding="utf-8")
    assert "0.5,3,3,,,,0" in summary.read_text(encoding="utf-8")
    assert "--set 'mat.relaxation_slope=0.5' --set mat.seed=2" in failures.read_text(encoding="utf-8")
    # tried again, in vain, while the others are kept
    again = carry_out_study(failing, tmp_path / "out")
    assert (again.failed, again.reused) == (3, 3)


def test_nothing_of_a_study_is_written_outside_its_folder(study: Study, here: list[Task], tmp_path: Path) -> None:
    outside, folder = tmp_path / "outside", tmp_path / "study"
    outside.mkdir()
    folder.mkdir()
    for name in ("results", "work"):
        (folder / name).symlink_to(outside)
    carry_out_study(study, folder)
    assert here
    assert not list(outside.iterdir())
    assert not (folder / "results").is_symlink()


def test_a_bug_in_a_run_is_recorded_with_its_traceback(
    study: Study, here: list[Task], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import pipeline.study.one as one

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("nothing goes into nothing")

    monkeypatch.setattr(one, "run", broken)
    result = carry_out_study(study, tmp_path / "out")
    assert result.failed == 6
    assert "Traceback" in result.points[0].runs[0].error
    assert "nothing goes into nothing" in result.points[0].runs[0].error


def test_a_wrong_measure_keeps_the_runs_that_were_made(study: Study, here: list[Task], tmp_path: Path) -> None:
    wrong = study.model_copy(update={"measure": ("mat.soldity", "mat.thickness", "predict.mpps")})
    with pytest.raises(CaseError, match="did you mean solidity") as caught:
        carry_out_study(wrong, tmp_path / "out")
    assert "predict.mpps" in str(caught.value)
    assert carry_out_study(study, tmp_path / "out").reused >= 1


def test_two_studies_do_not_share_a_folder_at_once(study: Study, tmp_path: Path) -> None:
    from pipeline.line.places import locked

    with locked(tmp_path / "out"), pytest.raises(StageError, match="another run"):
        carry_out_study(study, tmp_path / "out")


def test_workers_of_their_own_give_the_same(study: Study, here: list[Task], tmp_path: Path) -> None:
    tasks = plan(study.model_copy(update={"seeds": 1}), tmp_path / "dask")
    # a worker cannot lock what is a folder
    (tasks[0].work / ".lock").mkdir(parents=True)
    outcomes = {task.point: outcome for task, outcome in carried_out(tasks, 1, None)}
    assert isinstance(outcomes[0], StageError)
    alone = carry_out_study(study, tmp_path / "here").points[1].runs[0]
    assert isinstance(outcomes[1], dict)
    assert 100 * outcomes[1]["mat"]["solidity"] == pytest.approx(alone.values[0], rel=1e-12)


def test_a_scheduler_that_is_not_there_is_told() -> None:
    with pytest.raises(StageError, match="no dask scheduler answers at 'nowhere'"):
        list(carried_out([], None, "nowhere"))


def test_a_running_scheduler_takes_no_number_of_workers() -> None:
    with pytest.raises(CaseError, match="leave --workers out"):
        list(carried_out([], 2, "tcp://127.0.0.1:8786"))


def test_slurm_needs_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "dask_jobqueue", None)
    with pytest.raises(StageError, match=r"fibertwin\[cluster\]"):
        list(carried_out([], 2, SLURM))


def test_the_plot_has_a_panel_per_quantity(study: Study, here: list[Task], tmp_path: Path) -> None:
    from pipeline.study.plot import plot_study

    two = study.model_copy(
        update={"sweep": {"mat.fiber_diameter": ["1 um", "800 nm"], "mat.contact": ["paper", "clear"]}}
    )
    result: StudyResult = carry_out_study(two, tmp_path / "out")
    panels = [axes for axes in plot_study(result).axes if axes.axison]
    assert [axes.get_ylabel() for axes in panels] == [quantity.label for quantity in result.quantities]
    assert panels[0].get_xlabel() == "mat.fiber_diameter [um]"
    handles, labels = panels[0].get_legend_handles_labels()
    assert labels == ["mat.contact paper", "mat.contact clear"]
    assert len(handles) == 2
    # both diameters stand at their place in the unit of the first
    assert panels[0].dataLim.intervalx == pytest.approx([0.8, 1.0])


def test_what_others_found_is_in_the_plot(study: Study, here: list[Task], tmp_path: Path) -> None:
    from pipeline.study.plot import plot_study

    paper = Reference(label="paper", at=0.15, values={"mat.solidity in %": 9.48})
    result = carry_out_study(study.model_copy(update={"reference": (paper,)}), tmp_path / "out")
    solidity, thickness, *_ = plot_study(result).axes
    [cross] = [line for line in solidity.lines if line.get_label() == "paper"]
    assert np.asarray(cross.get_xydata()).tolist() == [[0.15, 9.48]]
    assert thickness.get_legend() is None


@pytest.mark.slow
def test_a_killed_study_continues(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    (tmp_path / "study.toml").write_text(
        'case = "case.toml"\nseeds = 200\nmeasure = ["mat.solidity"]\n[sweep]\nmat.relaxation_slope = [0.1, 0.2]\n',
        encoding="utf-8",
    )
    out = tmp_path / "out"
    program = "from pipeline.cli import main\nif __name__ == '__main__':\n    main()\n"
    (tmp_path / "fibertwin.py").write_text(program, encoding="utf-8")
    command = [sys.executable, "fibertwin.py", "study", "study.toml", "--workers", "1", "--out", str(out)]
    environment = {**os.environ, "PYTHONPATH": str(Path.cwd())}
    first = subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL)
    while len(list((out / "results").glob("[0-9a-f]*/manifest.json"))) < 5:
        assert first.poll() is None
        time.sleep(0.05)
    first.send_signal(signal.SIGKILL)
    first.wait()
    time.sleep(2.0)
    kept = len(list((out / "results").glob("[0-9a-f]*/manifest.json")))
    again = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert f"400 runs: {400 - kept} made, {kept} kept from before, 0 failed" in again.stdout
