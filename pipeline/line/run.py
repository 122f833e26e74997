"""The line: one noun in, one noun out per stage, each result kept on disk and reused while it holds."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT, knudsen, slip_length
from pipeline.analytics.models.comparison import compare
from pipeline.analytics.models.growth import Predictor, predictor
from pipeline.analytics.models.pressure_models import pressure_model
from pipeline.case import Case
from pipeline.enclosure.duct import enclose
from pipeline.errors import StageError
from pipeline.export.formats.openfoam.dictionaries import SOLVER
from pipeline.export.formats.openfoam.slip import FiberSlip, fiber_radius
from pipeline.export.write import export
from pipeline.geometry.tets import volume_between
from pipeline.line import store
from pipeline.machine import peak_memory
from pipeline.mat.exchange import write_fibers
from pipeline.mat.generate import generate
from pipeline.mat.measures import MatMeasures, measure
from pipeline.mat.settings import ArraySettings, BoxSettings, FileSettings, LayeredSettings
from pipeline.mat.tally import report_stop
from pipeline.mesh.fill import engine_missing, fill
from pipeline.mesh.improve.finish import TetmeshMeasures
from pipeline.nouns.comparison import Comparison
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.quality import QualityReport
from pipeline.nouns.surface import Surface
from pipeline.openfoam.environment import openfoam_missing
from pipeline.progress import Progress, silent
from pipeline.quality.judge import cell_fields, judge
from pipeline.report.page.content import ReportContent
from pipeline.report.page.page import PAGE, write_report
from pipeline.solve.running import Bed, solve
from pipeline.surface.files import write_surface
from pipeline.surface.measures import measure_surface
from pipeline.surface.union import unite

SOLVING = ".solving"
"""Folder of a run that holds a solver's run until it has settled."""

CASE = "case.json"
"""File of a run's folder that holds its case, every setting in SI."""

Counts = dict[str, object]


@dataclass(frozen=True, slots=True)
class Stage:
    """One step of the line: what it needs, what else its result depends on, and how it is made.

    A stage that is needed but not there, as the report of a partial run may find, takes no part in the result.
    `make` writes into a folder of its own and gives the counts for the manifest. `obstacle` names what keeps the
    stage from running on this machine; a stage that is `asked` for runs only then.
    """

    name: str
    needs: tuple[str, ...]
    settings: tuple[str, ...]
    rooms: tuple[str, ...]
    libraries: tuple[str, ...]
    make: Callable[["Run", Path, Progress], Counts]
    obstacle: Callable[["Run"], str | None] = lambda run: None
    asked: bool = False


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a stage: made, reused, or skipped; the counts then hold the reason."""

    stage: str
    folder: Path
    how: str
    seconds: float
    counts: Counts


@dataclass(frozen=True, slots=True)
class Run:
    """A case and the folder that holds its finished stages; what a stage made is read from there."""

    case: Case
    folder: Path

    @classmethod
    def opened(cls, folder: Path) -> "Run":
        """Open the folder of an earlier run.

        Raises
        ------
        StageError
            If the folder is not one.
        """
        if not (folder / CASE).is_file():
            raise StageError(f"{folder} is no run: it has no {CASE}; make one with fibertwin run CASE --out {folder}")
        return cls(store.load_json(Case, folder / CASE), folder)

    @property
    def mat(self) -> Mat:
        """The fiber mat."""
        return store.load(Mat, self.folder / "mat" / "mat.npz")

    @property
    def surface(self) -> Surface:
        """The fibers' surface."""
        return store.load(Surface, self.folder / "surface" / "surface.npz")

    @property
    def domain(self) -> FluidDomain:
        """The air's surface."""
        return store.load(FluidDomain, self.folder / "enclosure" / "domain.npz")

    @property
    def mesh_file(self) -> Path:
        """Where the air in cells is kept."""
        return self.folder / "tetmesh" / "mesh.npz"

    @property
    def mesh(self) -> FaceMesh:
        """The air in cells."""
        return store.load(FaceMesh, self.mesh_file)

    @property
    def quality(self) -> QualityReport:
        """What the mesh is like."""
        return store.load_json(QualityReport, self.folder / "quality" / "quality.json")

    @property
    def comparison(self) -> Comparison:
        """The pressure drops side by side."""
        return store.load_json(Comparison, self.folder / "compare" / "comparison.json")

    @property
    def solution(self) -> Solution:
        """What the solver found."""
        return store.load_json(Solution, self.folder / "solve" / "solution.json")

    @property
    def mat_measures(self) -> MatMeasures:
        """The mat in numbers."""
        return store.load_json(MatMeasures, self.folder / "mat" / "measures.json")

    @property
    def mesh_measures(self) -> TetmeshMeasures:
        """What the mesher made of the fibers."""
        return store.load_json(TetmeshMeasures, self.folder / "tetmesh" / "measures.json")

    def manifest(self, stage: str) -> dict[str, Any] | None:
        """Tell what made a finished stage; None where it is not there."""
        path = self.folder / stage / store.MANIFEST
        return dict(store.read_json(path)) if path.exists() else None


