"""The scene in a browser: it draws, turns, hides and tells, complains of nothing and asks nobody for anything."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from pipeline.geometry.triangles import enclosed_volume
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.nouns.patches import FIBERS
from pipeline.nouns.surface import Surface
from pipeline.quality.judge import judge
from pipeline.quality.settings import QualitySettings
from pipeline.report.page.content import MeshContent
from pipeline.report.views.drawing import PALETTE
from pipeline.report.views.layers import Layer, layers_of_mesh, layers_of_run, limited
from pipeline.report.views.scene_file import scene_of, write_scene
from tests.report.contents import having, whole
from tests.report.devtools import CHROMIUM, Browser
from tests.report.pages import read
from tests.sample_meshes import duct

in_a_browser = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not on the PATH"),
]
MIDDLE = (560.0, 350.0)
"""Of the canvas, which stands beside the panel."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scene") / "scene.html"
    write_scene(layers_of_run(whole()), "a run", path)
    return path


@pytest.fixture
def browser(page: Path, tmp_path: Path) -> Iterator[Browser]:
    with Browser(page, tmp_path / "profile") as browser:
        browser.wait_for("document.body?.dataset.state === 'drawn'")
        yield browser
        # whatever a test did with it
        assert browser.complaints == []
        assert browser.asked == []


