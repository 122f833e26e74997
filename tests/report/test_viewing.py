"""`fibertwin view`: pictures of a run from the command"""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import pytest
from PIL import Image

from pipeline.cli.viewing import view_run, write_model_of_run
from pipeline.errors import CaseError, StageError
from pipeline.line.run import run
from tests.report.contents import CASE


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("viewed") / "run"
    run(CASE, folder, until="mat")
    return folder


@pytest.mark.usefixtures("rendering")
@pytest.mark.parametrize(("name", "kind"), [("a.png", "PNG"), ("new/b.jpg", "JPEG")])
def test_a_screenshot_is_of_the_kind_that_its_name_says(folder: Path, tmp_path: Path, name: str, kind: str) -> None:
    view_run(folder, "mat-side", tmp_path / name)
    with Image.open(tmp_path / name) as picture:
        assert picture.format == kind
        # a mat is wider than it is thick
        assert picture.width > picture.height


def test_what_cannot_be_drawn_is_refused_before_anything_is_drawn(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"must end with one of \.png, \.jpg, \.jpeg"):
        view_run(folder, None, tmp_path / "a.bmp")
    with pytest.raises(CaseError, match="the scenes are mat-top, mat-side, duct"):
        view_run(folder, "front", None)
    with pytest.raises(StageError, match="it has mat-top, mat-side"):
        view_run(folder, "cut", None)
    with pytest.raises(StageError, match="is no run"):
        view_run(tmp_path, None, None)


def test_a_machine_without_opengl_is_told_what_to_install(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkXOpenGLRenderWindow")
    with pytest.raises(StageError, match="apt-get install libegl1"):
        view_run(folder, None, tmp_path / "a.png")
    assert not (tmp_path / "a.png").exists()


def test_a_model_is_written_where_it_is_asked_for(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_model_of_run(folder, tmp_path / "new/model.html")
    assert "model.html (0." in capsys.readouterr().out
    assert "</html>" in (tmp_path / "new/model.html").read_text(encoding="utf-8")
    (tmp_path / "case.json").write_text((folder / "case.json").read_text())
    with pytest.raises(StageError, match="has no mat yet"):
        write_model_of_run(tmp_path, tmp_path / "model.html")