def _make_mat(run: Run, into: Path, tell: Progress) -> Counts:
    settings, predict = run.case.mat, mat_predictor(run.case)
    mat = generate(settings, predict, tell)
    measures = measure(mat)
    store.save(mat, into / "mat.npz")
    store.write_json(into / "measures.json", measures)
    write_fibers(mat, into / "fibers.csv")
    counts: Counts = {"fibers": mat.fibers, "segments": mat.segments}
    if isinstance(settings, LayeredSettings | BoxSettings):
        stop = report_stop(settings.stop, measures, predict)
        store.write_json(into / "stop.json", stop)
        counts[stop.quantity] = stop.reached
    return counts


def mat_predictor(case: Case) -> Predictor | None:
    """Make what a mat that grows toward a predicted quantity asks after each fiber."""
    # arrays and fibers from a file grow toward nothing
    return predictor(case.mat.stop, case.flow) if isinstance(case.mat, LayeredSettings | BoxSettings) else None


def _make_surface(run: Run, into: Path, tell: Progress) -> Counts:
    surface = unite(run.mat, run.case.surface, tell)
    store.save(surface, into / "surface.npz")
    store.write_json(into / "measures.json", measure_surface(run.mat, surface, run.case.surface, tell))
    write_surface(surface, into)
    return {"triangles": len(surface.triangles), "solidity": surface.solidity}


def _make_enclosure(run: Run, into: Path, tell: Progress) -> Counts:
    domain = enclose(run.surface, run.case.enclosure, tell)
    store.save(domain, into / "domain.npz")
    return {"triangles": len(domain.triangles), "fluid_volume": domain.volume}


def _make_tetmesh(run: Run, into: Path, tell: Progress) -> Counts:
    mesh, measures = fill(run.domain, run.case.tetmesh, tell, into)
    store.save(mesh, into / "mesh.npz")
    store.write_json(into / "measures.json", measures)
    return {"cells": measures.cells, "volume_error": measures.volume_error}


def _make_quality(run: Run, into: Path, tell: Progress) -> Counts:
    report = judge(run.mesh, run.case.quality, tell)
    store.write_json(into / "quality.json", report)
    return {"verdict": report.verdict, "max_non_orthogonality": report.metrics["non_orthogonality"].max}


def _make_export(run: Run, into: Path, tell: Progress) -> Counts:
    mesh, case = run.mesh, run.case
    fields = cell_fields(mesh) if "vtk" in case.export.formats else {}
    flow = case.flow.flow()
    slip = None
    if case.export.fiber_wall == "slip":
        slip = FiberSlip(SLIP_COEFFICIENT * flow.mean_free_path, fiber_radius(mesh, run.domain))
    written = export(mesh, into, case.export, flow, case.enclosure.sides, tell, fields, slip)
    return {"formats": list(written)}


def _make_compare(run: Run, into: Path, tell: Progress) -> Counts:
    mat = run.mat
    air = volume_between(*run.mesh.boundary(), mat.slab.lower[2], mat.slab.upper[2])
    comparison = compare(mat, run.surface.solidity, 1.0 - air / mat.slab.volume, run.case.flow.flow())
    store.write_json(into / "comparison.json", comparison)
    return {"mesh_solidity": comparison.solidity["mesh"]}


