"""Templates filled: everything is escaped but the charts and tables that we made."""

# SPDX-License-Identifier: GPL-3.0-or-later

import base64
import re
from typing import Any

import jinja2
from markupsafe import Markup

from pipeline.nouns.section import Table
from pipeline.report.page.words import Check, Step
from pipeline.report.views.render import Pictures

_TYPESET = str.maketrans("u23", "µ²³")


def page_of(
    template: str,
    verdict: tuple[str, str],
    tiles: list[tuple[str, str]],
    checks: list[Check],
    steps: list[Step],
    pictures: Pictures,
    **made: Any,
) -> str:
    """Fill a page that extends ``layout.html.jinja``.

    Parameters
    ----------
    template : str
    verdict : tuple of 2 str
        The mark of the whole, and its words.
    tiles : list of (what, value)
    checks, steps : list
        What to trust and why; what to do next.
    pictures : Pictures
    **made
        What the template shows beside these: `name`, `provenance` and its own sections.
    """
    images = {
        name: "data:image/jpeg;base64," + base64.b64encode(data).decode("ascii")
        for name, data in pictures.files.items()
    }
    mark, headline = verdict
    return (
        templates()
        .get_template(template)
        .render(
            mark=mark,
            headline=headline,
            tiles=tiles,
            checks=checks,
            steps=steps,
            pictures=images,
            no_pictures=pictures.trouble,
            **made,
        )
    )


def templates() -> jinja2.Environment:
    """Give the templates of all pages; what is not given to one is an error, and not an empty place."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("pipeline.report.page"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["table"] = table_html
    environment.filters["kind"] = lambda part: type(part).__name__
    environment.filters["drawing"] = Markup
    environment.filters["typeset"] = typeset
    return environment


def typeset(text: str) -> str:
    """Write units as print does; a terminal and a case file spell them in ASCII.

    Examples
    --------
    >>> typeset("1.4 um, volume [um3], area [mm2]")
    '1.4 µm, volume [µm³], area [mm²]'
    """
    return re.sub(r"(?<=[ [])(um[23]?|mm?[23])\b", lambda unit: unit[0].translate(_TYPESET), text)


def table_html(table: Table) -> Markup:
    """Escape and lay out a table; columns of numbers are set to the right."""
    rest = [[row[k] for row in table.rows] for k in range(len(table.columns))]
    numeric = [all(_is_number(cell) for cell in column if cell) and any(column) for column in rest]

    def cells(tag: str, line: tuple[str, ...]) -> Markup:
        return Markup("").join(
            Markup("<{tag}{cls}>{text}</{tag}>").format(
                tag=Markup(tag), cls=Markup(' class="number"') if right else "", text=typeset(text)
            )
            for text, right in zip(line, numeric, strict=True)
        )

    head = Markup("<thead><tr>{}</tr></thead>").format(cells("th", table.columns)) if any(table.columns) else Markup("")
    body = Markup("").join(Markup("<tr>{}</tr>").format(cells("td", row)) for row in table.rows)
    return Markup('<div class="wide"><table>{}<tbody>{}</tbody></table></div>').format(head, body)


def _is_number(text: str) -> bool:
    return text[:1] in "0123456789+-<>" or text == "no answer"
