"""The sections of the page: facts, tables and charts from the nouns of a run."""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib.metadata
import math
import platform
from collections.abc import Iterator
from typing import Any

import numpy as np
from pydantic import BaseModel

from pipeline.analytics.models.prediction import filter_of_mat, predict
from pipeline.analytics.settings import FilterSettings
from pipeline.analytics.tables.rows import Table, comparison_tables, length, prediction_tables
from pipeline.mesh.wall_error import Fidelity
from pipeline.nouns.comparison import Comparison
from pipeline.progress import Progress
from pipeline.quality.kinds import kinds_in_words
from pipeline.report.page import charts, words
from pipeline.report.page.content import ReportContent
from pipeline.report.page.quality_section import quality_section


def sections(content: ReportContent, progress: Progress) -> dict[str, Any]:
    """Make every section; None where the run has nothing for it."""
    progress("report: charts", 0.1)
    made: dict[str, Any] = {"mat": _mat(content), "duct": _duct(content), "mesh": _mesh(content), "quality": None}
    progress("report: histograms of the mesh", 0.2)
    if content.quality is not None:
        made["quality"] = quality_section(content.quality, content.mesh)
    progress("report: models", 0.4)
    made["comparison"] = _comparison(content)
    made["prediction"] = _prediction(content)
    made["provenance"] = _provenance(content)
    return made


def tiles(content: ReportContent) -> list[tuple[str, str]]:
    """Give the figures that stand above everything else, as (what, value)."""
    found = []
    if content.mat is not None:
        x, y, z = (1e6 * size for size in content.mat.slab.size)
        found += [("mat", f"{x:.4g} × {y:.4g} × {z:.3g} µm"), ("fibers", f"{content.mat.fibers:,}")]
    comparison = content.comparison
    if comparison is not None:
        found.append(("solidity of the mesh", f"{comparison.solidity['mesh']:.2%}"))
    elif content.surface is not None:
        found.append(("solidity of the surface", f"{content.surface.solidity:.2%}"))
    elif content.mat_measures is not None:
        found.append(("nominal solidity", f"{content.mat_measures.solidity:.2%}"))
    if content.mesh is not None:
        found.append(("cells", f"{content.mesh.cells:,}"))
    if content.solution is not None:
        found.append(("pressure drop, CFD", f"{content.solution.pressure_drop:.3g} Pa"))
    if comparison is not None and "davies" in comparison.models:
        found.append(("pressure drop, Davies", words.finite(comparison.models["davies"].mesh, "Pa")))
    return found


def _mat(content: ReportContent) -> dict[str, Any] | None:
    mat, measures = content.mat, content.mat_measures
    if mat is None:
        return None
    facts = [("made by", mat.origin), ("seed", str(mat.seed) if mat.seed >= 0 else "none: nobody drew these fibers")]
    figures = [charts.diameter_histogram(mat), charts.orientation_histogram(mat)]
    if measures is not None:
        d = measures.diameters
        xx, yy, zz = (measures.orientation[k][k] for k in range(3))
        facts += [
            ("fibers", f"{measures.fibers:,} in {measures.segments:,} straight segments"),
            ("summed length", length(measures.total_length)),
            ("coverage", f"{measures.coverage:.4g}, and {measures.covered_fraction:.1%} of the face lies under fibers"),
            ("thickness", f"{length(measures.thickness)}; mean height of the top {length(measures.robust_thickness)}"),
            ("nominal solidity", f"{measures.solidity:.3%} (what fibers share counts twice)"),
            ("fiber diameter", f"{length(d.mean)} ± {_deviation(d.std)}, from {length(d.min)} to {length(d.max)}"),
            ("mean diameter by surface", length(d.surface_weighted)),
            ("contacts of a fiber", f"{measures.contacts_per_fiber:.3g}"),
            ("orientation tensor, diagonal", f"xx {xx:.3f}, yy {yy:.3f}, zz {zz:.3f}"),
        ]
        figures.append(charts.thickness_profile(measures))
    if content.surface is not None:
        surface = content.surface
        facts.append(("united surface", f"{len(surface.triangles):,} triangles, solidity {surface.solidity:.3%}"))
    return {"facts": facts, "charts": figures}


def _deviation(std: float) -> str:
    return length(std) if std > 0 else "0"


def _duct(content: ReportContent) -> dict[str, Any] | None:
    domain = content.domain
    if domain is None:
        return None
    x, y, z = (1e6 * size for size in domain.box.size)
    before, behind = domain.slab.lower[2] - domain.box.lower[2], domain.box.upper[2] - domain.slab.upper[2]
    facts = [
        ("duct", f"{x:.4g} × {y:.4g} × {z:.4g} µm; air flows along +z"),
        ("plenums", f"{length(before)} before and {length(behind)} behind the mat"),
        ("sides", content.case.enclosure.sides.replace("_", " ")),
        ("air", f"{1e18 * domain.volume:,.0f} µm³"),
        ("face velocity", f"{100 * content.case.flow.face_velocity:.4g} cm/s"),
    ]
    return {"facts": facts}


