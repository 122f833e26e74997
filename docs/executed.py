"""Runs what the site shows when the site is built: the notebook with its outputs, and the gallery's figures.

MkDocs calls the functions that start with ``on_`` (`hooks` in mkdocs.yml). Nothing of it is written into docs/.
``FIBERTWIN_GALLERY=kept`` takes the figures that are kept there instead of drawing them again, which takes half a
minute and OpenGL.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import ast
import contextlib
import io
import json
import logging
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    # only the site's builder has it: the tests that look for examples here have not
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

HERE = Path(__file__).parent
NOTEBOOK = "notebooks/first_case.ipynb"
GALLERY = (("docs/make_gallery.py",), ("-m", "validation.paper_figures"))
"""What draws the gallery into a folder: mats and models. Studies and solved flows take hours, and are kept."""

log = logging.getLogger("mkdocs.plugins.executed")


def on_files(files: "Files", config: "MkDocsConfig") -> "Files":
    """Add the notebook as a page, and put the figures drawn now in the place of those kept."""
    from mkdocs.structure.files import File

    text, figures = executed(HERE / NOTEBOOK)
    place = Path(NOTEBOOK).with_suffix("")
    made: dict[str, str | bytes] = {f"{place}.md": text}
    made |= {f"{place.parent}/{name}": svg for name, svg in figures.items()}
    if os.environ.get("FIBERTWIN_GALLERY") != "kept":
        made |= {f"gallery/{name}": content for name, content in drawn_gallery().items()}
    for name, content in made.items():
        before = files.get_file_from_path(name)
        if before is not None:
            files.remove(before)
        files.append(File.generated(config, name, content=content))
    return files


def on_page_markdown(markdown: str, page: "Page", config: "MkDocsConfig", files: "Files") -> str:
    """Lead to the notebook's page where the text leads to its file."""
    return markdown.replace(f"({NOTEBOOK})", f"({NOTEBOOK.replace('.ipynb', '.md')})")


def drawn_gallery() -> dict[str, bytes]:
    """Draw the gallery anew; the figures by their names."""
    from pipeline.report.views.render import rendering_environment

    with tempfile.TemporaryDirectory() as folder:
        for command in GALLERY:
            log.info("drawing the gallery: %s", " ".join(command))
            # a process of its own: VTK ends the one that asks in vain for OpenGL
            done = subprocess.run(
                [sys.executable, *command, folder], cwd=HERE.parent, env=rendering_environment(), check=False,
                capture_output=True, text=True,
            )  # fmt: skip
            if done.returncode:
                log.warning("the gallery was not drawn (exit code %d): %s", done.returncode, done.stderr[-500:])
        return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir())}


def executed(notebook: Path) -> tuple[str, dict[str, str]]:
    """Run a notebook's cells one after the other.

    Parameters
    ----------
    notebook : Path

    Returns
    -------
    text : str
        Its page: each cell, and below it what it printed and what it ended with.
    figures : dict of str to str
        SVG of each matplotlib figure that a cell ended with, by the file that the page names.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    parts, figures = [], {}
    for number, cell in enumerate(json.loads(notebook.read_text(encoding="utf-8"))["cells"]):
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
            continue
        parts.append(f"```python\n{source}\n```")
        said, value = _run(source, f"{notebook.name}, cell {number}", names)
        if said:
            parts.append(f"```text\n{said.rstrip()}\n```")
        if value is not None and hasattr(value, "savefig"):
            name = f"{notebook.stem}_{number}.svg"
            figures[name] = _svg(value)
            parts.append(f"![What this cell draws]({name})")
        elif value is not None:
            parts.append(f"```text\n{value!r}\n```")
    parts.append(f"The notebook itself: [{notebook.name}]({notebook.name}). Its outputs were made with this page.")
    return "\n\n".join(parts) + "\n", figures


def _run(source: str, name: str, names: dict[str, Any]) -> tuple[str, Any]:
    """Give what a cell prints, and the value of the expression that it ends with."""
    tree = ast.parse(source, name)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    value = None
    with contextlib.redirect_stdout(io.StringIO()) as said:
        exec(compile(tree, name, "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), name, "eval"), names)
    return said.getvalue(), value


def _svg(figure: Any) -> str:
    import matplotlib as mpl

    with mpl.rc_context({"svg.hashsalt": "notebook"}), io.StringIO() as text:
        figure.savefig(text, format="svg", metadata={"Date": None})
        return text.getvalue()
