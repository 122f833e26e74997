"""The page: what stands in it, what does not, and that it asks nothing of anybody."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest

from pipeline.line.results import Results
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Curve, Settling, SolvingCost
from pipeline.nouns.mat_measures import MatMeasures
from pipeline.nouns.quality import QualityReport
from pipeline.progress import silent
from pipeline.quality.judge import judge
from pipeline.report.page.page import filled, sections
from pipeline.report.views.render import Pictures
from tests.report.contents import SECTIONS, SOLUTION, having, whole
from tests.report.pages import Page, read
from tests.sample_meshes import cylinder


@pytest.fixture(scope="module")
def content() -> Results:
    return whole()


def html_of(content: Results, trouble: str = "") -> str:
    return filled(content, sections(content, silent), Pictures(trouble=trouble))


@pytest.fixture(scope="module")
def html(content: Results) -> str:
    return html_of(content)


@pytest.fixture(scope="module")
def page(html: str) -> Page:
    return read(html)


def shown(page: Page) -> set[str]:
    return set(page.values("id")) & set(SECTIONS)


def test_a_whole_run_has_every_section(page: Page) -> None:
    assert shown(page) == set(SECTIONS)


def test_a_run_of_nothing_but_its_case_still_makes_a_page() -> None:
    page = read(html_of(having(folder=Path("runs/new"))))
    assert shown(page) == {"summary", "provenance"}
    assert any("not complete" in text for text in page.text)


def test_a_mat_alone_has_its_measures_and_its_prediction(content: Results) -> None:
    alone = having(content.read(Mat), content.read(MatMeasures))
    assert shown(read(html_of(alone))) == {"summary", "mat", "prediction", "provenance"}


def test_every_link_leads_to_a_place_on_the_page(page: Page) -> None:
    places = page.values("id")
    assert len(places) == len(set(places))
    for tag, name, value in page.attributes:
        if name in ("href", "src", "xlink:href"):
            assert value.startswith("data:") or value[1:] in places, (tag, name, value)


def test_nothing_on_the_page_comes_from_elsewhere(html: str) -> None:
    assert not re.search(r"(https?:)?//[a-z]", html)
    assert "@import" not in html
    assert set(re.findall(r"url\((.)", html)) == {"#"}
    assert {"script", "iframe", "object"}.isdisjoint(read(html).tags)


def test_what_a_stranger_wrote_is_text_and_nothing_else(content: Results) -> None:
    evil = '<script>alert(1)</script><img src=x onerror="alert(2)">'
    m = content.read(Mat)
    mat = Mat(m.nodes, m.first, m.radius, m.slab, m.seed, evil, m.periodic)
    made = {evil: {**content.made["mat"], "files": {evil: evil}, "libraries": {evil: evil}, "key": evil}}
    changed = having(mat, folder=Path(evil.replace("/", "")), made=made, left_out=(evil,))
    page = read(html_of(changed, evil))
    assert "script" not in page.tags
    assert not page.values("onerror")
    # origin, stage, file, digest, library, key, result left out, trouble: all are there for people to read
    assert sum(text.count("alert(1)") for text in page.text) >= 8


def test_each_metric_with_a_spread_has_its_histogram_and_its_worst_place(content: Results, page: Page) -> None:
    quality = content.read(QualityReport)
    drawn = {value for value in page.values("id") if re.fullmatch(r"metric-\w+-figure_1", value)}
    # a pyramid over a tetrahedron's face has a quarter of its volume, its parts a twelfth: no histogram to draw
    assert drawn == {f"metric-{name}-figure_1" for name in quality.metrics if name not in ("face_pyramid", "face_tets")}
    worst = quality.metrics["non_orthogonality"].worst[0]
    assert any(f"face {worst[0]}" in text for text in page.text)
    assert f"{1e6 * worst[2][0]:.3f}" in page.text


def test_a_solved_flow_is_held_against_every_model(content: Results) -> None:
    page = read(html_of(whole(SOLUTION)))
    davies = content.read(Comparison).models["davies"].mesh
    assert f"{davies / SOLUTION.pressure_drop - 1:+.1%}" in page.text
    assert "solution" in page.values("id")


def test_how_a_flow_settled_is_drawn_for_both_walls_and_what_inertia_did_is_told() -> None:
    looks = (6, 12, 18)
    settling = Settling((Curve("no_slip", looks, (9.0, 7.6, 7.5)), Curve("slip", looks, (7.0, 6.9, 6.8))))
    carried = dataclasses.replace(
        SOLUTION, reynolds=2.0, knudsen=0.01, regime="slip", inertia=True, pressure_drop_creeping=10.0
    )
    page = read(html_of(whole(carried, settling, SolvingCost(12.0, 2))))
    assert any(name.startswith("settling-") for name in page.values("id"))
    # 12.5 Pa with inertia, 10 without
    assert any("adds 0.25 of the drop" in text for text in page.text)
    assert any("12 s on 2 cores" in text for text in page.text)
    creeping = dataclasses.replace(carried, reynolds=0.002, inertia=False, pressure_drop_creeping=None)
    assert any("creeping flow" in text for text in read(html_of(whole(creeping))).text)


def test_a_page_without_pictures_says_why(content: Results) -> None:
    page = read(html_of(having(), "no OpenGL, said a test"))
    assert "no-pictures" in page.values("id")
    assert any("no OpenGL, said a test" in text for text in page.text)
    assert "img" not in page.tags


def test_equal_runs_make_equal_pages(content: Results, html: str) -> None:
    assert html_of(content) == html


def test_charts_take_the_ink_of_the_page(html: str) -> None:
    # black would vanish in the dark
    assert "currentColor" in html
    assert "#000000" not in html.split("</style>", 1)[1]


def test_fibers_of_many_diameters_are_told_with_their_spread(content: Results) -> None:
    m = content.read(Mat)
    radius = np.linspace(0.5e-6, 0.7e-6, m.fibers)
    mixed = Mat(m.nodes, m.first, radius, m.slab, -1, "by hand", m.periodic)
    html = html_of(having(mixed))
    assert "nobody drew these fibers" in html


def test_a_run_of_hexahedra_says_so_and_has_their_histograms(content: Results) -> None:
    mesh = cylinder(0.1, 0.7e-6, around=6, outward=4, turns=1)
    page = read(html_of(whole(mesh, judge(mesh))))
    assert f"{mesh.cells:,} hexahedra" in page.text
    assert not re.search(r"\d tetrahedra", " ".join(page.text))
    # pyramids over the faces of a hexahedron differ: there is a histogram to draw
    assert "metric-face_pyramid-figure_1" in page.values("id")
