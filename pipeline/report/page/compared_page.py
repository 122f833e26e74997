"""Two or more runs side by side on one page: what they were given, what came out, and how they look."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from pipeline.analytics.tables.rows import length
from pipeline.errors import CaseError
from pipeline.line.results import Results
from pipeline.nouns.capture import Capture
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.mat_measures import MatMeasures
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import QualityReport
from pipeline.nouns.section import Table
from pipeline.progress import Progress, silent
from pipeline.report.page import words
from pipeline.report.page.headline import Headline, headline
from pipeline.report.page.html import page_of
from pipeline.report.page.provenance import settings_rows, versions
from pipeline.report.page.svg import BLUE, GREEN, INK, ORANGE, RED, chart
from pipeline.report.views.painter import possible
from pipeline.report.views.render import Painting, Pictures
from pipeline.report.views.subject import subject_of
from pipeline.writing import write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLORS = (BLUE, ORANGE, GREEN, RED, "#8a6bbe", INK)
MOST = len(_COLORS)
"""Runs that one page takes."""
_SIDE_BY_SIDE = {
    "duct": "The twin.",
    "cut": "The middle plane through all cells, air to the right.",
    "flow-slice": "Speed and pressure on a plane along the flow, air from below.",
}
"""Views of each run, and their captions."""
_ABSENT = "–"
_Figure = tuple[str, Callable[[Results], float | None], Callable[[float], str]]


def write_comparison(runs: Sequence[Results], path: Path, progress: Progress = silent) -> None:
    """Write the page of several runs.

    Parameters
    ----------
    runs : sequence of Results
        Two to `MOST`; the others are compared with the first.
    path : Path
        The file; its folder is made if it is not there.
    progress : Progress

    Raises
    ------
    CaseError
        If there are too few or too many runs.
    """
    if not 2 <= len(runs) <= MOST:
        raise CaseError(f"{len(runs)} runs cannot stand side by side on a page; name 2 to {MOST}")
    page = comparison_html(runs, _pictures(runs, progress))
    write_whole(path, page)


def comparison_html(runs: Sequence[Results], pictures: Pictures) -> str:
    """Fill the template; a picture of run k has the name ``k-VIEW``."""
    names = names_of(runs)
    return page_of(
        "compared.html.jinja",
        _verdict(runs),
        [],
        [],
        [],
        pictures,
        name=" · ".join(names),
        runs=[
            {"name": name, "number": headline(run), "verdict": words.whole_verdict(run), "color": color}
            for name, run, color in zip(names, runs, _COLORS, strict=False)
        ],
        inputs=differing_inputs(runs),
        figures=figures(runs),
        drawings=[drawing for drawing in (_drops(runs), _profiles(runs), _efficiencies(runs)) if drawing is not None],
        views=_SIDE_BY_SIDE,
        provenance={"versions": versions()},
    )


def comparison_json(runs: Sequence[Results]) -> dict[str, Any]:
    """Give what the page of several runs shows, fit for JSON."""
    inputs, found = differing_inputs(runs), figures(runs)
    return {
        "runs": names_of(runs),
        "inputs": {key: list(values) for key, *values in inputs.rows},
        "figures": {key: list(values) for key, *values in found.rows},
        "numbers": {what: [get(run) for run in runs] for what, get, _ in _FIGURES},
    }


def names_of(runs: Sequence[Results]) -> list[str]:
    """Name each run by its folder, and by more of its path where two folders have one name."""
    names = [run.name for run in runs]
    return names if len(set(names)) == len(names) else [str(run.folder) for run in runs]


def differing_inputs(runs: Sequence[Results]) -> Table:
    """Give the settings in which the runs differ, a column per run, in SI units."""
    settings = [{path: value for path, value, _ in settings_rows(run.case)} for run in runs]
    keys = list(dict.fromkeys(key for each in settings for key in each))
    rows = [(key, *(each.get(key, _ABSENT) for each in settings)) for key in keys]
    return Table("", ("setting", *names_of(runs)), tuple(row for row in rows if len(set(row[1:])) > 1))


def figures(runs: Sequence[Results]) -> Table:
    """Give the numbers that came out, a column per run, with the change against the first."""
    rows = []
    for what, get, shown in _FIGURES:
        values = [get(run) for run in runs]
        if any(value is not None for value in values):
            rows.append((what, *(_against(value, values[0], shown, k > 0) for k, value in enumerate(values))))
    return Table("", ("", *names_of(runs)), tuple(rows))


def _against(value: float | None, first: float | None, shown: Callable[[float], str], compared: bool) -> str:
    if value is None:
        return _ABSENT
    change = f" ({value / first - 1.0:+z.1%})" if compared and first else ""
    return shown(value) + change


def _of(noun: type, get: Callable[[Any], float | None]) -> Callable[[Results], float | None]:
    def found(run: Results) -> float | None:
        there = run.get(noun)
        return None if there is None else get(there)

    return found


def _pascal(value: float) -> str:
    return f"{value:.4g} Pa"


def _share(value: float) -> str:
    return f"{value:.2%}"


def _count(value: float) -> str:
    return f"{value:,.0f}"


_FIGURES: tuple[_Figure, ...] = (
    ("fibers", _of(Mat, lambda mat: float(mat.fibers)), _count),
    ("thickness", _of(MatMeasures, lambda mat: mat.thickness), length),
    ("coverage", _of(MatMeasures, lambda mat: mat.coverage), lambda value: f"{value:.3g}"),
    ("nominal solidity", _of(MatMeasures, lambda mat: mat.solidity), _share),
    ("solidity of the mesh", _of(Comparison, lambda c: c.solidity["mesh"]), _share),
    ("cells", _of(FaceMesh, lambda mesh: float(mesh.cells)), _count),
    (
        "largest non-orthogonality",
        _of(QualityReport, lambda q: q.metrics["non_orthogonality"].max if "non_orthogonality" in q.metrics else None),
        lambda value: f"{value:.1f}°",
    ),
    ("pressure drop, CFD", _of(Solution, lambda s: s.pressure_drop), _pascal),
    ("pressure drop without slip", _of(Solution, lambda s: s.pressure_drop_no_slip), _pascal),
    ("permeability", _of(Solution, lambda s: s.permeability), lambda value: f"{1e12 * value:.4g} µm²"),
    (
        "pressure drop, Davies",
        _of(Comparison, lambda c: c.models["davies"].mesh if "davies" in c.models else None),
        _pascal,
    ),
    ("most penetrating size", _of(Capture, lambda c: c.most_penetrating["cfd"].diameter), length),
    ("penetration there", _of(Capture, lambda c: c.most_penetrating["cfd"].penetration), lambda value: f"{value:.3g}"),
)


def _verdict(runs: Sequence[Results]) -> tuple[str, str]:
    marks = [words.whole_verdict(run)[0] for run in runs]
    worst = next(mark for mark in (words.BAD, words.NOTE, words.GOOD) if mark in marks)
    return worst, f"{len(runs)} runs side by side, changes against the first"


def _pictures(runs: Sequence[Results], progress: Progress) -> Pictures:
    files: dict[str, bytes] = {}
    trouble = ""
    for k, (run, name) in enumerate(zip(runs, names_of(runs), strict=True)):
        progress(f"report: pictures of {name}", k / len(runs))
        subject = subject_of(run)
        if subject is None:
            continue
        there = possible(subject)
        with Painting(subject, [view for view in _SIDE_BY_SIDE if view in there]) as painting:
            found = painting.finished()
        trouble = trouble or found.trouble
        files |= {f"{k}-{view}": data for view, data in found.files.items()}
    return Pictures(files, trouble)


def _drops(runs: Sequence[Results]) -> Markup | None:
    """Pressure drops with their intervals, one beside the other."""
    found: list[Headline | None] = [headline(run) for run in runs]
    if not any(found):
        return None

    def draw(axes: "Axes") -> None:
        for k, (number, color) in enumerate(zip(found, _COLORS, strict=False)):
            if number is None:
                continue
            axes.bar(k, number.value, color=color, width=0.6)
            if number.low is not None and number.high is not None:
                ends = [[max(number.value - number.low, 0.0)], [max(number.high - number.value, 0.0)]]
                axes.errorbar(k, number.value, ends, color=INK, capsize=4, linewidth=1)
        axes.set(xticks=range(len(runs)), ylabel="pressure drop [Pa]", title="Pressure drop")
        axes.set_xticklabels(_short(names_of(runs)))

    return chart("compared-drops", draw)


def _profiles(runs: Sequence[Results]) -> Markup | None:
    """Solidity through the thickness of each."""
    found = [run.get(MatMeasures) for run in runs]
    if not any(found):
        return None

    def draw(axes: "Axes") -> None:
        for measures, color, name in zip(found, _COLORS, _short(names_of(runs)), strict=False):
            if measures is not None:
                z = 1e6 * np.array(measures.profile.z)
                axes.plot(100.0 * np.array(measures.profile.solidity), z, color=color, linewidth=1.5, label=name)
        axes.set(xlabel="solidity [%]", ylabel="height z, along the flow [µm]", title="Through the thickness")
        axes.set_xlim(left=0)
        axes.legend(frameon=False)

    return chart("compared-profiles", draw)


def _efficiencies(runs: Sequence[Results]) -> Markup | None:
    """Efficiency over particle size of each, with its 95 % intervals."""
    found = [run.get(Capture) for run in runs]
    if not any(found):
        return None

    def draw(axes: "Axes") -> None:
        from matplotlib.ticker import FuncFormatter, NullFormatter

        for capture, color, name in zip(found, _COLORS, _short(names_of(runs)), strict=False):
            if capture is None:
                continue
            efficiency = 100.0 * np.array(capture.efficiency)
            bars = np.abs(100.0 * np.array([capture.low, capture.high]) - efficiency)
            sizes = 1e6 * np.array(capture.particle_diameter)
            axes.errorbar(sizes, efficiency, bars, fmt="o-", color=color, markersize=4, capsize=2, label=name)
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set(xlabel="particle diameter [µm]", ylabel="efficiency [%]", ylim=(0, 103), title="Efficiency")
        axes.legend(frameon=False)

    return chart("compared-efficiencies", draw)


def _short(names: Sequence[str]) -> list[str]:
    # matplotlib would take dollar signs for formulas
    return [name.replace("$", r"\$") if len(name) <= 18 else f"…{name[-17:]}".replace("$", r"\$") for name in names]
