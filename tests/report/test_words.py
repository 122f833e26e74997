"""What the page says of a run must follow from its numbers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses

import pytest

from pipeline.nouns.comparison import Comparison
from pipeline.nouns.quality import QualityReport
from pipeline.report.page.words import BAD, GOOD, NOTE, checks, steps, verdict
from tests.report.contents import SOLUTION, whole


def report(verdict: str, *reasons: str) -> QualityReport:
    return QualityReport(10, 10, 20, 10, {}, 1.0, {}, verdict, reasons)


@pytest.mark.parametrize(("word", "mark"), [("pass", GOOD), ("warn", NOTE), ("fail", BAD)])
def test_the_verdict_of_the_mesh_is_the_verdict_of_the_page(word: str, mark: str) -> None:
    content = whole(report(word, "skewness: 3 faces above 4"))
    assert verdict(content.get(QualityReport))[0] == mark
    first = checks(content)[0]
    assert first.mark == mark
    assert "Skewness: 3 faces above 4." in first.sentence


def test_a_bad_mesh_is_to_be_mended_first() -> None:
    assert "tetmesh" in steps(whole(report("fail")))[0].command
    assert "tetmesh" not in steps(whole(report("pass")))[0].command


def test_a_mesh_that_lost_more_volume_than_the_case_allows_is_told() -> None:
    content = whole()
    # the case allows 2 %; this mesh has lost 10
    thin = dataclasses.replace(content.read(Comparison), solidity={"nominal": 0.1, "surface": 0.1, "mesh": 0.09})
    marks = {check.title: check.mark for check in checks(whole(thin))}
    assert marks["what meshing costs"] == BAD
    marks = {check.title: check.mark for check in checks(content)}
    assert marks["what meshing costs"] == GOOD


def test_a_solution_that_has_not_settled_is_not_trusted() -> None:
    marks = {check.title: check.mark for check in checks(whole(SOLUTION))}
    assert marks["the solution has settled"] == GOOD
    unsettled = dataclasses.replace(SOLUTION, converged=False, force_balance_error=0.2)
    marks = {check.title: check.mark for check in checks(whole(unsettled))}
    assert marks["the solution has not settled"] == BAD
    assert marks["balance of forces and of mass"] == NOTE


def test_commands_survive_odd_folder_names(tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("a folder; rm")
    commands = [step.command for step in steps(whole(folder=folder)) if str(folder) in step.command]
    assert commands
    assert all(f"'{folder}" in command for command in commands)
