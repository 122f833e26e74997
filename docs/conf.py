"""How Sphinx builds the site: pages in Markdown, the notebook run, the reference from the docstrings.

`python docs/build.py FOLDER` draws the gallery anew before; `make docs` calls it.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib.metadata
import pkgutil
from typing import TYPE_CHECKING, TypeVar, get_origin

from pygments.lexers import TextLexer

import pipeline

if TYPE_CHECKING:
    from docutils.nodes import Element
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

project = "fibertwin"
author = copyright = "fibertwin developers"
version = release = importlib.metadata.version("fibertwin")
extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_copybutton",
]
root_doc = "index"
# `name` in a docstring is a name
default_role = "literal"
exclude_patterns = ["templates", "data", "verification/*.md"]
templates_path = ["templates"]

# links to titles, as the pages write them
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence", "dollarmath"]
highlight_language = "none"
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_show_tb = True

autosummary_generate = True
# a package is a page, with its modules one below the other
autosummary_context = {
    "packages": {each.name for each in pkgutil.walk_packages(pipeline.__path__, "pipeline.") if each.ispkg}
}
# the docstrings give shapes and units, which say more than types
autodoc_typehints = "none"
add_module_names = False
autodoc_member_order = "bysource"
# classes list their members where they stand
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

html_math_renderer = "mathml"
html_theme = "furo"
html_title = "fibertwin"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_theme_options = {"sidebar_hide_name": False, "navigation_with_keys": True}
# the prompts of a session are no part of what is copied
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True


def setup(app: "Sphinx") -> None:
    """Leave out what has no page (variables and aliases of types, classes of other libraries); formulas as MathML."""
    app.add_lexer("csv", TextLexer)
    app.add_html_math_renderer("mathml", inline_renderers=(_formula, None), block_renderers=(_formula, None))
    app.connect("autodoc-skip-member", _skipped)


def _skipped(app: "Sphinx", kind: str, name: str, member: object, skip: bool, options: object) -> bool | None:
    alias = isinstance(member, TypeVar) or get_origin(member) is not None
    foreign = isinstance(member, type) and not member.__module__.startswith("pipeline")
    return True if kind != "class" and (alias or foreign) else None


def _formula(translator: "HTML5Translator", node: "Element") -> None:
    # only the site's builder has it: the tests that look for examples here have not
    from docutils.nodes import SkipNode
    from docutils.utils.math.latex2mathml import tex2mathml

    # browsers draw MathML by themselves: no script, which would have to come from somewhere
    translator.body.append(tex2mathml(node.astext(), as_block=node.tagname == "math_block"))
    raise SkipNode
