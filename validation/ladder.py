"""Arrays of fibers through the whole line, on meshes of three resolutions, against their exact drag."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from pipeline.analytics.formulas.slip import SLIP_COEFFICIENT
from pipeline.case import Case
from pipeline.errors import CaseError
from pipeline.line.run import Run, run
from pipeline.mat.settings import ArraySettings
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Solution
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.progress import Progress, silent
from pipeline.solve.settings import SolveSettings
from validation.exact import hexagonal_drag, square_drag
from validation.rows import drags_of_fibers, row_drags

SOLIDITIES = (0.01, 0.05, 0.1, 0.2, 0.3)
SLIPS = (0.0, 0.1, 1.0)
"""Slip length over fiber radius."""
FACTORS = (1.5, 1.0, 1 / 1.5)
"""Mesh spacing of each rung over that of the case file, coarse to fine."""


@dataclass(frozen=True, slots=True)
class Climb:
    """Arrays that one mesher and one solver are tried on, each on three meshes.

    Parameters
    ----------
    arrangement : str
    solidities : tuple of float [-]
    slips : tuple of float [-]
        Slip length over fiber radius.
    mesher, engine : str
        As ``tetmesh.engine`` and ``solve.engine`` name them.
    """

    arrangement: str
    solidities: tuple[float, ...]
    slips: tuple[float, ...]
    mesher: str
    engine: str


CLIMBS = (
    Climb("square", SOLIDITIES, SLIPS, "tetwild", "stokes"),
    Climb("hexagonal", SOLIDITIES, SLIPS, "tetwild", "stokes"),
    Climb("square", (0.05, 0.1, 0.3), (0.0, 0.1), "lattice", "stokes"),
    Climb("square", (0.1,), (0.0, 0.1), "tetwild", "openfoam"),
    Climb("square", (0.1,), (0.0,), "lattice", "openfoam"),
)

_WIDE_GAP = 1.2  # diameters between neighboring fibers, from which on the fibers set the scale of the flow
_EXACT = {"square": square_drag, "hexagonal": hexagonal_drag}


@dataclass(frozen=True, slots=True)
class Rung:
    """One array on one mesh: its drag per length of fiber over viscosity times face velocity, F*, and its checks.

    Parameters
    ----------
    arrangement : str
    solidity : float [-]
    slip : float [-]
        Slip length over fiber radius.
    mesher, engine : str
    edge : float [-]
        Edge length at the fibers in fiber diameters, as asked for.
    cells : int
    spacing : float [-]
        (Air volume / cells)^(1/3) in fiber diameters.
    f_star : float [-]
        Of the middle row.
    first_row, last_row : float [-]
        F* of the outer rows, which lack a neighbour.
    exact : float [-]
        F* of the endless array.
    error : float [-]
        F* of the middle row over the exact one, less 1.
    force_balance, mass_balance : float [-]
    iterations : int
    converged : bool
    processor_seconds : float [s]
        Of the whole line, its child processes included; of what was not yet there.
    """

    arrangement: str
    solidity: float
    slip: float
    mesher: str
    engine: str
    edge: float
    cells: int
    spacing: float
    f_star: float
    first_row: float
    last_row: float
    exact: float
    error: float
    force_balance: float
    mass_balance: float
    iterations: int
    converged: bool
    processor_seconds: float


def rung_case(
    case: Case, solidity: float, factor: float, slip: float = 0.0, mesher: str = "tetwild", engine: str = "stokes"
) -> Case:
    """Give a case another solidity, and scale its mesh as a whole: edges, growth, envelope, polygons, rings, depth.

    The lengths are the case's times the factor, and less where the gaps between the fibers are narrower than 1.2
    diameters: then in the gaps' proportion. The plenums become one pitch long. Slip comes from the mean free path, as
    it does in any case.

    Raises
    ------
    CaseError
        If the case is no array of an odd number of rows, three or more.
    """
    mat = case.mat
    if not isinstance(mat, ArraySettings) or mat.rows < 3 or mat.rows % 2 == 0:
        raise CaseError("the ladder needs an array with a middle row: mat.generator = array, rows = 3, 5, ...")
    depth = mat.depth or mat.pitch
    mat = ArraySettings.model_validate({**mat.model_dump(), "solidity": solidity})
    gap = mat.pitch / mat.fiber_diameter - 1.0
    factor *= min(1.0, gap / _WIDE_GAP)
    # the flow is the same at every depth; a slab that stays as deep as its cells are large keeps the meshes alike
    mat = mat.model_copy(update={"depth": depth * factor})
    changes: dict[str, object] = {
        "mat": mat,
        # a multiple of four, so that the polygon of a fiber on a symmetry plane is cut in two halves
        "surface": case.surface.model_copy(
            update={
                "sides": 4 * round(case.surface.sides / factor / 4),
                "ring_spacing": case.surface.ring_spacing * factor,
            }
        ),
        "enclosure": case.enclosure.model_copy(update={"inlet": mat.pitch, "outlet": mat.pitch}),
        "tetmesh": (case.tetmesh if case.tetmesh.engine == mesher else case.tetmesh.changed(engine=mesher)).scaled(
            factor
        ),
        "export": case.export.model_copy(update={"formats": ("openfoam",) if engine == "openfoam" else ()}),
    }
    if engine != case.solve.engine:
        changes["solve"] = SolveSettings.model_validate({"engine": engine})
    if slip:
        path = slip * 0.5 * mat.fiber_diameter / SLIP_COEFFICIENT
        changes["flow"] = case.flow.model_copy(update={"mean_free_path": path, "fiber_wall": "slip"})
    else:
        changes["flow"] = case.flow.model_copy(update={"fiber_wall": "no_slip"})
    return case.model_copy(update=changes)


def climb(case: Case, folder: Path, progress: Progress = silent) -> Rung:
    """Run a case that `rung_case` made, and read its drag.

    Raises
    ------
    StageError
        If a stage fails.
    """
    mat, flow = case.mat, case.flow.flow()
    assert isinstance(mat, ArraySettings)
    began = os.times()
    run(case, folder, "solve", progress=progress, without=frozenset({"report"}))
    took = os.times()
    this = Run(case, folder)
    solution, measures = this.read(Solution), this.read(TetmeshMeasures)
    length = this.read(Mat).slab.size[1]
    if solution.engine == "openfoam":
        drags = row_drags(folder / "solve" / "openfoam", mat.rows, flow)
    else:
        drags = drags_of_fibers(this.read(Mat), solution.drag_per_fiber, mat.rows)
    stars = [drag / (length * flow.viscosity * flow.face_velocity) for drag in drags]
    slip = SLIP_COEFFICIENT * flow.mean_free_path / (0.5 * mat.fiber_diameter)
    slip = slip if case.flow.fiber_wall == "slip" else 0.0
    exact = _EXACT[mat.arrangement](mat.solidity, slip)
    return Rung(
        arrangement=mat.arrangement,
        solidity=mat.solidity,
        slip=round(slip, 12),
        mesher=case.tetmesh.engine,
        engine=solution.engine,
        edge=case.tetmesh.edge,
        cells=measures.cells,
        spacing=(measures.fluid_volume / measures.cells) ** (1 / 3) / mat.fiber_diameter,
        f_star=stars[mat.rows // 2],
        first_row=stars[0],
        last_row=stars[-1],
        exact=exact,
        error=stars[mat.rows // 2] / exact - 1.0,
        force_balance=solution.force_balance_error,
        mass_balance=solution.mass_balance_error,
        iterations=solution.iterations,
        converged=solution.converged,
        processor_seconds=sum(took[:4]) - sum(began[:4]),
    )


def ladder(case: Case, folder: Path, climbed: Climb, progress: Progress = silent) -> Iterator[Callable[[], Rung]]:
    """Give three rungs to climb at each solidity and slip, coarse to fine.

    With slip, and with the other solver, the mesh of the rung without slip is used again: the wall is all that differs.
    """
    for solidity in climbed.solidities:
        for slip in climbed.slips:
            for level, factor in enumerate(FACTORS):
                mesh = folder / f"{climbed.arrangement}_{solidity:g}_{climbed.mesher}_{level}"
                this = rung_case(case, solidity, factor, slip, climbed.mesher, climbed.engine)
                yield partial(_climb_beside, this, mesh, f"{slip:g}_{climbed.engine}", progress)


def _climb_beside(case: Case, mesh: Path, wall: str, progress: Progress) -> Rung:
    first, place = mesh.with_name(f"{mesh.name}_0_stokes"), mesh.with_name(f"{mesh.name}_{wall}")
    if first.is_dir() and not place.exists():
        shutil.copytree(first, place)
    return climb(case, place, progress)