def drawn(picture: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Cut the canvas out of the window."""
    return picture[:, 270:]


def changed(before: npt.NDArray[np.uint8], after: npt.NDArray[np.uint8]) -> float:
    """Give the share of pixels that look different."""
    return float((np.abs(drawn(before).astype(int) - drawn(after)).max(axis=2) > 20).mean())


def colorful(picture: npt.NDArray[np.uint8]) -> float:
    """Give the share of pixels that are no gray: what is drawn in a color."""
    return float((np.ptp(drawn(picture).astype(int), axis=2) > 25).mean())


class TestInABrowser:
    pytestmark = in_a_browser

    def test_fibers_and_patches_are_seen_on_the_pages_own_background(self, browser: Browser) -> None:
        picture = browser.picture()
        assert (picture[5, -5] == 255).all()
        assert colorful(picture) > 0.05

    def test_dragging_turns_wheel_zooms_and_reset_undoes_it(self, browser: Browser) -> None:
        first = browser.picture()
        browser.drag(MIDDLE, (MIDDLE[0] + 120, MIDDLE[1] + 40))
        turned = browser.picture()
        assert changed(first, turned) > 0.03
        browser.mouse("mouseWheel", *MIDDLE, deltaX=0, deltaY=-400)
        assert changed(turned, browser.picture()) > 0.03
        browser.evaluate("document.getElementById('reset').click()")
        assert changed(first, browser.picture()) == 0

    def test_shift_and_drag_moves_everything_by_as_much(self, browser: Browser) -> None:
        first = drawn(browser.picture())
        browser.drag(MIDDLE, (MIDDLE[0] + 50, MIDDLE[1]), modifiers=8)
        moved = drawn(browser.picture())
        same = np.abs(first[:, :-50].astype(int) - moved[:, 50:]).max(axis=2) < 40
        assert same[:, 100:-100].mean() > 0.97

    def test_two_fingers_zoom_and_one_turns(self, browser: Browser) -> None:
        first = browser.picture()
        x, y = MIDDLE
        browser.touch("touchStart", (x - 30, y), (x + 30, y))
        browser.touch("touchMove", (x - 90, y), (x + 90, y))
        browser.touch("touchEnd")
        larger = browser.picture()
        assert colorful(larger) > 1.3 * colorful(first)
        browser.touch("touchStart", (x, y))
        browser.touch("touchMove", (x + 80, y + 30))
        browser.touch("touchEnd")
        assert changed(larger, browser.picture()) > 0.03

    def test_what_is_unchecked_is_gone(self, browser: Browser) -> None:
        names = browser.evaluate("[...document.querySelectorAll('#layers label')].map(each => each.textContent.trim())")
        assert names[0] == FIBERS
        assert {"inlet", "outlet", "xmin", "ymax", "duct", "slab of the mat", "lines of the mesh"} < set(names)
        for _ in names:
            browser.evaluate("[...document.querySelectorAll('#layers input:checked')].forEach(each => each.click())")
        assert colorful(browser.picture()) == 0

    def test_the_cut_takes_everything_away_at_its_end(self, browser: Browser) -> None:
        first = colorful(browser.picture())
        set_cut = "const cut = document.getElementById('cut'); cut.value = {}; cut.dispatchEvent(new Event('input'))"
        browser.evaluate(f"(() => {{ {set_cut.format(500)} }})()")
        assert 0 < colorful(browser.picture()) < first
        assert browser.evaluate("document.getElementById('where').textContent") == "x = 5.000 µm"

    def test_a_click_tells_the_fiber_whose_color_is_there(self, browser: Browser) -> None:
        # without lines and light the color of a pixel is near its fiber's
        inputs = "[...document.querySelectorAll('#layers input')]"
        browser.evaluate(f"{inputs}.slice(1).forEach(each => {{ if (each.checked) each.click() }})")
        picture = browser.picture().astype(int)
        # within one triangle: where two colors meet, a pixel is of neither
        around = [np.roll(picture, shift, axis=(0, 1)) for shift in ((3, 0), (-3, 0), (0, 3), (0, -3))]
        even = (np.ptp(np.stack([picture, *around]), axis=0) < 3).all(axis=2)
        rows, columns = np.nonzero(even & (np.ptp(picture, axis=2) > 25) & (np.arange(picture.shape[1]) > 280))
        told = set()
        for k in np.linspace(0, len(rows) - 1, 40).astype(int):
            x, y = int(columns[k]), int(rows[k])
            browser.evaluate("document.getElementById('told').textContent = '?'")
            browser.drag((x, y), (x, y))
            browser.wait_for("document.getElementById('told').textContent !== '?'")
            text = browser.evaluate("document.getElementById('told').textContent")
            if match := re.fullmatch(r"fiber (\d+)", text):
                number = int(match[1])
                told.add(number)
                shade = picture[y, x] / max(float(np.linalg.norm(picture[y, x])), 1.0)
                color = PALETTE / np.linalg.norm(PALETTE.astype(float), axis=1)[:, None]
                assert int(np.argmax(color @ shade)) == number % len(PALETTE)
        # three fibers lie in this mat
        assert len(told) >= 2

    def test_the_dark_is_dark(self, page: Path, tmp_path: Path) -> None:
        with Browser(page, tmp_path / "profile", dark=True) as browser:
            browser.wait_for("document.body?.dataset.state === 'drawn'")
            picture = browser.picture()
            assert picture[5, -5].max() < 40
            assert colorful(picture) > 0.05
            assert browser.complaints == []


def model_of(html: str) -> dict[str, object]:
    found = re.search(r'<script id="model" type="application/json">(.*?)</script>', html, re.DOTALL)
    assert found
    content: dict[str, object] = json.loads(found[1])
    return content


def test_one_script_may_run_and_nothing_comes_from_elsewhere(page: Path) -> None:
    html = page.read_text(encoding="utf-8")
    assert not re.search(r"(?<!www.w3.org)(https?:)?//[a-z]+\.(?!w3\.org)", html)
    policy = re.search(r'content="(default-src[^"]*)"', html)
    assert policy
    assert policy[1].startswith("default-src 'none'; img-src data:")
    assert re.search(r"script-src '?(&#39;)?sha256-", policy[1])
    assert "unsafe-eval" not in policy[1]


def test_names_of_strangers_stay_text_in_a_scene() -> None:
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"
    mesh = duct((2, 2, 4)).face_mesh()
    patches = (Patch(evil, mesh.patches[0].start, mesh.patches[0].count), *mesh.patches[1:])
    mesh = FaceMesh(mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, mesh.cells, patches)
    content = MeshContent(Path("x"), mesh, judge(mesh), QualitySettings(), "", ())
    html = scene_of(layers_of_mesh(content), evil, flow=False)
    page = read(html)
    # the model and the viewer
    assert page.tags.count("script") == 2
    assert "img" not in page.tags
    layers = model_of(html)["layers"]
    assert isinstance(layers, list)
    assert layers[0]["name"] == evil


def test_the_fibers_of_a_run_are_those_of_its_mesh() -> None:
    content = whole()
    walls = content.read(FaceMesh).patch(FIBERS)
    assert len(layers_of_run(content).layers[0].triangles) == walls.stop - walls.start
    surface = content.read(Surface)
    alone = having(content.read(Mat), surface)
    np.testing.assert_array_equal(layers_of_run(alone).layers[0].triangles, surface.triangles)


def test_a_mat_alone_is_tubes_of_its_fibers_volume() -> None:
    mat = whole().read(Mat)
    layer = layers_of_run(having(mat)).layers[0]
    assert set(layer.number.tolist()) == set(range(mat.fibers))
    # 16-gons in circles of the fibers' radius, by the area of the polygon; bends cost a little
    polygon = 16 * 0.5 * np.sin(2 * np.pi / 16) * mat.radius[0] ** 2
    assert volume(layer) == pytest.approx(polygon * mat.segment_lengths().sum(), rel=0.03)


def volume(layer: Layer) -> float:
    return abs(enclosed_volume(layer.points, layer.triangles))


def test_too_many_triangles_are_thinned_out_and_the_page_says_so() -> None:
    mat = whole().read(Mat)
    layer = layers_of_run(having(mat)).layers[0]
    assert limited([layer], {}, largest=len(layer.triangles)).note == f"{len(layer.triangles):,} triangles"
    thin = limited([layer], {}, largest=len(layer.triangles) // 3)
    kept = len(thin.layers[0].triangles)
    assert 0 < kept <= len(layer.triangles) // 3
    assert f"{kept:,} triangles of {len(layer.triangles):,}: points closer than " in thin.note
    # a coarser surface of the same things
    assert volume(thin.layers[0]) == pytest.approx(volume(layer), rel=0.3)
    assert np.ptp(thin.layers[0].points, axis=0) == pytest.approx(np.ptp(layer.points, axis=0), rel=0.1)