def _mesh(content: ReportContent) -> dict[str, Any] | None:
    mesh = content.mesh
    if mesh is None:
        return None
    patches = ", ".join(f"{patch.name} {patch.count:,}" for patch in mesh.patches)
    facts = [("cells", kinds_in_words(mesh)), ("points", f"{len(mesh.points):,}"), ("boundary faces", patches)]
    made = content.mesh_measures
    if made is not None:
        facts += [
            (
                "fiber volume against the surface",
                f"{made.volume_error:+z.2%}; before mending {made.raw_volume_error:+z.2%}",
            ),
            ("air given to the fibers in crevices", f"{made.filled_volume:.3%} of the air"),
            *_walls(made.fidelity),
            ("mesher", f"{made.mesher_seconds:.3g} s, at most {made.mesher_peak_memory / 2**20:,.0f} MiB"),
        ]
    return {"facts": facts}


def _walls(found: Fidelity | None) -> list[tuple[str, str]]:
    if found is None:
        return []
    errors = np.array(found.radius_error)
    return [
        (
            "walls off the true fibers",
            f"{found.mean_deviation:.3f} diameters on average, 99 % within {found.typical_deviation:.2f}, "
            f"all within {found.largest_deviation:.2f} (where fibers meet)",
        ),
        (
            "radius of single fibers",
            f"{errors.mean():+z.2%} on average, from {errors.min():+z.2%} to {errors.max():+z.2%}",
        ),
    ]


def _comparison(content: ReportContent) -> dict[str, Any] | None:
    comparison = content.comparison
    if comparison is None:
        return None
    solution = content.solution
    return {
        "chart": charts.models_chart(comparison, solution),
        "tables": comparison_tables(comparison),
        "facts": [
            ("face velocity", f"{100 * comparison.face_velocity:.4g} cm/s"),
            ("thickness", length(comparison.thickness)),
            ("fiber diameter that keeps length and volume", length(comparison.fiber_diameter)),
            ("Knudsen number of the fiber", f"{comparison.knudsen:.3g} ({comparison.regime} flow)"),
            ("Reynolds number of the fiber", f"{comparison.reynolds:.3g}"),
        ],
        "solution": _solution(content, comparison) if solution is not None else None,
    }  # fmt: skip


def _solution(content: ReportContent, comparison: Comparison) -> dict[str, Any]:
    s = content.solution
    assert s is not None
    facts = [
        ("pressure drop", f"{s.pressure_drop:.4g} Pa"),
        ("permeability of the mat", f"{1e12 * s.permeability:.4g} µm²"),
        ("drag on the fibers", f"{s.drag:.4g} N"),
        ("flow rate", f"{s.flow_rate:.4g} m³/s"),
        ("iterations", f"{s.iterations:,}, {'settled' if s.converged else 'not settled'}"),
        ("time", f"{s.seconds:.3g} s on {s.cores} cores"),
    ]
    if s.effective_fiber_diameter is not None:
        facts.append(("fiber diameter with which the chosen model agrees", length(s.effective_fiber_diameter)))
    if s.f_star is not None:
        facts.append(("drag per length over viscosity and velocity, F*", f"{s.f_star:.5g}"))
    against = tuple(
        (row.title or name, words.finite(row.mesh), f"{row.mesh / s.pressure_drop - 1:+.1%}")
        for name, row in comparison.models.items()
        if math.isfinite(row.mesh)
    )
    return {"facts": facts, "table": Table("", ("model", "Pa from the mesh's solidity", "against CFD"), against)}


def _prediction(content: ReportContent) -> dict[str, Any] | None:
    comparison, flow = content.comparison, content.case.flow
    if comparison is not None:
        medium, basis = (
            FilterSettings(
                solidity=comparison.solidity["mesh"],
                thickness=comparison.thickness,
                fiber_diameter=comparison.fiber_diameter,
            ),
            "the solidity of the mesh",
        )
    elif content.mat is not None and content.mat_measures is not None and content.mat_measures.solidity < 1.0:
        medium, basis = filter_of_mat(content.mat, flow.flow()), "the nominal solidity of the mat"
    else:
        return None
    tables = prediction_tables(predict(medium, flow))
    # the comparison has the pressure drops already
    shown = tables if comparison is None else tuple(table for table in tables if table.title != "Pressure drop")
    return {"basis": basis, "charts": charts.prediction_charts(medium, flow), "tables": shown}


def _provenance(content: ReportContent) -> dict[str, Any]:
    stages = [
        {
            "name": name,
            "seconds": f"{manifest['seconds']:.3g}",
            "memory": f"{manifest['peak_memory'] / 2**20:,.0f}" if "peak_memory" in manifest else "",
            "key": str(manifest["key"]),
            "code": str(manifest["code"]),
            "libraries": ", ".join(f"{library} {version}" for library, version in manifest["libraries"].items()),
            "files": manifest["files"],
        }
        for name, manifest in content.manifests.items()
    ]
    return {
        "settings": list(settings_rows(content.case)),
        "stages": stages,
        "versions": versions(),
    }


def versions() -> str:
    """Say which program on what machine made a page."""
    return (
        f"fibertwin {importlib.metadata.version('fibertwin')}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}"
    )


def settings_rows(settings: BaseModel, path: str = "") -> Iterator[tuple[str, str, str]]:
    """Give every setting: its path in the case file, its value in SI, and what it is."""
    for name, about in type(settings).model_fields.items():
        value = getattr(settings, name)
        if isinstance(value, BaseModel):
            yield from settings_rows(value, f"{path}{name}.")
        elif value is not None:
            text = ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)
            yield f"{path}{name}", text, about.description or ""
