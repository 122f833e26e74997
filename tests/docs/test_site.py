"""The site: built strictly, from files alone, with the notebook's outputs; and a gallery that is up to date."""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from tests.report.conftest import rendering as rendering  # the fixture
from validation.paper_figures import write_paper_figures

ROOT = Path(__file__).parents[2]
GALLERY = ROOT / "docs/gallery"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if importlib.util.find_spec("furo") is None:
        pytest.skip("the site's libraries are not installed; make docs does it")
    folder = tmp_path_factory.mktemp("site")
    # drawing the gallery has a test of its own
    command = [sys.executable, "docs/build.py", str(folder), "--gallery", "kept"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.slow
def test_nothing_on_the_site_is_loaded_from_elsewhere(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert len(pages) > 50
    for page in pages:
        html = page.read_text(encoding="utf-8")
        # links that a reader may follow are no requests; what a browser loads by itself is
        loaded = re.findall(r"<(?:script|img|iframe|source)[^>]* src=[\"']?([^\"'\s>]+)", html)
        loaded += re.findall(r"<link[^>]* rel=[\"']?(?:stylesheet|icon|preload)[^>]* href=[\"']?([^\"'\s>]+)", html)
        assert loaded
        assert not [address for address in loaded if "//" in address.split("?")[0]], page
    styles = " ".join(path.read_text(encoding="utf-8") for path in site.rglob("*.css"))
    assert not re.search(r"url\([\"']?(https?:)?//", styles)


@pytest.mark.slow
def test_the_notebook_is_shown_with_what_it_printed_and_drew(site: Path) -> None:
    html = (site / "notebooks/first_case.html").read_text(encoding="utf-8")
    assert re.search(r"\d+ fibers in \d+ straight pieces", html)
    assert re.search(r"Davies: [\d.]+ Pa", html)
    assert re.search(r'<img[^>]* src="\.\./_images/[^"]+\.(svg|png)"', html)
    assert 'href="notebooks/first_case.html"' in (site / "python.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_formula_of_the_reference_shows_its_units_and_its_source(site: Path) -> None:
    html = (site / "reference/modules/pipeline.analytics.formulas.html").read_text(encoding="utf-8")
    assert "Davies" in html
    assert "Eq. " in html
    assert "[m]" in html


def test_curves_of_the_models_in_the_gallery_are_what_is_drawn_now(tmp_path: Path) -> None:
    for path in write_paper_figures(tmp_path):
        drawn, kept = (curves(each.read_text(encoding="utf-8")) for each in (path, GALLERY / path.name))
        assert len(drawn) == len(kept) > 10, path.name
        for ours, theirs in zip(drawn, kept, strict=True):
            # another processor rounds the last digit otherwise; a curve that moved moves by more than 1e-4 of a point
            assert ours.shape == theirs.shape, path.name
            np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-4, err_msg=path.name)


def curves(svg: str) -> list[NDArray[np.float64]]:
    """Give the numbers of each path of a figure, in points."""
    paths = re.findall(r'<path[^>]*\bd="([^"]+)"', svg)
    return [np.array(re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", path), dtype=np.float64) for path in paths]


@pytest.mark.slow
@pytest.mark.usefixtures("rendering")
def test_pictures_of_mats_in_the_gallery_are_what_is_drawn_now(tmp_path: Path) -> None:
    subprocess.run([sys.executable, ROOT / "docs/make_gallery.py", tmp_path], cwd=ROOT, check=True)
    drawn = sorted(tmp_path.iterdir())
    assert len(drawn) == 9
    for path in drawn:
        ours, kept = (np.asarray(Image.open(each).convert("RGB"), int) for each in (path, GALLERY / path.name))
        # another renderer smooths edges otherwise; another mat would look otherwise everywhere
        assert ours.shape == kept.shape, path.name
        assert (np.abs(ours - kept).max(axis=2) > 40).mean() < 0.01, path.name
