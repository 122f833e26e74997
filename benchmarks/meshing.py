"""What docs/meshing.md shows of the default case, in one set of runs: ``python -m benchmarks.meshing RUNS``.

Every engine, edge and way of contact, each program in a process of its own: the mesh, then the flow on it. Writes
docs/data/meshing.csv, the tables of docs/meshing.md and the plot of error against time; a call that was interrupted
goes on, and ``python -m benchmarks.meshing`` without RUNS writes tables and plot of the data that are there.
`plain` is `pytetwild.tetrahedralize` given nothing but the surface, as a user of that library would start.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pipeline.analytics.tables.plots import save_figure
from pipeline.geometry.faces import tet_faces
from pipeline.line.run import Run
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.flow import Solution
from pipeline.nouns.mesh import FaceMesh, Patch
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.nouns.quality import QualityReport
from pipeline.quality.judge import judge
from validation.programs import spent
from validation.records import read_records, write_records
from validation.tables import SOLVERS, filled, table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOT = Path(__file__).parents[1]
DATA = ROOT / "docs" / "data" / "meshing.csv"
PAGE = ROOT / "docs" / "meshing.md"
PICTURE = ROOT / "docs" / "gallery" / "meshing_cost.svg"


@dataclass(frozen=True, slots=True)
class Job:
    """A mesh of the default case and the solvers that it is given to.

    Parameters
    ----------
    name : str
    engine : str
    edge : float [-]
        In fiber diameters.
    changes : tuple of str
        Other keys of the case, as ``--set`` takes them.
    solvers : tuple of str
    """

    name: str
    engine: str
    edge: float
    changes: tuple[str, ...] = ()
    solvers: tuple[str, ...] = ("stokes",)


_TRUER = ("surface.sides=20", "surface.ring_spacing=0.4")
REFERENCE = Job("reference", "tetwild", 0.35, _TRUER)
"""Stands for the limit of fine meshes."""
USUAL = 0.6
CONTACTS = {
    "paper": (),
    "clear": ("mat.contact=clear",),
    "clear, spacing 0.1 d": ("mat.contact=clear", "mat.spacing=0.14 um"),
    "clear, spacing 0.25 d": ("mat.contact=clear", "mat.spacing=0.35 um"),
}
JOBS = (
    Job("plain", "plain", USUAL, (), ()),
    Job("edge", "tetwild", 1.0),
    Job("edge", "tetwild", 0.8),
    Job("edge", "tetwild", 0.6, (), ("stokes", "openfoam")),
    Job("edge", "tetwild", 0.45, ("surface.sides=16", "surface.ring_spacing=0.4"), ("stokes", "openfoam")),
    REFERENCE,
    Job("edge", "lattice", 1.0, ("tetmesh.volume_error=0.05",)),
    Job("edge", "lattice", 0.8, (), ("stokes", "openfoam")),
    Job("edge", "lattice", 0.6, (), ("stokes", "openfoam")),
    Job("edge", "lattice", 0.45),
    Job("edge", "snappy", 0.8, (), ("openfoam",)),
    Job("edge", "snappy", 0.6, (), ("openfoam",)),
    Job("edge", "snappy", 0.4, (), ("openfoam",)),
    *(Job(name, "tetwild", USUAL, changes) for name, changes in CONTACTS.items() if changes),
)


@dataclass(frozen=True, slots=True)
class Row:
    """What became of a job with one solver.

    Parameters
    ----------
    job, engine : str
    edge : float [-]
    solver : str
    cells : int
    mesh_seconds, mesh_memory : float [s], [GiB]
        Processor time and peak memory of the program that meshes, its start included.
    mean_deviation, typical_deviation : float [-]
        How far walls stand off the true fibers on average, and 99 % of them, in diameters.
    angle, mean_angle : float [deg]
        Non-orthogonality, at most and on average.
    skewness : float [-]
        At most.
    nominal, solidity : float [-]
        Of the mat and of the mesh.
    volume_error : float [-]
        Of the fibers, mesh against surface.
    verdict : str
    drop : float [Pa]
        Pressure drop, with slip.
    flow_seconds, flow_memory : float [s], [GiB]
        Of the program that solves, with what it writes for OpenFOAM.
    """

    job: str
    engine: str
    edge: float
    solver: str
    cells: int
    mesh_seconds: float
    mesh_memory: float
    mean_deviation: float
    typical_deviation: float
    angle: float
    mean_angle: float
    skewness: float
    nominal: float
    solidity: float
    volume_error: float
    verdict: str
    drop: float
    flow_seconds: float
    flow_memory: float


def plain(place: Path) -> None:
    """Mesh the air of a run as a user of the library would, at size one, since it loses triangles at micrometers."""
    import pytetwild

    domain = Run.opened(place).read(FluidDomain)
    unit = domain.mean_diameter
    points, tets = pytetwild.tetrahedralize(domain.points / unit, domain.triangles.astype(np.int32), vtk_ordering=True)
    found = tet_faces(np.asarray(tets, np.int64))
    internal, faces = len(found.neighbour), len(found.triangles)
    mesh = FaceMesh(
        np.asarray(points) * unit, found.triangles.ravel(), np.arange(0, 3 * faces + 1, 3), found.owner,
        found.neighbour, len(tets), (Patch("boundary", internal, faces - internal),),
    )  # fmt: skip
    quality = judge(mesh)
    angle, fibers = quality.metrics["non_orthogonality"], domain.box.volume - domain.volume
    row = Row(
        "plain", "plain", USUAL, "none", mesh.cells, math.nan, math.nan, math.nan, math.nan, angle.max, angle.mean,
        quality.metrics["skewness"].max, math.nan, math.nan, (domain.volume - mesh.volume) / fibers, quality.verdict,
        math.nan, math.nan, math.nan,
    )  # fmt: skip
    write_records(place / "plain.csv", [row])


def measured(job: Job, runs: Path) -> list[Row]:
    """Do a job from nothing; what stands in its folder is made again."""
    place = runs / f"{job.name}_{job.engine}_{job.edge:g}".replace(" ", "_").replace(",", "")
    shutil.rmtree(place, ignore_errors=True)
    if job.engine == "plain":
        _fibertwin(place, [], "enclosure")
        seconds, memory = _cost("benchmarks.meshing", "--plain", str(place))
        return [replace(read_records(place / "plain.csv", Row)[0], mesh_seconds=seconds, mesh_memory=memory)]
    keys = [f"tetmesh.engine={job.engine}", f"tetmesh.edge={job.edge:g}", *job.changes]
    _fibertwin(place, keys, "enclosure")
    mesh_seconds, mesh_memory = _fibertwin(place, keys, "tetmesh")
    _fibertwin(place, keys, "quality")
    rows = []
    for solver in job.solvers:
        # files and comparison included, as in any run
        seconds, memory = _fibertwin(place, [*keys, f"solve.engine={solver}"], "solve")
        run = Run.opened(place)
        measures, quality = run.read(TetmeshMeasures), run.read(QualityReport)
        solution, comparison = run.read(Solution), run.read(Comparison)
        angle = quality.metrics["non_orthogonality"]
        assert measures.fidelity is not None
        rows.append(
            Row(
                job.name, job.engine, job.edge, solver, measures.cells, mesh_seconds, mesh_memory,
                measures.fidelity.mean_deviation, measures.fidelity.typical_deviation, angle.max, angle.mean,
                quality.metrics["skewness"].max, comparison.solidity["nominal"], comparison.solidity["mesh"],
                measures.volume_error, quality.verdict, solution.pressure_drop, seconds, memory,
            )
        )  # fmt: skip
    return rows


def _fibertwin(place: Path, keys: Sequence[str], until: str) -> tuple[float, float]:
    changes = [part for key in keys for part in ("--set", key)]
    return _cost("pipeline.cli", "run", "default", "--quiet", "--out", str(place), "--until", until, *changes)


def _cost(*arguments: str) -> tuple[float, float]:
    """Processor seconds and peak memory [GiB] of a program."""
    cost = spent(*arguments)
    return cost.seconds, cost.memory / 2**30


def limit(rows: Sequence[Row]) -> float:
    """Pressure drop [Pa] of the reference."""
    return next(row.drop for row in rows if row.job == REFERENCE.name)


def edge_table(rows: Sequence[Row]) -> str:
    """Show what each engine, edge and solver gives and takes."""
    exact = limit(rows)
    lines = []
    for row in rows:
        if row.job not in ("edge", REFERENCE.name):
            continue
        other = "" if row.job != REFERENCE.name else " (reference)"
        lines.append(
            [
                row.engine + other,
                SOLVERS[row.solver],
                f"{row.edge:g}",
                f"{row.cells:,}",
                f"{row.mean_deviation:.3f} / {row.typical_deviation:.3f}",
                f"{row.mesh_seconds:.1f} s, {row.mesh_memory:.2f} GiB",
                f"{row.flow_seconds:.1f} s, {row.flow_memory:.2f} GiB",
                f"{row.drop:.3f} Pa",
                f"{100.0 * (row.drop / exact - 1.0):+.1f} %",
            ]
        )
    head = ["engine", "solver", "edge", "cells", "walls off, mean / 99 % [d]", "mesh", "flow", "pressure drop", "error"]
    return table(head, lines)


def quality_table(rows: Sequence[Row]) -> str:
    """Show the shapes of the cells that each engine leaves at the usual edge."""
    usual = {row.engine: row for row in rows if row.job in ("edge", "plain") and row.edge == USUAL}
    lines = [
        [
            row.engine,
            f"{row.cells:,}",
            f"{row.mesh_seconds:.1f} s, {row.mesh_memory:.2f} GiB",
            f"{row.angle:.1f} / {row.mean_angle:.1f}",
            f"{row.skewness:.2f}",
            f"{100.0 * row.volume_error:+.2f} %",
            row.verdict,
        ]
        for row in usual.values()
    ]
    return table(["engine", "cells", "mesh", "angle max / mean [deg]", "skewness", "fibers' volume", "verdict"], lines)


def contact_table(rows: Sequence[Row]) -> str:
    """Show what the gap between fibers changes, on the default engine and edge."""
    at_usual = [row for row in rows if (row.engine, row.edge, row.solver) == ("tetwild", USUAL, "stokes")]
    touching = next(row for row in at_usual if row.job == "edge")
    lines = [
        [
            name,
            f"{row.nominal:.2%} / {row.solidity:.2%}",
            f"{row.cells:,}",
            f"{row.mesh_seconds:.1f} s",
            f"{row.typical_deviation:.3f} d",
            f"{row.drop:.3f} Pa",
            f"{row.drop / touching.drop - 1.0:+.1%}",
        ]
        for name in CONTACTS
        for row in at_usual
        if row.job == ("edge" if name == "paper" else name)
    ]
    head = ["contact", "solidity nominal / mesh", "cells", "mesh", "99 % of the walls within", "pressure drop", ""]
    return table(head, lines)


def cost_figure(rows: Sequence[Row]) -> "Figure":
    """Plot error against processor time, and the runs that nothing else beats in both."""
    from matplotlib.figure import Figure

    exact = limit(rows)
    points = {
        row: (row.mesh_seconds + row.flow_seconds, 100.0 * abs(row.drop / exact - 1.0))
        for row in rows
        if row.job == "edge"
    }
    figure = Figure(figsize=(7.0, 4.4), layout="constrained")
    axes = figure.subplots()
    for (engine, solver), mark in zip(
        dict.fromkeys((row.engine, row.solver) for row in points), ("o-", "o--", "s-", "s--", "^--"), strict=True
    ):
        own = sorted((row for row in points if (row.engine, row.solver) == (engine, solver)), key=lambda row: -row.edge)
        color = {"tetwild": "#0072b2", "lattice": "#d55e00", "snappy": "#009e73"}[engine]
        axes.loglog(*zip(*(points[row] for row in own), strict=True), mark, color=color, markersize=4,
                    label=f"{engine}, {SOLVERS[solver]}")  # fmt: skip
        for row in own:
            axes.annotate(f" {row.edge:g}", points[row], fontsize=7)
    best = [at for at in sorted(points.values()) if not any(o[0] <= at[0] and o[1] < at[1] for o in points.values())]
    axes.step(*zip(*best, strict=True), where="post", color="#777777", linewidth=0.8, label="beaten by none")
    axes.axhline(1.0, color="#000000", linewidth=0.8)
    axes.set_xlabel("processor time of mesh and flow [s]")
    axes.set_ylabel("error of the pressure drop, absolute [%]")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize="small")
    return figure


def main(runs: Path | None) -> None:
    """Measure what is not there yet, and write page and plot."""
    if runs is not None:
        runs.mkdir(parents=True, exist_ok=True)
        kept = runs / "meshing.csv"
        rows = read_records(kept, Row) if kept.is_file() else []
        for job in JOBS:
            if not any((row.job, row.engine, row.edge) == (job.name, job.engine, job.edge) for row in rows):
                rows += measured(job, runs)
                write_records(kept, rows)
                print(f"{job.name}: {job.engine} at {job.edge:g}", flush=True)
        write_records(DATA, rows)
    rows = read_records(DATA, Row)
    page = PAGE.read_text(encoding="utf-8")
    for name, content in (
        ("engines and edges", edge_table(rows)),
        ("cells", quality_table(rows)),
        ("contact", contact_table(rows)),
    ):
        page = filled(page, name, content)
    PAGE.write_text(page, encoding="utf-8")
    save_figure(cost_figure(rows), PICTURE)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--plain"]:
        plain(Path(sys.argv[2]))
    else:
        main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
