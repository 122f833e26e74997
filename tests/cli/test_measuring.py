"""`fibertwin measure` and `fibertwin micrograph` on the command line."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
from pathlib import Path

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


def test_a_picture_becomes_numbers_a_page_and_a_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Image.fromarray(as_bytes(bands(np.full(8, 12.0), (300, 320), seed=6))).save("web.png")
    assert fibertwin(monkeypatch, "measure", "web.png", "--pixel", "25 nm", "--json", "--case", "my_filter.toml") == 0
    told = json.loads(capsys.readouterr().out)
    assert set(told) >= {"diameter", "fibers", "orientation"}
    # 12 pixels of 25 nm
    assert told["diameter"]["mean"] == pytest.approx(300e-9, rel=0.02)
    assert told["diameter"]["median"] == pytest.approx(300e-9, rel=0.02)
    assert read_case(Path("my_filter.toml")).mat.generator == "layered"
    page = Path("runs/web/micrograph.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 2
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert fibertwin(monkeypatch, "measure", "web.png") == 2
    assert "--pixel" in capsys.readouterr().err
    assert fibertwin(monkeypatch, "measure", "web.png", "--pixel", "25 nm", "--case", "my_filter.toml") == 2
    assert "is there already" in capsys.readouterr().err


def test_a_picture_of_a_case_says_its_own_scale(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from pipeline.microscope.read import read_micrograph

    monkeypatch.chdir(tmp_path)
    assert fibertwin(monkeypatch, "micrograph", "smoke", "mat.png", "--pixel", "50 nm") == 0
    assert read_micrograph(Path("mat.png")).pixel == pytest.approx(50e-9, rel=1e-3)
