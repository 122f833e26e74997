"""The page of a mesh that is not ours: verdict, figures, histograms, worst places, pictures, provenance."""

# SPDX-License-Identifier: GPL-3.0-or-later

import shlex
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.nouns.arrays import Floats
from pipeline.nouns.quality import Metric
from pipeline.progress import Progress, silent
from pipeline.quality.kinds import kinds_in_words
from pipeline.report.page import words
from pipeline.report.page.content import MeshContent
from pipeline.report.page.html import page_of
from pipeline.report.page.provenance import settings_rows, versions
from pipeline.report.page.quality_section import quality_section, unit_of
from pipeline.report.page.words import NOTE, Check, Step
from pipeline.report.views.drawing import colors_by_number
from pipeline.report.views.mesh_scenes import MeshSubject, axis_of_sections
from pipeline.report.views.painter import possible
from pipeline.report.views.render import Painting, Pictures
from pipeline.report.views.subject import places_of_trouble
from pipeline.writing import write_whole


def write_mesh_page(content: MeshContent, path: Path, progress: Progress = silent) -> None:
    """Write the page of a mesh: as self-contained as a run's, with the same sections where both have them.

    Parameters
    ----------
    content : MeshContent
    path : Path
        The page; its folder is made if it is not there. Where nothing can be rendered it has no pictures and says why.
    progress : Progress
    """
    subject = subject_of_mesh(content)
    # the pictures are drawn by a process of their own, the charts meanwhile by this one
    with Painting(subject, possible(subject)) as painting:
        made = mesh_sections(content, progress)
        progress("page: pictures", 0.5)
        pictures = painting.finished()
    page = filled_mesh_page(content, made, pictures)
    write_whole(path, page)


def subject_of_mesh(content: MeshContent) -> MeshSubject:
    """Give what there is to draw of a mesh."""
    return MeshSubject(content.mesh, _focus(content), places_of_trouble(content.quality))


def mesh_sections(content: MeshContent, progress: Progress = silent) -> dict[str, Any]:
    """Make the sections of the page."""
    progress("page: histograms", 0.1)
    mesh, quality = content.mesh, content.quality
    metric = _worst_metric(content)
    colors = colors_by_number(np.arange(len(mesh.patches)))
    return {
        "mesh": {
            "facts": _facts(content),
            "axis": "xyz"[axis_of_sections(mesh)],
            "focus": f"the worst {metric.name.replace('_', ' ')}",
            "patches": [
                (patch.name, f"{patch.count:,}", "#" + bytes(color.tolist()).hex())
                for patch, color in zip(mesh.patches, colors, strict=True)
            ],
        },
        "quality": quality_section(quality, mesh, "worst-places"),
        "provenance": {
            "versions": versions(),
            "files": [{"path": file.path, "size": f"{file.size:,}", "digest": file.digest} for file in content.files],
            "limits_of": content.limits_of,
            "limits": list(settings_rows(content.limits)),
        },
    }


def filled_mesh_page(content: MeshContent, made: dict[str, Any], pictures: Pictures) -> str:
    """Fill the template with what `mesh_sections` made."""
    return page_of(
        "mesh.html.jinja",
        words.verdict(content.quality),
        _tiles(content),
        _checks(content),
        _steps(content),
        pictures,
        name=str(content.path),
        **made,
    )


def _size(content: MeshContent) -> str:
    unit = unit_of(content.mesh)
    extents = np.ptp(content.mesh.points, axis=0) * unit.per_meter
    return " × ".join(f"{extent:.4g}" for extent in extents.tolist()) + f" {unit.name}"


def _tiles(content: MeshContent) -> list[tuple[str, str]]:
    angle = content.quality.metrics.get("non_orthogonality")
    return [
        ("size", _size(content)),
        ("cells", f"{content.mesh.cells:,}"),
        ("patches", f"{len(content.mesh.patches):,}"),
        *([("non-orthogonality", f"{angle.max:.1f}° max, {angle.mean:.1f}° mean")] if angle else []),
    ]


def _facts(content: MeshContent) -> list[tuple[str, str]]:
    mesh, unit = content.mesh, unit_of(content.mesh)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    return [
        ("cells", kinds_in_words(mesh)),
        ("points", f"{len(mesh.points):,}"),
        ("faces", f"{mesh.faces:,}, of which {mesh.internal:,} between two cells"),
        *(
            (f"from {axis}", f"{unit.text(a)} to {unit.text(b)} {unit.name}")
            for axis, a, b in zip("xyz", low.tolist(), high.tolist(), strict=True)
        ),
        ("volume", f"{content.quality.volume:.5g} m³"),
    ]


def _checks(content: MeshContent) -> list[Check]:
    found = [words.cells(content.quality)]
    found.append(
        Check(
            NOTE,
            "whose definitions these are",
            "Metrics are those of OpenFOAM's checkMesh, and agree with what it prints; another solver may measure "
            f"otherwise. {content.limits_of}.",
        )
    )
    found.append(
        Check(
            NOTE,
            "in which unit this is",
            f"Coordinates are taken as meters, so that the mesh measures {_size(content)}. "
            "In another unit only areas and volumes differ.",
        )
    )
    if len(content.mesh.patches) < 2:
        found.append(
            Check(
                NOTE,
                "the boundary is one piece",
                "The file names no more than one patch; a solver needs an inlet and an outlet by name.",
            )
        )
    return found


def _steps(content: MeshContent) -> list[Step]:
    path = shlex.quote(str(content.path))
    return [
        Step(
            "Hold it against limits of your own: those of a case file's [quality].",
            f"fibertwin quality {path} --limits CASE",
        ),
        Step("Turn the mesh in a browser.", f"fibertwin quality {path} --html model.html"),
        Step("Give every figure to a program.", f"fibertwin quality {path} --json"),
    ]


def _worst_metric(content: MeshContent) -> Metric:
    """Give the metric to look at: the first that breaks its limit, else the non-orthogonality."""
    metrics = content.quality.metrics
    broken = next((metric for metric in metrics.values() if metric.over_limit), None)
    return broken or metrics.get("non_orthogonality") or next(iter(metrics.values()))


def _focus(content: MeshContent) -> Floats:
    return np.array(_worst_metric(content).worst[0][2])
