"""All metrics of a mesh, held against their limits."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from pipeline.geometry.parts import parts
from pipeline.geometry.polyhedra import Polyhedra
from pipeline.geometry.threads import in_parts
from pipeline.machine import cores
from pipeline.nouns.arrays import Bools, Floats
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import CellFields, Metric, QualityReport
from pipeline.openfoam import metrics as definitions
from pipeline.progress import Progress, silent
from pipeline.quality.settings import QualitySettings

WORST = 5
"""How many of the worst cells or faces a report names."""
_LARGE = 100_000  # cells from which threads pay
_FIELDS = ("volume", *QualitySettings.model_fields)
_BLOCK = 1_000_000  # values whose cosines are held at a time
USELESS_ANGLE = 90.0
"""Non-orthogonality [degree] from which a face passes flux backwards; `checkMesh` fails there."""


@dataclass(frozen=True, slots=True)
class _Definition:
    # mild: a breach costs accuracy, but plain `checkMesh` says "Mesh OK" and solvers run

    compute: Callable[[FaceMesh, Polyhedra], Floats]
    where: str
    worst_is: str
    unit: str = "1"
    fixed_limit: float | None = None
    source: str = "OpenFOAM checkMesh"
    mild: bool = False


_DEFINITIONS = {
    "non_orthogonality": _Definition(definitions.non_orthogonality, "internal faces", "largest", "degree", mild=True),
    "skewness": _Definition(definitions.skewness, "faces", "largest"),
    "aspect_ratio": _Definition(definitions.aspect_ratio, "cells", "largest"),
    "determinant": _Definition(
        definitions.determinant, "cells", "smallest", source="OpenFOAM checkMesh -allGeometry", mild=True
    ),
    "face_weight": _Definition(
        definitions.face_weight, "internal faces", "smallest", source="OpenFOAM checkMesh -allGeometry", mild=True
    ),
    "volume_ratio": _Definition(
        definitions.volume_ratio, "internal faces", "smallest", source="OpenFOAM checkMesh -allGeometry", mild=True
    ),
    "volume": _Definition(definitions.volume, "cells", "smallest", "m3", 0.0),
    "face_area": _Definition(definitions.face_area, "faces", "smallest", "m2", 0.0),
    "face_pyramid": _Definition(
        definitions.face_pyramid, "faces", "smallest", "1", 0.0, "OpenFOAM's face pyramids, relative to the cell"
    ),
    "openness": _Definition(definitions.openness, "cells", "largest", "1", 1e-6),
    "concavity": _Definition(
        definitions.concavity, "cells", "largest", "1", -1e-6, "OpenFOAM checkMesh -allGeometry", mild=True
    ),
    "face_tets": _Definition(
        definitions.face_tets, "faces", "smallest", "1", 0.0, "OpenFOAM checkMesh -allGeometry", mild=True
    ),
}  # fmt: skip


def judge(
    mesh: FaceMesh, settings: QualitySettings | None = None, progress: Progress = silent, own: Bools | None = None
) -> QualityReport:
    """Measure a mesh by OpenFOAM's definitions and say whether it may go to a solver.

    Parameters
    ----------
    mesh : FaceMesh
    settings : QualitySettings
        The limits; those of `checkMesh` by default.
    progress : Progress
    own : (cells,) bool array, optional
        Cells to look at, with all their faces, where others stand beside them that are looked at elsewhere; all unless
        given.

    Returns
    -------
    QualityReport
        A metric that the mesh has nothing to measure with (one cell has no internal face) is left out.
    """
    return _judged(mesh, mesh.polyhedra(), settings or QualitySettings(), progress, own, {})


def judge_with_fields(
    mesh: FaceMesh, settings: QualitySettings | None = None, progress: Progress = silent, own: Bools | None = None
) -> tuple[QualityReport, CellFields]:
    """Judge a mesh, and give the values that the report sums up cell by cell: each metric is computed once.

    Parameters
    ----------
    mesh, settings, progress, own
        As `judge` takes them.

    Returns
    -------
    QualityReport
    CellFields
        One value per cell of each metric that has a limit to choose; a metric of faces gives the worst of its faces.
    """
    settings = settings or QualitySettings()
    shape = mesh.polyhedra()
    values = np.empty((len(_FIELDS), mesh.cells))
    report = _judged(mesh, shape, settings, progress, own, dict(zip(_FIELDS, values, strict=True)))
    values.flags.writeable = False  # what is read-only is not copied where it is kept
    return report, CellFields(_FIELDS, values)


def _judged(
    mesh: FaceMesh,
    shape: Polyhedra,
    settings: QualitySettings,
    progress: Progress,
    own: Bools | None,
    fields: Mapping[str, Floats],
) -> QualityReport:
    """Judge a mesh and fill in the fields that are asked for; no more than two metrics are held at a time."""
    found: dict[str, Metric] = {}
    reasons, notes = _topology(mesh)
    warnings: list[str] = []

    def measured(name: str) -> Metric | None:
        definition = _DEFINITIONS[name]
        values = definition.compute(mesh, shape)
        if name in fields:
            _fill(fields[name], shape, definition, values)
        limit = getattr(settings, name, definition.fixed_limit)
        chosen = _chosen(mesh, definition.where, own)
        return _summary(name, definition, values, limit, shape, chosen) if len(values) else None

    for done, (name, metric) in enumerate(zip(_DEFINITIONS, _by_all_cores(measured, mesh), strict=True)):
        progress(f"quality: {name}", done / len(_DEFINITIONS))
        if metric is None:
            continue
        found[name] = metric
        definition = _DEFINITIONS[name]
        if metric.over_limit:
            useless = name == "non_orthogonality" and metric.max >= USELESS_ANGLE
            (warnings if definition.mild and not useless else reasons).append(_sentence(metric))
    verdict = "fail" if reasons else "warn" if warnings else "pass"
    return QualityReport(
        cells=mesh.cells,
        points=len(mesh.points),
        faces=mesh.faces,
        internal_faces=mesh.internal,
        patches={patch.name: patch.count for patch in mesh.patches},
        volume=float(shape.volumes.sum()),
        metrics=found,
        verdict=verdict,
        reasons=(*reasons, *warnings),
        notes=tuple(notes),
    )


def _by_all_cores(measured: Callable[[str], Metric | None], mesh: FaceMesh) -> Iterator[Metric | None]:
    """Measure by every definition, in their order: some at a time where a mesh is large, since loops let go."""
    threads = cores() if mesh.cells >= _LARGE else 1
    if threads == 1:
        yield from map(measured, _DEFINITIONS)
        return
    # no more than two, for memory's sake: each holds a number for every face
    with ThreadPoolExecutor(max_workers=min(2, threads)) as pool:
        yield from pool.map(measured, _DEFINITIONS)


def measure(mesh: FaceMesh) -> Iterator[tuple[str, Floats]]:
    """Give every value of every metric, for histograms, one metric at a time: its name and the values.

    Yields
    ------
    str, (faces,), (internal,) or (cells,) array
    """
    shape = mesh.polyhedra()
    for name, definition in _DEFINITIONS.items():
        yield name, definition.compute(mesh, shape)


def cell_fields(mesh: FaceMesh) -> dict[str, Floats]:
    """Give one value per cell of each metric that has a limit to choose, for coloring cells.

    A metric of faces gives a cell the worst of its faces.

    Returns
    -------
    dict of (cells,) arrays
    """
    shape = mesh.polyhedra()
    fields = {name: np.empty(mesh.cells) for name in _FIELDS}
    for name, field in fields.items():
        _fill(field, shape, _DEFINITIONS[name], _DEFINITIONS[name].compute(mesh, shape))
    return fields


def _fill(field: Floats, shape: Polyhedra, definition: _Definition, values: Floats) -> None:
    """Give each cell its value, or the worst of its faces."""
    if definition.where == "cells":
        field[:] = values
        return
    from pipeline.quality.loops import worst_of_faces

    largest = definition.worst_is == "largest"
    in_parts(
        lambda begin, end: worst_of_faces(shape.first, shape.faces, values, largest, field, begin, end), len(field)
    )


def _chosen(mesh: FaceMesh, where: str, own: Bools | None) -> Bools | None:
    """Tell the cells or faces that count."""
    if own is None or where == "cells":
        return own
    of_own = own[mesh.owner]
    of_own[: mesh.internal] |= own[mesh.neighbour]
    return of_own[: mesh.internal] if where == "internal faces" else of_own


def _summary(
    name: str,
    definition: _Definition,
    values: Floats,
    limit: float | None,
    shape: Polyhedra,
    chosen: Bools | None,
) -> Metric:
    from pipeline.quality.loops import worst_rows

    rows = None if chosen is None else np.flatnonzero(chosen)
    if rows is not None:
        values = values[rows]
    largest = definition.worst_is == "largest"
    if limit is None:
        over = 0
    elif largest:
        over = int(np.count_nonzero(values > limit))
    else:
        # nothing below 0 is right, whatever the limit
        over = int(np.count_nonzero((values < limit) | (values <= 0)))
    ranks = worst_rows(values, min(WORST, len(values)), largest)
    numbers = ranks if rows is None else rows[ranks]
    places = shape.cell_centers if definition.where == "cells" else shape.centers
    worst = tuple(
        (int(number), float(values[rank]), _place(places[number])) for number, rank in zip(numbers, ranks, strict=True)
    )
    mean = float(values.mean())
    if name == "non_orthogonality":
        mean = math.degrees(math.acos(_mean_cosine(values)))
    return Metric(
        name=name,
        unit=definition.unit,
        where=definition.where,
        min=float(values.min()),
        mean=mean,
        max=float(values.max()),
        # last, since it leaves the values in another order: a sorted copy of each is what a mesh has no room for
        p99=float(np.percentile(values, 99, overwrite_input=True)),
        limit=limit,
        worst_is=definition.worst_is,
        over_limit=over,
        worst=worst,
        source=definition.source,
    )


def _mean_cosine(angles: Floats) -> float:
    """Mean cosine of angles [degree]."""
    blocks = (angles[start : start + _BLOCK] for start in range(0, len(angles), _BLOCK))
    # a mean of ones may be a bit more by rounding
    return min(1.0, sum(float(np.cos(np.radians(block)).sum()) for block in blocks) / len(angles))


def _place(point: Floats) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z


def _sentence(metric: Metric) -> str:
    side, worst = ("above", metric.max) if metric.worst_is == "largest" else ("below", metric.min)
    if metric.limit == 0:
        side = "not above"
    unit = "" if metric.unit == "1" else f" {metric.unit}"
    where = metric.where if metric.over_limit > 1 else metric.where.removesuffix("s")
    x, y, z = metric.worst[0][2]
    return (
        f"{metric.name.replace('_', ' ')}: {metric.over_limit:,} {where} {side} {metric.limit:g}{unit}, "
        f"worst {worst:.4g} at ({x:.4g}, {y:.4g}, {z:.4g}) m"
    )


def _topology(mesh: FaceMesh) -> tuple[list[str], list[str]]:
    """Tell what no metric sees: points without faces; and what `checkMesh` notes and lets pass."""
    count, part = parts(mesh.owner[: mesh.internal], mesh.neighbour, mesh.cells)
    troubles, notes = [], []
    if count > 1:
        smallest = int(np.bincount(part).min())
        notes.append(f"{count} parts of the mesh share no face, the smallest has {smallest} cells")
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.corners] = True
    unused = int((~used).sum())
    if unused:
        troubles.append(f"{unused} points belong to no face")
    empty = [patch.name for patch in mesh.patches if not patch.count]
    if empty:
        notes.append(f"no face in patch {', '.join(empty)}")
    return troubles, notes
