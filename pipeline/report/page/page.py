"""report.html: one page that holds everything it shows, made from whatever of a run is there."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path
from typing import Any

import numpy as np

from pipeline.nouns.arrays import Floats
from pipeline.nouns.quality import QualityReport
from pipeline.progress import Progress, silent
from pipeline.report.page import words
from pipeline.report.page.content import ReportContent
from pipeline.report.page.html import page_of
from pipeline.report.page.sections import sections, tiles
from pipeline.report.views.painter import possible
from pipeline.report.views.render import Painting, Pictures
from pipeline.report.views.scenes import Subject

PAGE = "report.html"


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
    return Subject(content.mat, content.surface, content.domain, content.mesh, places_of_trouble(content.quality))


def places_of_trouble(report: QualityReport | None) -> Floats | None:
    """Where the worst cells and faces beyond a limit are, (n, 3) array [m]; None where there are none."""
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
    """Fill the template with the content of a run.

    Parameters
    ----------
    content : ReportContent
    made : dict
        What `pipeline.report.page.sections.sections` made of it.
    pictures : Pictures
    """
    return page_of(
        "report.html.jinja",
        words.verdict(content.quality),
        tiles(content),
        words.checks(content),
        words.steps(content),
        pictures,
        name=content.name,
        **made,
    )
