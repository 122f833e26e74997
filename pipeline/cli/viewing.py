"""`fibertwin view` and `fibertwin report`: look at a run in a window, as a picture, or as a page; or at several."""

# SPDX-License-Identifier: GPL-3.0-or-later

import json
import sys
from pathlib import Path

from rich.console import Console

from pipeline.cli.listen import listening
from pipeline.errors import CaseError, StageError
from pipeline.line.places import disk_trouble_explained, own_file, own_folder
from pipeline.line.run import Run, report
from pipeline.nouns.fibers import Mat
from pipeline.progress import Progress
from pipeline.report.page.compared_page import comparison_json, write_comparison
from pipeline.report.pdf import browser, print_page
from pipeline.report.stage import PAGE_JSON, REPORT
from pipeline.report.views.painter import possible
from pipeline.report.views.render import Painting, screenless
from pipeline.report.views.scenes import SCENES, Subject, show
from pipeline.report.views.subject import subject_of
from pipeline.writing import write_whole

COMPARED = "compared.html"
"""Page of several runs when nobody names a file."""
PICTURES = "pictures"
"""Folder of a run that pictures go into when nobody names a file."""
_KINDS = {".png": "png", ".jpg": "jpg", ".jpeg": "jpg"}
_FIRST_CHOICE = "duct"
_NOTHING = "{} has no mat yet, so there is nothing to see; fibertwin run makes one"


def write_pages(folders: tuple[Path, ...], into: Path | None, pdf: bool, as_json: bool, quiet: bool) -> None:
    """Write the page of a run, or of several side by side, and say where it is."""
    if pdf:
        browser()  # before anything is made for nothing
    with listening(Console(stderr=True), quiet or as_json) as progress:
        page = _page_of_one(folders[0], into, progress) if len(folders) == 1 else _compared(folders, into, progress)
        made = [page]
        if pdf:
            progress("report: printing")
            made.append(page.with_suffix(".pdf"))
            with disk_trouble_explained(made[-1]):
                print_page(page, made[-1])
    if as_json:
        sys.stdout.write(_json_of(folders))
    elif not quiet:
        for path in made:
            Console().print(str(path), markup=False, highlight=False, soft_wrap=True)


def _page_of_one(folder: Path, into: Path | None, progress: Progress) -> Path:
    page = report(folder, progress)
    if into is None:
        return page
    with disk_trouble_explained(into):
        write_whole(into, page.read_bytes())
    return into


def _compared(folders: tuple[Path, ...], into: Path | None, progress: Progress) -> Path:
    path = into or Path(COMPARED)
    with disk_trouble_explained(path):
        write_comparison([Run.opened(folder) for folder in folders], path, progress)
    return path


def _json_of(folders: tuple[Path, ...]) -> str:
    if len(folders) == 1:
        return (folders[0] / REPORT.name / PAGE_JSON).read_text(encoding="utf-8")
    return json.dumps(comparison_json([Run.opened(folder) for folder in folders]), indent=2, allow_nan=False) + "\n"


def view_run(folder: Path, scene: str | None, screenshot: Path | None) -> None:
    """Open a window on a run, or draw pictures where a file is asked for or there is no screen."""
    subject = subject_of(Run.opened(folder))
    if subject is None:
        raise StageError(_NOTHING.format(folder))
    there = possible(subject)
    if scene is not None:
        _check_scene(scene, there, folder)
    if screenshot is not None:
        kind = _KINDS.get(screenshot.suffix.lower())
        if kind is None:
            raise CaseError(f"cannot draw {screenshot}: the name must end with one of {', '.join(_KINDS)}")
        wanted = scene or (_FIRST_CHOICE if _FIRST_CHOICE in there else there[0])
        _draw(subject, {wanted: screenshot}, kind)
    elif screenless():
        names = (scene,) if scene else there
        with disk_trouble_explained(folder):
            files = {name: own_file(own_folder(folder, PICTURES) / f"{name}.png") for name in names}
        _draw(subject, files, "png")
    else:
        show(subject, there, scene, f"fibertwin: {folder}")


def write_model_of_run(folder: Path, path: Path) -> None:
    """Write what a run has as a model to turn in a browser."""
    from pipeline.report.views.layers import layers_of_run
    from pipeline.report.views.model_file import write_model

    out = Console()
    with listening(out, False) as progress:
        content = Run.opened(folder)
        if content.get(Mat) is None:
            raise StageError(_NOTHING.format(folder))
        progress("collecting surfaces")
        with disk_trouble_explained(path):
            write_model(layers_of_run(content), content.name, path)
    size = path.stat().st_size / 1e6
    out.print(f"{path} ({size:.1f} MB; open it in a browser)", markup=False, highlight=False, soft_wrap=True)


def _check_scene(scene: str, there: tuple[str, ...], folder: Path) -> None:
    if scene not in SCENES:
        raise CaseError(f"there is no scene {scene!r}; the scenes are {', '.join(SCENES)}")
    if scene not in there:
        raise StageError(f"{folder} has not what the scene {scene!r} shows; it has {', '.join(there)}")


def _draw(subject: Subject, files: dict[str, Path], kind: str) -> None:
    out = Console()
    with listening(out, False) as progress, Painting(subject, files, kind) as painting:
        progress(f"drawing {', '.join(files)}")
        pictures = painting.finished()
    if pictures.trouble:
        raise StageError(
            f"no picture could be drawn: {pictures.trouble}; rendering needs OpenGL, without a screen through EGL or "
            "OSMesa: on Debian, apt-get install libegl1 libgl1-mesa-dri"
        )
    for name, path in files.items():
        with disk_trouble_explained(path):
            write_whole(path, pictures.files[name])
        out.print(str(path), markup=False, highlight=False, soft_wrap=True)
