"""The model in a browser: it draws, turns, cuts, hides and tells, complains of nothing and asks nobody for anything."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from pipeline.capture.capture import Caught
from pipeline.capture.make import write_caught
from pipeline.cli.app import app
from pipeline.errors import CaseError
from pipeline.geometry.tets import volumes
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
from pipeline.report.views.model_cells import cells_of
from pipeline.report.views.model_file import model_html, write_model
from tests.report.contents import CAPTURE, SOLUTION, having, still_flow, whole
from tests.report.devtools import CHROMIUM, Browser
from tests.report.pages import read
from tests.sample_meshes import cylinder, duct

in_a_browser = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not on the PATH"),
]
MIDDLE = (560.0, 350.0)
"""Of the canvas, which stands beside the panel."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("model")
    # a flow on the cells, and particles beside the fibers
    solution = dataclasses.replace(SOLUTION, drag_per_fiber=(1e-9, 2e-9, 3e-9))
    caught = Caught(np.full((5, 3), 5e-6), np.array([1e-6] * 3 + [3e-6] * 2), np.zeros(5, np.int64), np.zeros(5))
    (folder / "capture").mkdir()
    write_caught(caught, folder / "capture" / "captured.vtp")
    content = whole(still_flow(), solution, CAPTURE, folder=folder)
    write_model(layers_of_run(content), "a run", folder / "model.html")
    return folder / "model.html"


