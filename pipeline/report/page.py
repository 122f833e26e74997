"""report.html: one page that holds everything it shows, made from whatever of a run is there."""

import base64
import re
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from markupsafe import Markup

from pipeline.analytics.tables import Table
from pipeline.data import Floats, QualityReport
from pipeline.progress import Progress, silent
from pipeline.report import words
from pipeline.report.content import ReportContent
from pipeline.report.render import Painting, Pictures
from pipeline.report.scenes import Subject, possible
from pipeline.report.sections import sections, tiles

PAGE = "report.html"
_TYPESET = str.maketrans("u23", "µ²³")


def write_report(content: ReportContent, folder: Path, progress: Progress = silent) -> Path:
    """Write ``report.html``: every section for which the run has the results, none for what it has not.

    Parameters
    ----------
    content : ReportContent
    folder : Path
        Where the page goes; made if it is not there.
    progress : Progress

    Returns
    -------
    Path
        The page. It asks nothing of the network. Where nothing can be rendered it has no pictures and says why.
    """
    page = _page(content, progress)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / PAGE
    path.write_text(page, encoding="utf-8")
    return path


def subject_of(content: ReportContent) -> Subject | None:
    """Give what there is to draw; None before there is a mat."""
    if content.mat is None:
        return None
    return Subject(content.mat, content.surface, content.domain, content.mesh, _places_of_trouble(content.quality))


def _places_of_trouble(report: QualityReport | None) -> Floats | None:
    if report is None:
        return None
    places = [place for metric in report.metrics.values() for _, _, place in metric.worst[: metric.over_limit]]
    return np.array(places) if places else None


def _page(content: ReportContent, progress: Progress) -> str:
    subject = subject_of(content)
    if subject is None:
        return filled(content, sections(content, progress), Pictures())
    # the pictures are drawn by a process of their own, the charts meanwhile by this one
    with Painting(subject, possible(subject)) as painting:
        made = sections(content, progress)
        progress("report: pictures", 0.6)
        pictures = painting.finished()
    return filled(content, made, pictures)


def filled(content: ReportContent, made: dict[str, Any], pictures: Pictures) -> str:
    """Fill the template: everything of the content is escaped, only charts and tables are markup.

    Parameters
    ----------
    content : ReportContent
    made : dict
        What `pipeline.report.sections.sections` made of it.
    pictures : Pictures
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("pipeline.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["table"] = table_html
    environment.filters["typeset"] = typeset
    mark, headline = words.verdict(content)
    images = {
        name: "data:image/jpeg;base64," + base64.b64encode(data).decode("ascii")
        for name, data in pictures.files.items()
    }
    return environment.get_template("report.html.jinja").render(
        name=content.name,
        mark=mark,
        headline=headline,
        tiles=tiles(content),
        checks=words.checks(content),
        steps=words.steps(content),
        pictures=images,
        no_pictures=pictures.trouble,
        **made,
    )


def typeset(text: str) -> str:
    """Write units as print does; a terminal and a case file spell them in ASCII.

    Examples
    --------
    >>> typeset("1.4 um, volume [um3]")
    '1.4 µm, volume [µm³]'
    """
    return re.sub(r"(?<=[ [])(um[23]?|m[23])\b", lambda unit: unit[0].translate(_TYPESET), text)


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