def _make_solve(run: Run, into: Path, tell: Progress) -> Counts:
    mat, flow, comparison = run.mat, run.case.flow.flow(), run.comparison
    model = pressure_model(run.case.flow.pressure_model)
    kn = knudsen(flow.mean_free_path, comparison.fiber_diameter)
    # beside the stage and not in it: a killed run continues from there
    work = run.folder / SOLVING
    bed = Bed(
        face_area=mat.slab.face_area,
        thickness=mat.thickness,
        pressure_factor=float(model.coefficient(comparison.solidity["mesh"], slip_length(kn))),
        fiber_length=_parallel_length(run, comparison),
    )
    solution = solve(run.folder / "export" / "openfoam", work, flow, bed, run.case.solve, tell)
    store.write_json(into / "solution.json", solution)
    store.write_json(into / "comparison.json", {**asdict(comparison), "cfd": solution.pressure_drop})
    work.rename(into / "openfoam")
    return {
        "pressure_drop": solution.pressure_drop,
        "iterations": solution.iterations,
        "converged": solution.converged,
        "force_balance_error": solution.force_balance_error,
    }


def _parallel_length(run: Run, comparison: Comparison) -> float | None:
    # fibers on a symmetry plane count by half, as they do in the solidity
    mat = run.mat
    if not isinstance(run.case.mat, ArraySettings):
        return None
    return comparison.solidity["nominal"] * mat.slab.volume / (math.pi * float(mat.radius[0]) ** 2)


def _no_solver(run: Run) -> str | None:
    if "openfoam" not in run.case.export.formats:
        return "export.formats lacks openfoam, the solver's format"
    return openfoam_missing(run.case.solve.cores, SOLVER[run.case.export.dialect])


def _make_report(run: Run, into: Path, tell: Progress) -> Counts:
    return {"page": write_report(content_of(run), into, tell).name}


def content_of(run: Run) -> ReportContent:
    """Collect what a run has for its page, and leave out what stands there from another case."""
    holds: dict[str, bool] = {}
    for stage in LINE:
        if stage.make is not _make_report and run.manifest(stage.name) is not None:
            holds[stage.name] = all(holds.get(need, False) for need in stage.needs) and _of_this_case(stage, run)
    has = {name for name, fine in holds.items() if fine}
    return ReportContent(
        folder=run.folder,
        case=run.case,
        mat=run.mat if "mat" in has else None,
        mat_measures=run.mat_measures if "mat" in has else None,
        surface=run.surface if "surface" in has else None,
        domain=run.domain if "enclosure" in has else None,
        mesh=run.mesh if "tetmesh" in has else None,
        mesh_measures=run.mesh_measures if "tetmesh" in has else None,
        quality=run.quality if "quality" in has else None,
        comparison=run.comparison if "compare" in has else None,
        solution=run.solution if "solve" in has else None,
        manifests={name: run.manifest(name) or {} for name, fine in holds.items() if fine},
        left_out=tuple(name for name, fine in holds.items() if not fine),
    )


def _of_this_case(stage: Stage, run: Run) -> bool:
    # what older code or libraries made is still a result of this case; what other settings or inputs made is not
    made, now = run.manifest(stage.name) or {}, _identity(stage, run)
    return all(made.get(part) == now.get(part) for part in ("file", "parameters", "inputs"))


LINE = (
    Stage("mat", (), ("mat", "flow"), ("mat", "analytics"), ("numpy", "numba"), _make_mat),
    Stage("surface", ("mat",), ("surface",), ("surface",), ("manifold3d", "numpy"), _make_surface),
    Stage("enclosure", ("surface",), ("enclosure",), ("enclosure",), ("manifold3d", "numpy"), _make_enclosure),
    Stage(
        "tetmesh", ("enclosure",), ("tetmesh",), ("tetmesh", "openfoam"), ("pytetwild", "numpy", "numba"), _make_tetmesh
    ),
    Stage("quality", ("tetmesh",), ("quality",), ("quality", "openfoam"), ("numpy",), _make_quality),
    Stage(
        "export",
        ("tetmesh",),
        ("export", "flow", "enclosure"),
        ("export", "openfoam", "quality"),
        ("numpy", "pyvista"),
        _make_export,
    ),
    Stage("compare", ("mat", "surface", "tetmesh"), ("flow",), ("analytics",), ("numpy", "scipy"), _make_compare),
    Stage(
        "solve",
        ("mat", "export", "compare"),
        ("solve", "flow", "mat"),
        ("solve", "openfoam", "analytics"),
        ("foamlib",),
        _make_solve,
        _no_solver,
        asked=True,
    ),
    Stage(
        "report",
        ("mat", "surface", "enclosure", "tetmesh", "quality", "export", "compare", "solve"),
        tuple(Case.model_fields),
        ("report", "analytics", "openfoam", "quality"),
        ("jinja2", "matplotlib", "pyvista"),
        _make_report,
    ),
)
STAGES = tuple(stage.name for stage in LINE)
LAST = [stage.name for stage in LINE if not stage.asked][-1]
"""Where a run ends that nobody asked more of."""