@pytest.fixture(scope="module")
def opened(page: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    # a browser takes longer to start than the page to draw
    with Browser(page, tmp_path_factory.mktemp("profile")) as browser:
        yield browser


@pytest.fixture
def browser(opened: Browser) -> Iterator[Browser]:
    opened.load_again()
    opened.wait_for("document.body?.dataset.state === 'drawn'")
    yield opened
    # whatever a test did with it
    assert opened.complaints == []
    assert opened.asked == []


def drawn(picture: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Cut the canvas out of the window."""
    return picture[:, 270:]


def changed(before: npt.NDArray[np.uint8], after: npt.NDArray[np.uint8]) -> float:
    """Give the share of pixels that look different."""
    return float((np.abs(drawn(before).astype(int) - drawn(after)).max(axis=2) > 20).mean())


def give(browser: Browser, name: str, value: object) -> None:
    """Set what stands in a box, a list or a slider, as a hand would."""
    what = "checked" if isinstance(value, bool) else "value"
    browser.evaluate(
        f"(() => {{ const each = document.getElementById('{name}'); each.{what} = {json.dumps(value)};"
        "for (const kind of ['input', 'change']) each.dispatchEvent(new Event(kind)); })()"
    )


def only(browser: Browser, name: str) -> None:
    """Show one layer alone."""
    browser.evaluate(
        "[...document.querySelectorAll('#layers label')].forEach(each => { const box = each.querySelector('input');"
        f"if (box.checked !== (each.textContent.trim() === {json.dumps(name)})) box.click(); }})"
    )


def tell(browser: Browser, place: tuple[float, float]) -> str:
    """Click, and give what the page says is there."""
    browser.evaluate("document.getElementById('told').textContent = '?'")
    browser.drag(place, place)
    browser.wait_for("document.getElementById('told').textContent !== '?'")
    return str(browser.evaluate("document.getElementById('told').textContent"))


# areas of sections by the page's own functions, in the squares of its whole numbers
AREAS = """
var read = readCells(model.cells);
var area = (normal, offset) => {
  const { places } = sectionOf(read, normal, within(offset, normal));
  let sum = 0;
  for (let k = 0; k < places.length; k += 9) {
    const [a, b, c] = [0, 3, 6].map((n) => [0, 1, 2].map((axis) => places[k + n + axis]));
    sum += 0.5 * Math.hypot(...cross(b.map((v, n) => v - a[n]), c.map((v, n) => v - a[n])));
  }
  return sum;
};
var sections = () => [0, 1, 2].flatMap((axis) => {
  const normal = [0, 1, 2].map((k) => (k === axis ? 1 : 0));
  const places = [...new Set(Array.from(read.points).filter((_, k) => k % 3 === axis))];
  return places.map((place) => [place, ...[-1, 0, 1].map((step) => area(normal, place + step))]);
});
"""


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
        assert {"section of the cells", "144 streamlines", "caught particles of 1 µm: 3"} < set(names)
        for _ in names:
            browser.evaluate("[...document.querySelectorAll('#layers input:checked')].forEach(each => each.click())")
        assert colorful(browser.picture()) == 0

    def test_the_section_stands_in_the_middle_at_first_and_nowhere_vanishes(self, browser: Browser) -> None:
        assert browser.evaluate("document.getElementById('place').value") == "5.000"
        # grid planes of the mesh, the ends of the duct, and between them
        for place in (0, 2.5, 5, 5.001, 7.5, 9.999, 10):
            give(browser, "place", place)
            assert browser.evaluate("document.getElementById('place').value") == str(place)
            only(browser, "section of the cells")
            assert colorful(browser.picture()) > 0.1, place

    def test_a_plane_through_vertices_meets_as_much_as_its_neighbors(self, browser: Browser) -> None:
        # the duct is 10 um by 20 um across x and y, 10 by 10 across z, but for the bar across it
        areas = browser.evaluate(f"{AREAS}; sections()")
        assert len(areas) > 60
        for place, low, here, high in areas:
            assert min(low, high) - 1e-3 * high < here < max(low, high) + 1e-3 * high, place

    def test_a_tilted_plane_is_longer_by_the_cosine(self, browser: Browser) -> None:
        # below the bar the air is a plain box, 10 um wide: tilted by 10 degrees about y, it is wider by 1 / cos
        flat, tilted = browser.evaluate(
            f"{AREAS}; [0, 10].map((angle) => {{ const n = normalOf({{ axis: 2, tilts: [angle, 0] }});"
            "const low = [0, 1, 2].map((axis) => Math.min(...read.points.filter((_, k) => k % 3 === axis)));"
            "const high = [0, 1, 2].map((axis) => Math.max(...read.points.filter((_, k) => k % 3 === axis)));"
            "return area(n, n[0] * 0.5 * (low[0] + high[0]) + n[2] * (0.9 * low[2] + 0.1 * high[2])); })"
        )
        assert tilted / flat == pytest.approx(1 / np.cos(np.radians(10)), rel=1e-3)

    def test_dragging_moves_and_tilts_the_plane(self, browser: Browser) -> None:
        browser.evaluate("document.getElementById('z').click()")
        give(browser, "drag", "plane")
        browser.drag(MIDDLE, (MIDDLE[0] + 40, MIDDLE[1]))
        moved = float(browser.evaluate("document.getElementById('place').value"))
        # a sphere around everything fills the height of the view, and x lies across it
        across = browser.evaluate("2e6 * model.reach * model.step / document.getElementById('view').clientHeight")
        assert abs(moved - 5) == pytest.approx(40 * across, rel=0.01)
        give(browser, "drag", "tilt")
        browser.drag(MIDDLE, (MIDDLE[0], MIDDLE[1] + 60))
        assert browser.evaluate("plane.tilts.some(angle => Math.abs(angle) > 5)")

    def test_cells_wear_the_colors_of_a_field_and_a_click_tells_its_value(self, browser: Browser) -> None:
        browser.evaluate("document.getElementById('x').click()")
        only(browser, "section of the cells")
        give(browser, "section-lines", False)
        rows, columns = np.nonzero(np.ptp(drawn(browser.picture()).astype(int), axis=2) > 25)
        low, high = int(columns.min()) + 270, int(columns.max()) + 270
        row = int(rows.min()) + (int(rows.max()) - int(rows.min())) // 10
        places = [(low + share * (high - low), row) for share in (0.1, 0.3, 0.5, 0.7, 0.9)]
        seen = {}
        for number, name in enumerate(("speed", "pressure", "non orthogonality", "skewness", "aspect ratio")):
            give(browser, "cells-by", number)
            seen[name] = drawn(browser.picture())
            told = tell(browser, places[1])
            assert re.fullmatch(rf"cell \d+, {name} \S+( \S+)?", told), told
        # the whole flow has one speed, 2.5 cm/s, and its pressure falls evenly from 3 Pa to 0
        give(browser, "cells-by", 0)
        assert tell(browser, places[2]).endswith("speed 2.50 cm/s")
        give(browser, "cells-by", 1)
        values = [float(tell(browser, place).split()[-2]) for place in places]
        assert np.diff(values) == pytest.approx(np.full(4, np.diff(values).mean()), rel=0.05)
        assert np.ptp(seen["speed"][::9, ::9].reshape(-1, 3), axis=0).max() > 0
        assert len({picture.tobytes() for picture in seen.values()}) == 5

    def test_streamlines_and_caught_particles_are_drawn(self, browser: Browser) -> None:
        give(browser, "away", False)
        for name in ("144 streamlines", "caught particles of 3 µm: 2"):
            only(browser, name)
            assert colorful(browser.picture()) > 0.002, name

    def test_fibers_wear_their_drag(self, browser: Browser) -> None:
        only(browser, "fibers")
        first = browser.picture()
        give(browser, "fibers-by", 0)
        assert changed(first, browser.picture()) > 0.01
        assert browser.evaluate("document.querySelector('#fibers-legend .high').textContent") == "3.00 nN"

    def test_a_click_tells_the_fiber_whose_color_is_there(self, browser: Browser) -> None:
        # without lines and light the color of a pixel is near its fiber's
        inputs = "[...document.querySelectorAll('#layers input')]"
        browser.evaluate(f"{inputs}.slice(1).forEach(each => {{ if (each.checked) each.click() }})")
        give(browser, "away", False)
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


def test_names_of_strangers_stay_text_in_a_model() -> None:
    evil = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"
    mesh = duct((2, 2, 4)).face_mesh()
    patches = (Patch(evil, mesh.patches[0].start, mesh.patches[0].count), *mesh.patches[1:])
    mesh = FaceMesh(mesh.points, mesh.corners, mesh.offsets, mesh.owner, mesh.neighbour, mesh.cells, patches)
    content = MeshContent(Path("x"), mesh, judge(mesh), QualitySettings(), "", ())
    html = model_html(layers_of_mesh(content), evil, flow=False)
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


@pytest.mark.parametrize("mesh", [duct((2, 2, 4)).face_mesh(), cylinder(0.1, 0.7e-6, around=6, outward=4, turns=1)])
def test_the_tetrahedra_that_are_cut_fill_every_cell(mesh: FaceMesh) -> None:
    cells = cells_of(mesh)
    filled = np.bincount(cells.cell, np.abs(volumes(cells.points, cells.tets)), mesh.cells)
    np.testing.assert_allclose(filled, mesh.polyhedra().volumes, rtol=1e-9)
    assert cells.note == ""


def test_a_model_of_too_many_cells_keeps_those_in_the_middle_and_says_so() -> None:
    mesh = duct((6, 6, 12)).face_mesh()
    few = cells_of(mesh, largest=mesh.cells // 3)
    assert len(few.tets) == mesh.cells // 3
    assert f"shows {mesh.cells // 3:,} of {mesh.cells:,} cells" in few.note
    # a third of the volume, in the shape of the whole: each side is the cube root of a third
    share = np.ptp(few.points, axis=0) / np.ptp(mesh.points, axis=0)
    assert share == pytest.approx(np.full(3, (1 / 3) ** (1 / 3)), abs=0.2)


def test_quality_calls_the_file_to_turn_as_view_does() -> None:
    with pytest.raises(CaseError, match="--html FILE"):
        app(["quality", "mesh.vtu", "--scene", "model.html"], exit_on_error=False, print_error=False)
