"""All that the page of a run shows, as JSON: its words, its tables, and the numbers behind them in SI units."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

from pipeline.line.results import Results
from pipeline.nouns.capture import Capture
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.flow import Solution
from pipeline.nouns.mat_measures import MatMeasures
from pipeline.nouns.mesh_measures import MeshingCost, TetmeshMeasures
from pipeline.nouns.quality import QualityReport
from pipeline.nouns.section import Charts, Columns, Part, Picture, Pictures, Section
from pipeline.report.page import words
from pipeline.report.page.converged import read_convergence
from pipeline.report.page.headline import headline
from pipeline.report.page.provenance import provenance

_RESULTS: dict[str, type] = {
    "mat": MatMeasures,
    "mesh": TetmeshMeasures,
    "meshing": MeshingCost,
    "quality": QualityReport,
    "comparison": Comparison,
    "solution": Solution,
    "capture": Capture,
}


def page_json(content: Results, made: Sequence[Section], tiles: Sequence[tuple[str, str]]) -> dict[str, Any]:
    """Give what the page shows; drawings are left out, their numbers stand under ``results``.

    Parameters
    ----------
    content : Results
    made : sequence of Section
    tiles : sequence of (what, value)

    Returns
    -------
    dict
        Fit for JSON: what is not finite is None.
    """
    found, (mark, verdict) = headline(content), words.whole_verdict(content)
    nouns: dict[str, object] = {name: content.get(kind) for name, kind in _RESULTS.items()}
    nouns["convergence"] = read_convergence(content.folder)
    results: dict[str, Any] = {name: noun for name, noun in nouns.items() if noun is not None}
    page = {
        "name": content.name,
        "verdict": {"mark": mark, "words": verdict},
        "headline": dataclasses.asdict(found) if found is not None else None,
        "figures": dict(tiles),
        "checks": [dataclasses.asdict(check) for check in words.checks(content)],
        "next": [dataclasses.asdict(step) for step in words.steps(content)],
        "sections": [_section(section) for section in made],
        "results": {name: dataclasses.asdict(noun) for name, noun in results.items()},
        "provenance": provenance(content),
    }
    cleaned: dict[str, Any] = _finite(page)
    return cleaned


def _section(section: Section) -> dict[str, Any]:
    return {
        "anchor": section.anchor,
        "title": section.title,
        "parts": [shown for part in section.parts for shown in _shown(part)],
    }


def _shown(part: Part) -> list[dict[str, Any]]:
    if isinstance(part, Columns):
        return [shown for column in part.columns for each in column for shown in _shown(each)]
    if isinstance(part, Charts):
        return [{"kind": "charts", "caption": part.caption, "count": len(part.drawings)}] if part.drawings else []
    if isinstance(part, Pictures):
        return [shown for view in part.views for shown in _shown(view)]
    kind = "picture" if isinstance(part, Picture) else type(part).__name__.lower()
    return [{"kind": kind, **dataclasses.asdict(part)}]


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