def run(
    case: Case,
    folder: Path,
    until: str = LAST,
    force: frozenset[str] = frozenset(),
    tell: Progress = silent,
    without: frozenset[str] = frozenset(),
) -> list[Outcome]:
    """Run the line for a case, stage by stage, and reuse what still holds.

    Parameters
    ----------
    case : Case
    folder : Path
        Where this run's stages are kept; made if it is not there.
    until : str
        The last stage to run, one of `STAGES`.
    force : frozenset of str
        Stages to make again though they hold.
    tell : Progress
    without : frozenset of str
        Stages to leave out, as a program that runs many cases leaves out the report.

    Returns
    -------
    list of Outcome
        One per stage, in order.

    Raises
    ------
    StageError
        If a stage cannot do what the case asks, or the folder cannot be written; finished stages are kept.
    """
    outcomes = []
    this = Run(case, folder)
    _refuse_missing_engine(this, until)
    with store.locked(folder):
        store.write_json(folder / CASE, case.model_dump(mode="json"))
        for stage in _wanted(until):
            if stage.name not in without:
                outcomes.append(_step(stage, this, stage.name in force, tell))
    return outcomes


def _refuse_missing_engine(run: Run, until: str) -> None:
    # before the mat and its surface are made for nothing; a mesh that is there may still hold
    lacking = engine_missing(run.case.tetmesh)
    if lacking and "tetmesh" in [stage.name for stage in _wanted(until)] and run.manifest("tetmesh") is None:
        raise StageError(lacking)


def report(folder: Path, tell: Progress = silent) -> Path:
    """Write the page of a run as far as the run went.

    Parameters
    ----------
    folder : Path
        Of a run, whole or partial.
    tell : Progress

    Returns
    -------
    Path
        The page.

    Raises
    ------
    StageError
        If the folder is no run or cannot be written.
    """
    this = Run.opened(folder)
    with store.locked(folder):
        return _step(LINE[-1], this, True, tell).folder / PAGE


def _wanted(until: str) -> list[Stage]:
    last = max(STAGES.index(until), STAGES.index(LAST) if LINE[STAGES.index(until)].asked else 0)
    return [stage for stage in LINE[: last + 1] if not stage.asked or stage.name == until]


def _step(stage: Stage, run: Run, again: bool, tell: Progress) -> Outcome:
    folder = run.folder / stage.name
    obstacle = stage.obstacle(run)
    if obstacle is not None:
        return Outcome(stage.name, folder, "skipped", 0.0, {"reason": obstacle})
    identity = _identity(stage, run)
    key = store.digest(identity)
    done = None if again else store.finished(folder, key)
    if done is not None:
        tell(f"{stage.name}: reused", 1.0)
        return Outcome(stage.name, folder, "reused", float(done["seconds"]), done["counts"])
    began = time.perf_counter()
    with store.side_folder(folder) as side:
        counts = stage.make(run, side, tell)
        seconds = time.perf_counter() - began
        cost = {"seconds": seconds, "peak_memory": peak_memory()}
        store.write_manifest(side, {"stage": stage.name, "key": key, **identity, **cost, "counts": counts})
    return Outcome(stage.name, folder, "made", seconds, counts)


def _identity(stage: Stage, run: Run) -> dict[str, Any]:
    """All that a stage's result depends on."""
    settings = run.case.model_dump(mode="json")
    source = run.case.mat.file if stage.name == "mat" and isinstance(run.case.mat, FileSettings) else None
    return {
        **({"file": store.file_digest(source)} if source is not None and source.is_file() else {}),
        "parameters": {name: settings[name] for name in stage.settings},
        "inputs": {name: store.digest(made["files"]) for name in stage.needs if (made := run.manifest(name))},
        "code": store.code_digest(stage.rooms),
        "libraries": store.versions(stage.libraries),
    }
