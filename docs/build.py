"""Build the site: a copy of docs/ with the gallery drawn anew, and Sphinx over it.

``python docs/build.py FOLDER``; ``--gallery kept`` takes the figures that are kept in docs/gallery instead of drawing
them again, which takes half a minute and OpenGL.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
GALLERY = (("docs/make_gallery.py",), ("-m", "validation.paper_figures"))
"""What draws the gallery into a folder: mats and models. Studies and solved flows take hours, and are kept."""


def build(site: Path, draw: bool) -> int:
    """Write the site into a folder.

    Parameters
    ----------
    site : Path
    draw : bool
        Whether the gallery is drawn anew.

    Returns
    -------
    int
        Exit code of Sphinx, which ends at its first warning.
    """
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "docs"
        shutil.copytree(ROOT / "docs", source, ignore=shutil.ignore_patterns("__pycache__"))
        for notebook in source.glob("notebooks/*.ipynb"):
            show_figures(notebook)
        if draw:
            draw_gallery(source / "gallery")
        command = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--quiet", str(source), str(site)]
        code = subprocess.run(command, cwd=ROOT, check=False).returncode
    # what a later build could reuse is made anew each time: a page never shows what the code no longer says
    shutil.rmtree(site / ".doctrees", ignore_errors=True)
    return code


def show_figures(notebook: Path) -> None:
    """Put a cell that the page does not show before the others: a kernel draws figures if it is told to."""
    content = json.loads(notebook.read_text(encoding="utf-8"))
    source = [
        "from IPython.core.pylabtools import select_figure_formats\n",
        "select_figure_formats(get_ipython(), {'svg'})",
    ]
    hidden = {"cell_type": "code", "metadata": {"tags": ["remove-cell"]}, "source": source}
    content["cells"].insert(0, hidden | {"outputs": [], "execution_count": None})
    notebook.write_text(json.dumps(content), encoding="utf-8")


def draw_gallery(folder: Path) -> None:
    """Draw the gallery's figures over those that are kept; CalledProcessError if one cannot be drawn."""
    from pipeline.report.views.render import rendering_environment

    for command in GALLERY:
        # a process of its own: VTK ends the one that asks in vain for OpenGL
        subprocess.run([sys.executable, *command, str(folder)], cwd=ROOT, env=rendering_environment(), check=True)


def main() -> int:
    """Read the command line and build."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--gallery", choices=("drawn", "kept"), default="drawn")
    words = parser.parse_args()
    return build(words.folder, words.gallery == "drawn")


if __name__ == "__main__":
    sys.exit(main())
