"""Runs side by side: what differs in their cases, what came out, and the page as PDF."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import shutil
from pathlib import Path

import pytest

from pipeline.case import Case
from pipeline.cli import viewing
from pipeline.errors import CaseError, StageError
from pipeline.line.results import Results
from pipeline.line.run import run
from pipeline.nouns.flow import Solution
from pipeline.report import pdf
from pipeline.report.page.compared_page import (
    comparison_html,
    comparison_json,
    differing_inputs,
    figures,
    names_of,
    write_comparison,
)
from pipeline.report.views.render import Pictures
from tests.report.contents import CAPTURE, CASE, SOLUTION, whole
from tests.report.pages import read


def other(content: Results, case: Case, folder: str) -> Results:
    return dataclasses.replace(content, case=case, folder=Path(folder))


@pytest.fixture(scope="module")
def two() -> list[Results]:
    first = whole(SOLUTION, CAPTURE, folder=Path("runs/first"))
    changed = CASE.model_copy(update={"mat": CASE.mat.model_copy(update={"seed": 8})})
    second = whole(dataclasses.replace(SOLUTION, pressure_drop=15.0), folder=Path("runs/second"))
    return [first, other(second, changed, "runs/second")]


def test_only_settings_that_differ_are_listed(two: list[Results]) -> None:
    table = differing_inputs(two)
    assert table.columns == ("setting", "first", "second")
    assert table.rows == (("mat.seed", "3", "8"),)
    assert differing_inputs([two[0], two[0]]).rows == ()


def test_numbers_stand_beside_each_other_with_their_change_against_the_first(two: list[Results]) -> None:
    rows = {row[0]: row[1:] for row in figures(two).rows}
    # 15 over 12.5
    assert rows["pressure drop, CFD"] == ("12.5 Pa", "15 Pa (+20.0%)")
    assert rows["fibers"] == ("3", "3 (+0.0%)")
    # the second caught nothing, for nobody asked it to
    assert rows["penetration there"][1] == "–"


def test_the_page_is_whole_and_holds_every_run(two: list[Results]) -> None:
    page = read(comparison_html(two, Pictures({"0-duct": b"a", "1-duct": b"b"})))
    assert {"inputs", "figures", "pictures", "picture-0-duct", "picture-1-duct"} <= set(page.values("id"))
    assert "script" not in page.tags
    assert page.tags.count("svg") == 3


def test_runs_in_folders_of_one_name_are_told_apart(two: list[Results]) -> None:
    same = [two[0], other(two[1], two[1].case, "elsewhere/first")]
    assert names_of(same) == ["runs/first", "elsewhere/first"]


def test_what_a_stranger_named_stays_text(two: list[Results]) -> None:
    evil = other(two[1], two[1].case, "<script>alert(1)<script>")
    assert "script" not in read(comparison_html([two[0], evil], Pictures())).tags


def test_one_page_takes_two_to_six_runs(two: list[Results], tmp_path: Path) -> None:
    for count in (1, 7):
        with pytest.raises(CaseError, match="2 to 6"):
            write_comparison([two[0]] * count, tmp_path / "page.html")


def test_the_json_has_the_numbers(two: list[Results]) -> None:
    found = json.loads(json.dumps(comparison_json(two), allow_nan=False))
    assert found["inputs"] == {"mat.seed": ["3", "8"]}
    assert found["numbers"]["pressure drop, CFD"] == [SOLUTION.pressure_drop, 15.0]
    assert two[1].read(Solution).pressure_drop == 15.0


@pytest.mark.usefixtures("rendering")
def test_the_command_writes_the_page_of_two_runs_where_it_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a", "b"):
        run(CASE, tmp_path / name, until="mat")
    viewing.write_pages((tmp_path / "a", tmp_path / "b"), tmp_path / "new/page.html", False, False, False)
    assert capsys.readouterr().out.strip() == str(tmp_path / "new/page.html")
    assert "the cases are equal" in (tmp_path / "new/page.html").read_text(encoding="utf-8")


def test_without_a_browser_pdf_is_refused_before_anything_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(pdf, "_ELSEWHERE", ())
    with pytest.raises(StageError, match="install Chromium, Chrome or Edge"):
        viewing.write_pages((tmp_path / "nothing",), None, True, False, True)


@pytest.mark.browser
@pytest.mark.skipif(shutil.which("chromium") is None, reason="Chromium is not on the PATH")
def test_a_page_is_printed(tmp_path: Path) -> None:
    page = tmp_path / "a page.html"
    page.write_text("<!doctype html><title>x</title><p>One page</p>", encoding="utf-8")
    pdf.print_page(page, tmp_path / "new/page.pdf")
    printed = (tmp_path / "new/page.pdf").read_bytes()
    assert printed.startswith(b"%PDF-")
    assert printed.count(b"/Type /Page\n") + printed.count(b"/Type /Page/") == 1
