"""A small run made by hand for pages: its mesh is no mesh of its mat, but pages tell only what they are given."""

# SPDX-License-Identifier: GPL-3.0-or-later

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.analytics.models.comparison import compare
from pipeline.case import Case
from pipeline.enclosure.duct import enclose
from pipeline.enclosure.settings import EnclosureSettings
from pipeline.line.results import Results
from pipeline.line.stages import LINE
from pipeline.mat.generate import generate
from pipeline.mat.measures import measure
from pipeline.mat.settings import Constant, LayeredSettings, Stop
from pipeline.nouns.capture import Capture, DepthProfile, MostPenetratingSize
from pipeline.nouns.flow import Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh import FaceMesh
from pipeline.nouns.mesh_measures import MeshingCost, TetmeshMeasures
from pipeline.nouns.patches import FIBERS
from pipeline.quality.judge import judge
from pipeline.quality.settings import QualitySettings
from pipeline.solve.stokes.nodes import number_nodes
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.union import unite
from tests.sample_meshes import duct

MAT = LayeredSettings(
    side=10e-6, fiber_diameter=Constant(diameter=1.4e-6), relaxation_slope=0.15, seed=3, stop=Stop(count=3)
)
CASE = Case(mat=MAT)
SECTIONS = ("summary", "mat", "duct", "mesh", "quality", "comparison", "prediction", "provenance")
SOLUTION = Solution(12.5, 1e-12, 1e-9, 1e-14, 0.001, 1e-6, 400, True)

_WORST = MostPenetratingSize(2e-7, 1.9e-7, 2.1e-7, 0.5, True)
CAPTURE = Capture(
    particle_diameter=(1e-6, 3e-6), efficiency=(0.6, 0.8), low=(0.2, 0.3), high=(0.9, 0.95), penetration=(0.4, 0.2),
    released=(5, 5), captured=(3, 4), passed=(2, 1), timed_out=(0, 0), sieved=(0, 0), fiber_efficiency=(0.3, 0.5),
    single_fiber=(0.5, 0.7), by_mechanism={}, first_row=None, concentration=(None, None),
    rare_penetration=(None, None), residence_time=(1e-3, 1e-3), figure_of_merit=(0.1, 0.2), pressure_drop=12.5,
    mechanisms=("interception",), density=1000.0, most_penetrating={"cfd": _WORST, "model": _WORST}, en_1822=None,
    iso_29463=None, iso_16890={"ePM1": 0.3, "ePM2.5": 0.4, "ePM10": None}, iso_16890_group=None,
    depth=DepthProfile((0.0, 5e-6, 1e-5), ((1, 2), (3, 1))), seed=1, flow_solver="stokes", stray=0.0,
)  # fmt: skip


def small_mesh() -> FaceMesh:
    """Make a duct with a bar across it, as large as the mat is: three fibers end to end."""
    mesh = duct(size=(10e-6, 10e-6, 20e-6), jitter=0.2).face_mesh()
    along = mesh.polyhedra().centers[mesh.patch(FIBERS), 0]
    return replace(mesh, fiber=(along / 3.4e-6).astype(np.int64))


def still_flow() -> FlowField:
    """Give the air of the small mesh one velocity, and a pressure that falls along the duct."""
    mesh = small_mesh()
    nodes = number_nodes(mesh.tets(), len(mesh.points))
    places = np.concatenate([mesh.points, nodes.middles(mesh.points)])
    velocity = np.tile([0.0, 0.0, 0.025], (len(places), 1))
    pressure = 3.0 * (1.0 - mesh.points[:, 2] / mesh.points[:, 2].max())
    return FlowField(places, nodes.cells, velocity, pressure, np.zeros(len(nodes.cells), bool), 0.0)


def manifest(stage: str) -> dict[str, Any]:
    """What `pipeline.line.store` writes beside a stage."""
    return {
        "stage": stage, "key": "a" * 64, "code": {"a.py": "b" * 64}, "records": {}, "libraries": {"numpy": "2.0"},
        "seconds": 1.5, "peak_memory": 2**28, "counts": {"formats": ["openfoam", "vtk"]},
        "files": {f"{stage}.npz": "c" * 64},
    }  # fmt: skip


@cache
def _parts() -> tuple[object, ...]:
    mat, mesh = generate(MAT), small_mesh()
    surface = unite(mat, SurfaceSettings())
    return (
        mat,
        measure(mat),
        surface,
        enclose(surface, EnclosureSettings()),
        mesh,
        TetmeshMeasures(10, 20, 1e-15, 0.001, -0.01, 0.0, 0),
        MeshingCost(12.0, 2**27),
        # a limit that no mesh keeps: there are worst faces to show
        judge(mesh, QualitySettings(non_orthogonality=5.0)),
        compare(mat, surface.solidity, 0.99 * surface.solidity, CASE.flow.flow()),
    )


def whole(*others: object, folder: Path = Path("runs/small")) -> Results:
    """Give all that a run can have but a solution; `others` replace nouns of their kind, or are added."""
    made = {stage: manifest(stage) for stage in ("mat", "tetmesh", "export")}
    return having(*_parts(), *others, folder=folder, made=made)


def having(*nouns: object, folder: Path = Path("runs/small"), **other: Any) -> Results:
    """Give a run that has just these nouns."""
    return Results(CASE, folder, LINE, loaded={type(noun): noun for noun in nouns}, **other)
