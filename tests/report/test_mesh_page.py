"""The page of a mesh that is not ours: what stands in it, and that a stranger's names stay text."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline.export.formats.openfoam.case import write_openfoam
from pipeline.export.read import mesh_files, read_mesh
from pipeline.export.settings import ExportSettings
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.nouns.quality import Metric
from pipeline.quality.judge import judge
from pipeline.quality.settings import QualitySettings
from pipeline.report.page.charts import metric_histogram
from pipeline.report.page.content import MeshContent, SourceFile
from pipeline.report.page.mesh_page import filled_mesh_page, mesh_sections, subject_of_mesh, write_mesh_page
from pipeline.report.page.quality_section import unit_of
from pipeline.report.views.layers import layers_of_mesh
from pipeline.report.views.model_file import write_model
from pipeline.report.views.painter import possible
from pipeline.report.views.render import Pictures
from tests.cli.conftest import Fibertwin
from tests.cli.conftest import fibertwin as fibertwin  # the fixture
from tests.cli.test_quality import good_mesh
from tests.openfoam import AIR
from tests.report.devtools import CHROMIUM, Browser
from tests.report.pages import Page, read
from tests.sample_meshes import cylinder, duct

EVIL = "<script>alert(1)</script>"


def content(mesh: FaceMesh, path: Path = Path("some/mesh.vtu"), strict: bool = False) -> MeshContent:
    limits = QualitySettings(non_orthogonality=5.0) if strict else QualitySettings()
    return MeshContent(path, mesh, judge(mesh, limits), limits, "The limits are checkMesh's", ())


def page_of(mesh: MeshContent) -> Page:
    return read(filled_mesh_page(mesh, mesh_sections(mesh), Pictures()))


@pytest.fixture(scope="module")
def mesh() -> FaceMesh:
    return duct((4, 4, 8), (10e-6, 10e-6, 20e-6), jitter=0.2).face_mesh()


def test_it_has_the_sections_of_a_runs_page_that_a_mesh_can_have(mesh: FaceMesh) -> None:
    page = page_of(content(mesh, strict=True))
    assert {"summary", "mesh", "quality", "provenance"} <= set(page.values("id"))
    assert {"mat", "duct", "comparison", "prediction"}.isdisjoint(page.values("id"))
    # a histogram for each metric that has a spread, the place of the worst, and what it breaks
    assert len([value for value in page.values("id") if re.fullmatch(r"metric-\w+-figure_1", value)]) == 10
    index, angle, place = judge(mesh).metrics["non_orthogonality"].worst[0]
    assert f"internal face {index}" in page.text
    assert f"{angle:.4g} deg" in page.text
    assert f"{1e6 * place[2]:.3f}" in page.text
    assert any("usable, with a loss of accuracy" in text for text in page.text)


def test_cells_and_patches_are_told_by_what_they_are(mesh: FaceMesh) -> None:
    text = page_of(content(mesh)).text
    assert f"{mesh.cells:,} tetrahedra" in text
    for patch in mesh.patches:
        assert text[text.index(patch.name) :].count(f"{patch.count:,}")
    hexahedra = cylinder(0.1, 1e-6, around=4, outward=3, turns=1)
    assert f"{hexahedra.cells:,} hexahedra" in page_of(content(hexahedra)).text


@pytest.mark.parametrize(("size", "unit"), [(20e-6, "µm"), (0.02, "mm"), (20.0, "m")])
def test_lengths_are_told_in_the_unit_of_the_mesh(size: float, unit: str) -> None:
    mesh = duct((2, 2, 4), (0.5 * size, 0.5 * size, size)).face_mesh()
    assert unit_of(mesh).name == unit
    assert f"10 × 10 × 20 {unit}" in page_of(content(mesh)).text
    assert f"x [{unit}]" in page_of(content(mesh)).text


def test_names_of_strangers_are_text(mesh: FaceMesh) -> None:
    patches = (Patch(EVIL, mesh.patches[0].start, mesh.patches[0].count), *mesh.patches[1:])
    evil = dataclasses.replace(
        content(FaceMesh(mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, mesh.cells, patches)),
        path=Path(EVIL.replace("/", "-")), limits_of=EVIL, files=(SourceFile(EVIL, 1, EVIL),),
    )  # fmt: skip
    page = read(filled_mesh_page(evil, mesh_sections(evil), Pictures(trouble=EVIL)))
    assert "script" not in page.tags
    # patch, limits twice, file, digest, trouble; and the path in the title, the heading and two commands
    assert sum(text.count("alert(1)") for text in page.text) >= 8


def test_a_patch_that_a_boundary_file_calls_a_script_does_not_become_one(
    fibertwin: Fibertwin, mesh: FaceMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # pictures take seconds, and have tests of their own
    monkeypatch.setattr("pipeline.report.views.render.Painting.__init__", lambda *_: None)
    monkeypatch.setattr("pipeline.report.views.render.Painting.__exit__", lambda *_: None)
    monkeypatch.setattr("pipeline.report.views.render.Painting.finished", lambda _: Pictures())
    case = tmp_path / "<img src=x onerror=alert(2)>"
    write_openfoam(mesh, case, AIR, settings=ExportSettings(encoding="ascii"))
    boundary = case / "constant/polyMesh/boundary"
    boundary.write_text(boundary.read_text().replace("inlet", "<script>alert`1`</script>"))
    said = fibertwin("quality", case, "--report", tmp_path / "page.html")
    assert "inlet" not in said.out
    page = read((tmp_path / "page.html").read_text(encoding="utf-8"))
    assert {"script", "img"}.isdisjoint(page.tags)
    assert "<script>alert`1`</script>" in page.text


def test_provenance_holds_every_file_with_its_digest(
    fibertwin: Fibertwin, mesh: FaceMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pipeline.report.views.render.Painting.__init__", lambda *_: None)
    monkeypatch.setattr("pipeline.report.views.render.Painting.__exit__", lambda *_: None)
    monkeypatch.setattr("pipeline.report.views.render.Painting.finished", lambda _: Pictures())
    write_openfoam(mesh, tmp_path / "case", AIR)
    (tmp_path / "case/it.foam").touch()
    assert fibertwin("quality", tmp_path / "case/it.foam", "--report", tmp_path / "new/page.html").code in (0, 3)
    text = read((tmp_path / "new/page.html").read_text(encoding="utf-8")).text
    files = mesh_files(tmp_path / "case/it.foam")
    assert [file.name for file in files] == ["points", "faces", "owner", "neighbour", "boundary"]
    for file in files:
        assert hashlib.sha256(file.read_bytes()).hexdigest() in text
        assert f"{file.stat().st_size:,}" in text


def test_a_page_that_cannot_be_written_is_our_error(fibertwin: Fibertwin, mesh: FaceMesh, tmp_path: Path) -> None:
    write_openfoam(mesh, tmp_path / "case", AIR)
    (tmp_path / "file").touch()
    said = fibertwin("quality", tmp_path / "case", "--report", tmp_path / "file/page.html", "--quiet")
    assert said.code == 1
    assert said.err.startswith("error: cannot write ")


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not on the PATH")
def test_no_script_of_a_stranger_runs_in_a_browser(mesh: FaceMesh, tmp_path: Path) -> None:
    name = "<script>document.title='run'</script><img/src=x/onerror=document.title='run'>"
    patches = (Patch(name, mesh.patches[0].start, mesh.patches[0].count), *mesh.patches[1:])
    evil = content(FaceMesh(mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, mesh.cells, patches))
    (tmp_path / "page.html").write_text(filled_mesh_page(evil, mesh_sections(evil), Pictures()), encoding="utf-8")
    write_model(layers_of_mesh(evil), "a model", tmp_path / "model.html")
    for file, title in (("page.html", "some/mesh.vtu · fibertwin"), ("model.html", "a model · fibertwin")):
        with Browser(tmp_path / file, tmp_path / f"{file}-profile") as browser:
            browser.wait_for("document.readyState === 'complete'")
            browser.wait_for(f"document.body.textContent.includes({json.dumps(name)})")
            assert browser.evaluate("document.title") == title
            assert browser.evaluate("document.images.length") == 0
            assert browser.complaints == []
            assert browser.asked == []


@pytest.mark.usefixtures("rendering")
def test_a_mesh_of_hexahedra_has_all_its_pictures(tmp_path: Path) -> None:
    this = content(cylinder(0.1, 1e-6, around=6, outward=4, turns=1), strict=True)
    write_mesh_page(this, tmp_path / "page.html")
    page = read((tmp_path / "page.html").read_text(encoding="utf-8"))
    assert "no-pictures" not in page.values("id"), [text for text in page.text if "process" in text]
    drawn = {value.removeprefix("picture-") for value in page.values("id") if value.startswith("picture-")}
    assert drawn == set(possible(subject_of_mesh(this))) == {"outside", "section", "section-worst", "worst-places"}


def test_a_mesh_that_keeps_its_limits_has_no_places_of_trouble() -> None:
    subject = subject_of_mesh(content(good_mesh()))
    assert subject.worst is None
    assert possible(subject) == ("outside", "section", "section-worst")


def test_the_written_mesh_is_read_back_with_its_files(mesh: FaceMesh, tmp_path: Path) -> None:
    write_openfoam(mesh, tmp_path, AIR)
    np.testing.assert_array_equal(read_mesh(tmp_path).points, mesh.points)
    assert mesh_files(tmp_path) == mesh_files(tmp_path / "constant/polyMesh")


@settings(max_examples=40, deadline=None)
@given(
    values=st.lists(st.floats() | st.floats(0, 100), max_size=30),
    limit=st.none() | st.floats(0, 100),
    worst_is=st.sampled_from(["largest", "smallest"]),
)
def test_a_histogram_takes_whatever_a_strangers_mesh_measures(
    values: list[float], limit: float | None, worst_is: str
) -> None:
    metric = Metric("skewness", "m2", "faces", 0.0, 1.0, 1.0, 1.0, limit, worst_is, 0, (), "")
    with np.errstate(all="ignore"):
        drawn = metric_histogram(metric, np.array(values, float))
    assert drawn is None or drawn.startswith("<svg")
