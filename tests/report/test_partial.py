"""The report of a run that stopped half way, or whose case was changed after."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path

import pytest

from pipeline.line.run import Run, report, run
from pipeline.nouns.fibers import Mat
from pipeline.nouns.surface import Surface
from pipeline.report.views.render import Pictures
from tests.report.contents import CASE
from tests.report.pages import read


@pytest.fixture(autouse=True)
def _no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    # pictures take seconds, and have tests of their own
    monkeypatch.setattr("pipeline.report.views.render.Painting.__init__", lambda *_: None)
    monkeypatch.setattr("pipeline.report.views.render.Painting.__exit__", lambda *_: None)
    monkeypatch.setattr("pipeline.report.views.render.Painting.finished", lambda _: Pictures())


def test_a_run_until_its_mat_has_a_report_of_its_mat(tmp_path: Path) -> None:
    run(CASE, tmp_path, until="mat")
    page = read(report(tmp_path).read_text(encoding="utf-8"))
    assert {"mat", "provenance"} <= set(page.values("id"))
    assert "mesh" not in page.values("id")


def test_results_of_another_case_are_left_out_and_named(tmp_path: Path) -> None:
    run(CASE, tmp_path, until="enclosure")
    other = CASE.model_copy(update={"mat": CASE.mat.model_copy(update={"seed": 8})})
    run(other, tmp_path, until="mat")
    content = Run.opened(tmp_path)
    assert content.left_out == ("surface", "enclosure")
    assert content.get(Surface) is None
    assert content.get(Mat) is not None
    page = read(report(tmp_path).read_text(encoding="utf-8"))
    assert any("surface, enclosure" in text for text in page.text)


def test_every_stage_tells_what_it_cost(tmp_path: Path) -> None:
    run(CASE, tmp_path, until="surface")
    manifest = json.loads((tmp_path / "surface" / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["seconds"] > 0
    # numpy alone takes tens of megabytes; a mistake of units would be off by 1024
    assert 5e7 < manifest["peak_memory"] < 5e10
