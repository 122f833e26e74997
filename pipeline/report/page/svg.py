"""Charts as SVG that lives inside a page: ink in the page's own color, names that do not clash."""

# SPDX-License-Identifier: GPL-3.0-or-later

import io
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK = "#1a1a1a"
"""What is drawn in this color takes the color of the page's text, light or dark."""
BLUE, ORANGE, GREEN, RED = "#3b82c4", "#d97b35", "#2f9e77", "#d3222a"
"""Each is told from both a white and a black page, and from the others by color-blind readers."""

_STYLE: dict[str, Any] = {
    "text.color": INK,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10,
    "axes.labelsize": 9,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.fontsize": 8.5,
    "grid.color": "#808080",
    "grid.alpha": 0.25,
    "svg.fonttype": "path",  # text looks the same on every machine
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
}


def chart(name: str, draw: Callable[["Axes"], None], size: tuple[float, float] = (5.0, 3.3)) -> Markup:
    """Draw into one pair of axes and give an ``<svg>`` element.

    Parameters
    ----------
    name : str
        Of the chart within the page: its ids start with it.
    draw : callable
        Takes matplotlib Axes.
    size : tuple of 2 floats [inch]
        The page scales the chart to its column; this sets the shape, and how large the text is in it.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    # equal charts make equal pages: no date, no random id
    style: Any = {**_STYLE, "svg.hashsalt": name}
    with mpl.rc_context(style):
        figure = Figure(figsize=size, layout="constrained")
        draw(figure.subplots())
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    return Markup(inline(text.getvalue(), name))


def inline(document: str, name: str) -> str:
    """Turn an SVG file into an element for a page.

    Examples
    --------
    >>> inline('<?xml version="1.0"?><svg width="9pt" height="9pt"><path id="a" fill="#1a1a1a"/></svg>', "x")
    '<svg><path id="x-a" fill="currentColor"/></svg>'
    """
    element = document[document.index("<svg") :].strip()
    element = re.sub(r"<metadata>.*?</metadata>\s*", "", element, flags=re.DOTALL)
    head, rest = element.split(">", 1)
    head = re.sub(r' (width|height|version|xmlns(:\w+)?)="[^"]*"', "", head)
    element = f"{head}>{rest}".replace("xlink:href", "href")
    element = re.sub(r'\bid="', f'id="{name}-', element)
    element = re.sub(r'(href="#|url\(#)', rf"\g<1>{name}-", element)
    return element.replace(INK, "currentColor")
