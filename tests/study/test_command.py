# SPDX-License-Identifier: GPL-3.0-or-later

import re
from pathlib import Path

import pytest

from pipeline.cli.studying import run_study
from pipeline.errors import CaseError, StageError

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
STUDY = """
case = "case.toml"
seeds = 2
picture = "side"
measure = ["predict.mpps.diameter in nm"]
[sweep]
mat.relaxation_slope = [0.05, 0.2]
"""


def written(folder: Path, study: str) -> Path:
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    (folder / "study.toml").write_text(study, encoding="utf-8")
    return folder / "study.toml"


def test_a_study_leaves_tables_a_plot_and_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = written(tmp_path, STUDY), tmp_path / "out"
    run_study(path, out, workers=1, scheduler=None, plot=None, quiet=False)
    said = capsys.readouterr().out
    assert "predict.mpps.diameter [nm]" in said
    assert "4 runs: 4 made, 0 kept from before, 0 failed" in said
    for name in ("runs.csv", "summary.csv", "plot.svg", "pictures.png"):
        assert (out / name).stat().st_size > 0
        assert re.search(rf"\b{name}", said)
    assert not (out / "failures.txt").exists()


def test_a_study_of_failures_only_says_where_to_look(tmp_path: Path) -> None:
    path = written(tmp_path, STUDY.replace("[sweep]", '[set]\nmat.stop.thickness = "1 mm"\n[sweep]'))
    with pytest.raises(StageError, match=r"all 4 runs failed; .*failures.txt"):
        run_study(path, tmp_path / "out", workers=1, scheduler=None, plot=None, quiet=True)
    assert not (tmp_path / "out" / "pictures.png").exists()
    assert "max_fibers" in (tmp_path / "out" / "failures.txt").read_text(encoding="utf-8")


def test_no_workers_are_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="one or more"):
        run_study(written(tmp_path, STUDY), tmp_path / "out", workers=0, scheduler=None, plot=None, quiet=True)
