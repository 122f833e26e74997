"""The stage that takes a mat's picture, and what the page shows of it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pipeline.case import Case, read_case
from pipeline.errors import StageError
from pipeline.line.results import Results
from pipeline.line.run import Run, run
from pipeline.line.stages import LINE
from pipeline.microscope.read import read_micrograph
from pipeline.nouns.micrographs import Micrographs
from pipeline.nouns.section import Photograph, Photographs
from pipeline.report.page.micrograph_section import micrograph

CASE = """
[mat]
generator = "layered"
side = "12 um"
fiber_diameter = "1 um"
relaxation_slope = 0.15
seed = 3
[mat.stop]
coverage = 1
[micrograph]
"""


def case_in(folder: Path, more: str = "") -> Case:
    (folder / "case.toml").write_text(CASE + more, encoding="utf-8")
    return read_case(folder / "case.toml")


def shown_of(results: Results) -> tuple[Photograph, ...]:
    section = micrograph(results)
    assert section is not None
    first = section.parts[0]
    assert isinstance(first, Photographs)
    return first.pictures


def test_a_mat_stands_beside_the_picture_of_its_medium_at_the_same_scale(tmp_path: Path) -> None:
    # the medium's picture is wider than the mat and not as high: 200 x 100 pixels of 100 nm beside 12 um of mat
    shades = np.random.default_rng(0).integers(0, 255, (100, 200), dtype=np.uint8)
    Image.fromarray(shades).save(tmp_path / "web.png")
    case = case_in(tmp_path, 'file = "web.png"\npixel = "100 nm"\n')
    run(case, tmp_path / "run", "micrograph", without=frozenset({"report"}))
    results = Run(case, tmp_path / "run")
    pictures = results.read(Micrographs)
    assert [pictures.width, pictures.height] == pytest.approx([12e-6, 10e-6])
    # each says its own scale
    for name in ("twin.png", "measured.png"):
        read = read_micrograph(tmp_path / "run/micrograph" / name)
        assert read.brightness.shape == (100, 120), name
        assert read.pixel == pytest.approx(100e-9, rel=1e-3), name
    # cut out of the middle
    with Image.open(tmp_path / "run/micrograph/measured.png") as picture:
        cut = np.asarray(picture).astype(float)
    assert np.corrcoef(cut.ravel(), shades[:, 40:160].ravel())[0, 1] > 0.999
    shown = shown_of(results)
    assert [each.source[:23] for each in shown] == ["data:image/jpeg;base64,"] * 2
    assert "web.png" in shown[1].caption


def test_without_a_picture_of_the_medium_the_twin_stands_alone(tmp_path: Path) -> None:
    case = case_in(tmp_path)
    run(case, tmp_path / "run", "micrograph", without=frozenset({"report"}))
    # a twentieth of the diameter
    with Image.open(tmp_path / "run/micrograph/twin.png") as picture:
        assert picture.size == (240, 240)
    assert len(shown_of(Run(case, tmp_path / "run"))) == 1
    # a run that is damaged still has a page
    (tmp_path / "run/micrograph/twin.png").write_bytes(b"no picture")
    assert shown_of(Run(case, tmp_path / "run"))[0].source == ""


def test_no_name_leads_out_of_a_run_s_folder(tmp_path: Path) -> None:
    case = case_in(tmp_path)
    run(case, tmp_path / "run", "micrograph", without=frozenset({"report"}))
    file = tmp_path / "run/micrograph/micrographs.json"
    file.write_text(file.read_text().replace("twin.png", "../../../etc/hostname"))
    with pytest.raises(StageError, match=r"micrographs\.json"):
        Results(case, tmp_path / "run", LINE).read(Micrographs)


def test_a_surface_has_no_picture(tmp_path: Path) -> None:
    text = '[mat]\ngenerator = "surface"\nfile = "medium.stl"\nunit = "um"\n[micrograph]\n'
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    (tmp_path / "medium.stl").write_text("solid", encoding="utf-8")
    outcomes = run(read_case(tmp_path / "case.toml"), tmp_path / "run", "micrograph", without=frozenset({"report"}))
    assert outcomes[-1].how == "skipped"
    assert "surface" in str(outcomes[-1].counts["reason"])
