"""Pictures: drawn by a child process, which may find no OpenGL."""

# SPDX-License-Identifier: GPL-3.0-or-later

import base64
import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pipeline.geometry.cells import cell_faces, polygons_of
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.report.page.page import write_report
from pipeline.report.views.drawing import BACKGROUND
from pipeline.report.views.mesh_scenes import MeshSubject
from pipeline.report.views.painter import possible, trimmed
from pipeline.report.views.render import Painting, rendering_environment
from pipeline.report.views.scenes import SCENES, Subject, fiber_surface
from pipeline.report.views.subject import subject_of
from tests.report.contents import SOLUTION, still_flow, whole
from tests.report.pages import read


def test_a_mat_alone_can_be_seen_from_above_and_from_the_side() -> None:
    mat = whole().read(Mat)
    assert possible(Subject(mat)) == ("mat-top", "mat-side")


def test_everything_can_be_seen_of_a_whole_run() -> None:
    subject = subject_of(whole(still_flow()))
    assert subject is not None
    assert possible(subject) == tuple(SCENES)


def test_ends_of_fibers_at_the_sides_of_the_plan_are_gray_and_nothing_else_is() -> None:
    content = whole()
    subject = subject_of(content)
    assert subject is not None
    skin = fiber_surface(subject)
    color = np.asarray(skin.cell_data["color"]).astype(int)
    gray = np.ptp(color, axis=1) < 12
    slab = content.read(Mat).slab
    middle = np.asarray(skin.cell_centers().points) * 1e-6
    gap = np.minimum(middle[:, :2] - slab.lower[:2], np.subtract(slab.upper[:2], middle[:, :2])).min(axis=1)
    # three fibers from side to side have six ends
    assert gray.sum() >= 6
    np.testing.assert_array_equal(gray, gap < 1e-11)


def test_pictures_lose_their_empty_margin() -> None:
    picture = Image.new("RGB", (300, 200), BACKGROUND)
    picture.paste("black", (100, 50, 200, 150))
    # 16 pixels are kept on each side
    assert trimmed(picture).size == (132, 132)


@pytest.mark.usefixtures("rendering")
def test_a_page_holds_a_picture_of_every_scene(tmp_path: Path) -> None:
    path = write_report(whole(still_flow(), SOLUTION), tmp_path)
    page = read(path.read_text(encoding="utf-8"))
    # the reason, if there is one, is worth more than the list of what is missing
    assert "no-pictures" not in page.values("id"), [text for text in page.text if "process" in text]
    drawn = {value.removeprefix("picture-") for value in page.values("id") if value.startswith("picture-")}
    assert drawn == set(SCENES)
    for source in page.values("src"):
        data = base64.b64decode(source.removeprefix("data:image/jpeg;base64,"), validate=True)
        pixels = np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))
        # something other than background, and it has colors
        assert pixels.std() > 5
    assert path.stat().st_size < 5e6


def test_where_nothing_can_be_rendered_the_page_is_made_without_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # VTK ends the process that asks a missing X server for a window
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkXOpenGLRenderWindow")
    page = read(write_report(whole(), tmp_path).read_text(encoding="utf-8"))
    assert "no-pictures" in page.values("id")
    assert "quality" in page.values("id")


def test_a_mistake_in_a_scene_is_told_and_not_hidden(tmp_path: Path) -> None:
    mat = whole().read(Mat)
    with Painting(Subject(mat), ("no-such-scene",)) as painting:
        assert "KeyError: 'no-such-scene'" in painting.finished().trouble


def test_without_a_screen_vtk_is_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "VTK_DEFAULT_OPENGL_WINDOW"):
        monkeypatch.delenv(name, raising=False)
    assert rendering_environment()["VTK_DEFAULT_OPENGL_WINDOW"] == "vtkEGLRenderWindow"
    monkeypatch.setenv("DISPLAY", ":0")
    assert "VTK_DEFAULT_OPENGL_WINDOW" not in rendering_environment()


@pytest.mark.usefixtures("rendering")
def test_hexahedra_are_cut_without_holes() -> None:
    # a mesh without a hole, as large as the mat is: every pixel of its section is a cell
    corners = np.stack(np.meshgrid(*[np.arange(6)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    steps = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    first = np.stack(np.meshgrid(*[np.arange(5)] * 3, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    cells = (first + steps) @ np.array([36, 6, 1])
    found = cell_faces(polygons_of("hexahedron", cells), np.repeat(np.arange(125), 6))
    offsets = np.arange(0, 4 * len(found.owner) + 1, 4)
    patch = Patch("boundary", len(found.neighbour), len(found.owner) - len(found.neighbour))
    mesh = FaceMesh(
        np.multiply(corners, 2e-6, dtype=np.float64),
        found.polygons.ravel(),
        offsets,
        found.owner,
        found.neighbour,
        125,
        (patch,),
    )
    with Painting(MeshSubject(mesh, np.full(3, 5e-6)), ("section", "section-worst"), "png") as painting:
        pictures = painting.finished()
    assert pictures.trouble == ""
    pixels = np.asarray(Image.open(io.BytesIO(pictures.files["section"])).convert("RGB"), int)[20:-20, 20:-20]
    # cells and their outlines are gray; the patch behind, which would show in a hole, is blue
    assert (np.ptp(pixels, axis=2) < 40).mean() > 0.995
    worst = np.asarray(Image.open(io.BytesIO(pictures.files["section-worst"])).convert("RGB"), int)
    # one of 25 squares is red
    red = (worst[:, :, 0] > 180) & (worst[:, :, 1] < 80)
    assert 0.02 < red.mean() < 0.06
