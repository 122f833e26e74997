"""report.html: one page that holds everything it shows, made from whatever of a run is there."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

from pipeline.analytics.tables.rows import length
from pipeline.line import store
from pipeline.line.results import Results
from pipeline.nouns.capture import Capture
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mat_measures import MatMeasures
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.section import Section
from pipeline.nouns.surface import Surface
from pipeline.progress import Progress, silent
from pipeline.report.page import words
from pipeline.report.page.as_json import page_json
from pipeline.report.page.headline import headline
from pipeline.report.page.html import page_of
from pipeline.report.page.provenance import provenance
from pipeline.report.stage import PAGE, PAGE_JSON
from pipeline.report.views.painter import possible
from pipeline.report.views.render import Painting, Pictures
from pipeline.report.views.subject import subject_of

_MODELS = ("comparison", "prediction")


def write_report(content: Results, folder: Path, progress: Progress = silent) -> Path:
    """Write ``report.html``: every section for which the run has the results, none for what it has not.

    Beside it stands ``page.json``, all that the page shows for a program to read.

    Parameters
    ----------
    content : Results
    folder : Path
        Where the page goes; made if it is not there.
    progress : Progress

    Returns
    -------
    Path
        The page. It asks nothing of the network. Where nothing can be rendered it has no pictures and says why.
    """
    made, pictures = _made(content, progress)
    page = filled(content, made, pictures)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / PAGE
    path.write_text(page, encoding="utf-8")
    store.write_json(folder / PAGE_JSON, page_json(content, made, tiles(content)))
    return path


def _made(content: Results, progress: Progress) -> tuple[tuple[Section, ...], Pictures]:
    subject = subject_of(content)
    if subject is None:
        return sections(content, progress), Pictures()
    # the pictures are drawn by a process of their own, the charts meanwhile by this one
    with Painting(subject, possible(subject)) as painting:
        made = sections(content, progress)
        progress("report: pictures", 0.6)
        return made, painting.finished()


def sections(content: Results, progress: Progress = silent) -> tuple[Section, ...]:
    """Make the section of each stage that has one and for which the run has the results; the models' come last."""
    shown = [stage for stage in content.line if stage.section is not None]
    made = []
    for number, stage in enumerate(shown):
        progress(f"report: section of {stage.name}", 0.1 + 0.5 * number / len(shown))
        assert stage.section is not None
        made.append(stage.section(content))
    found = [section for section in made if section is not None]
    return tuple(sorted(found, key=lambda section: section.anchor in _MODELS))


def filled(content: Results, made: tuple[Section, ...], pictures: Pictures) -> str:
    """Fill the template with the content of a run.

    Parameters
    ----------
    content : Results
    made : tuple of Section
    pictures : Pictures
    """
    return page_of(
        "report.html.jinja",
        words.whole_verdict(content),
        tiles(content),
        words.checks(content),
        words.steps(content),
        pictures,
        name=content.name,
        number=headline(content),
        sections=made,
        provenance=provenance(content),
    )


def tiles(content: Results) -> list[tuple[str, str]]:
    """Give the figures that stand above everything else, as (what, value)."""
    mat, surface, mesh = content.get(Mat), content.get(Surface), content.get(FaceMesh)
    measures, comparison, capture = content.get(MatMeasures), content.get(Comparison), content.get(Capture)
    found = []
    if mat is not None:
        x, y, z = (1e6 * size for size in mat.slab.size)
        found += [("mat", f"{x:.4g} × {y:.4g} × {z:.3g} µm"), ("fibers", f"{mat.fibers:,}")]
    if comparison is not None:
        found.append(("solidity of the mesh", f"{comparison.solidity['mesh']:.2%}"))
    elif surface is not None:
        found.append(("solidity of the surface", f"{surface.solidity:.2%}"))
    elif measures is not None:
        found.append(("nominal solidity", f"{measures.solidity:.2%}"))
    if mesh is not None:
        found.append(("cells", f"{mesh.cells:,}"))
    if capture is not None:
        worst = capture.most_penetrating["cfd"]
        found.append(
            (
                f"penetration at {length(worst.diameter)}",
                f"{worst.penetration:.3g}" if worst.penetration < 1e-3 else f"{worst.penetration:.1%}",
            )
        )
        if capture.en_1822 is not None:
            found.append(("class, EN 1822", capture.en_1822))
    if comparison is not None and "davies" in comparison.models:
        found.append(("pressure drop, Davies", words.finite(comparison.models["davies"].mesh, "Pa")))
    return found
