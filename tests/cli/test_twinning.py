"""`fibertwin twin` on the command line."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from pipeline.case import read_case
from pipeline.cli.app import main
from tests.micrograph.drawn import as_bytes, bands


def fibertwin(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr("sys.argv", ["fibertwin", *words])
    try:
        main()
    except SystemExit as end:
        return int(end.code or 0)
    return 0


MEASURED = """
fiber_diameter = "1.4 um +- 3 %"
fiber_density = "2500 kg/m^3"
basis_weight = "8 g/m^2 +- 4 %"
thickness = "30 um +- 2 um"
seeds = 3
"""


def test_a_file_and_options_become_a_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("measured.toml").write_text(MEASURED, encoding="utf-8")
    assert fibertwin(monkeypatch, "twin", "measured.toml", "--case", "twin.toml", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert told["matched"] is True
    weight = told["quantities"]["basis_weight"]
    assert weight["low"] <= weight["twin"] <= weight["high"]
    case = read_case(Path("twin.toml"))
    assert (case.mat.seed, case.mat.stop.coverage) == (told["seed"], told["coverage"])
    # what is given as an option counts more than the file; without --case the file alone goes to the output
    assert fibertwin(monkeypatch, "twin", "measured.toml", "--thickness", "25 um +- 2 um", "--quiet") == 0
    Path("other.toml").write_text(capsys.readouterr().out, encoding="utf-8")
    assert read_case(Path("other.toml")).mat != case.mat
    assert fibertwin(monkeypatch, "twin", "measured.toml", "--case", "twin.toml") == 2
    assert "is there already" in capsys.readouterr().err


def test_what_cannot_be_matched_ends_with_three_and_the_nearest_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ("--fiber-diameter", "1.4 um", "--solidity", "60 %", "--thickness", "15 um +- 10 %", "--seeds", "2")
    assert fibertwin(monkeypatch, "twin", *words, "--case", "nearest.toml") == 3
    said = " ".join(capsys.readouterr().out.split())
    assert "solidity cannot be matched: 60 % was measured, and the nearest is" in said
    assert read_case(Path("nearest.toml")).mat.generator == "layered"


def test_what_is_not_enough_is_told_before_anything_is_done(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    fibers = ("--fiber-diameter", "1.4 um")
    for words, message in (
        ((), "a mat takes two"),
        (("--thickness", "30 um"), "a mat takes two"),
        (("--thickness", "30 um", "--solidity", "8 %", "--solve"), "--pressure-drop"),
        (("--thickness", "30 um", "--basis-weight", "8 gsm"), "fiber_density"),
        (("--thickness", "30 lightyears", "--solidity", "8 %", "--micrograph", "web.png"), "not both"),
    ):
        assert fibertwin(monkeypatch, "twin", *fibers, *words) == 2
        assert message in " ".join(capsys.readouterr().err.split())


def told_of_a_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Any:
    monkeypatch.chdir(tmp_path)
    Image.fromarray(as_bytes(bands(np.full(8, 12.0), (260, 280), seed=6))).save("web.png")
    assert fibertwin(monkeypatch, "measure", "web.png", "--pixel", "100 nm", "--json") == 0
    return json.loads(capsys.readouterr().out)


def test_a_picture_or_what_was_measured_in_it_gives_the_fibers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told = told_of_a_picture(tmp_path, monkeypatch, capsys)
    Path("web.json").write_text(json.dumps(told), encoding="utf-8")
    rest = ("--thickness", "25 um +- 2 um", "--solidity", "7 %", "--seeds", "3", "--json")
    twins = []
    for words in (("--micrograph", "web.json"), ("--micrograph", "web.png", "--pixel", "100 nm")):
        assert fibertwin(monkeypatch, "twin", *words, *rest) == 0
        twins.append(json.loads(capsys.readouterr().out))
    assert twins[0] == twins[1]
    # 12 pixels of 100 nm
    assert twins[0]["quantities"]["fiber_diameter"]["twin"] == pytest.approx(1.2e-6, rel=0.03)
    Path("broken.json").write_text('{"fibers": 3', encoding="utf-8")
    assert fibertwin(monkeypatch, "twin", "--micrograph", "broken.json", *rest) == 2
    assert "measure --json" in " ".join(capsys.readouterr().err.split())
