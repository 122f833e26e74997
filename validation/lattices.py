"""Three-dimensional lattices of fibers through the whole line, against permeabilities that no open table has."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from pipeline.case import Case, validate
from pipeline.line.run import Run, run
from pipeline.nouns.flow import Solution
from pipeline.nouns.flow_field import FlowField
from pipeline.nouns.mesh_measures import TetmeshMeasures
from pipeline.progress import Progress, silent
from pipeline.solve.stokes.elements import rule, shape

EXACT = {
    "crossed": {0.02: 19.17, 0.1: 1.83853, 0.3: 0.21566},
    "cubic": {0.02: 25.390, 0.05: 6.8441, 0.2: 0.57481},
}
"""k/a^2 by solidity, by curved elements of fourth order until the digits stood, in a program of its own: crossed layers
(an x-fiber at z = 0, a y-fiber at z = L/2, flow along z), and three orthogonal fibers that meet in one point."""
CLIMBS = (
    *(("crossed", "tetwild", solidity) for solidity in EXACT["crossed"]),
    *(("cubic", "tetwild", solidity) for solidity in EXACT["cubic"]),
    ("crossed", "lattice", 0.1),
    ("cubic", "lattice", 0.2),
)
"""Which lattices are climbed on the meshes of which mesher."""
EDGES = (0.4, 0.27, 0.18)
"""Edge at the fibers of each rung in fiber diameters, coarse to fine, where the gaps are wide."""
_DIAMETER = 1e-6
_CELLS = 3  # along the flow; the inner one counts, whose layers differ from those of five cells by 5e-5
_WIDE_GAP = 1.2  # diameters between fibers from which on the fibers set the scale of the flow


@dataclass(frozen=True, slots=True)
class LatticeRung:
    """One lattice on one mesh.

    Parameters
    ----------
    lattice : str
    solidity : float [-]
    mesher : str
    edge : float [-]
        At the fibers in fiber diameters.
    cells : int
    spacing : float [-]
        (Air volume / cells)^(1/3) in fiber diameters.
    permeability : float [-]
        k/a^2 of the inner cell.
    exact : float [-]
    error : float [-]
        Of the resistance: exact permeability over this one, less 1.
    force_balance, mass_balance : float [-]
    iterations : int
    processor_seconds : float [s]
        Of the whole line, its child processes included; of what was not yet there.
    """

    lattice: str
    solidity: float
    mesher: str
    edge: float
    cells: int
    spacing: float
    permeability: float
    exact: float
    error: float
    force_balance: float
    mass_balance: float
    iterations: int
    processor_seconds: float


def pitch(lattice: str, solidity: float) -> float:
    r"""Period L over the fiber's radius.

    Crossed layers: :math:`\varphi = 2\pi (a/L)^2`; cubic: :math:`\varphi = 3\pi (a/L)^2 - 8\sqrt2\,(a/L)^3`.

    Examples
    --------
    >>> round(pitch("crossed", 0.1), 4), round(pitch("cubic", 0.2), 4)
    (7.9267, 6.1595)
    """
    if lattice == "crossed":
        return math.sqrt(2.0 * math.pi / solidity)
    low, high = 2.1, 100.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        share = 3.0 * math.pi / middle**2 - 8.0 * math.sqrt(2.0) / middle**3
        low, high = (middle, high) if share > solidity else (low, middle)
    return 0.5 * (low + high)


def fibers(lattice: str, solidity: float) -> str:
    """Give a quarter of a lattice as a file of fibers, three cells along the flow.

    Every fiber across the flow lies in a plane of symmetry of the duct, half of it in the air; those along it stand in
    the corner of two.
    """
    a = 0.5e6 * _DIAMETER
    side = pitch(lattice, solidity) * a
    half, height = 0.5 * side, _CELLS * side
    first, second = (0.25, 0.75) if lattice == "crossed" else (0.5, 0.5)
    lines = [f"# plan: {half!r} um x {half!r} um", f"# thickness: {height!r} um", "# periodic: no"]
    lines.append("fiber,x [um],y [um],z [um],radius [um]")
    ends: list[tuple[tuple[float, float, float], tuple[float, float, float]]] = []
    for cell in range(_CELLS):
        low, high = (cell + first) * side, (cell + second) * side
        ends += [((0.0, 0.0, low), (half, 0.0, low)), ((0.0, 0.0, high), (0.0, half, high))]
    if lattice == "cubic":
        ends.append(((0.0, 0.0, 0.0), (0.0, 0.0, height)))
    for number, both in enumerate(ends):
        lines += [f"{number},{x!r},{y!r},{z!r},{a!r}" for x, y, z in both]
    return "\n".join(lines) + "\n"


def lattice_case(lattice: str, solidity: float, edge: float, mesher: str, file: Path) -> Case:
    """Give the case of a lattice whose fibers stand in a file."""
    gap = 0.5 * pitch(lattice, solidity) - 1.0
    edge *= min(1.0, gap / _WIDE_GAP)
    plenum = f"{0.5 * pitch(lattice, solidity) * _DIAMETER * 1e6!r} um"
    return validate(
        {
            "mat": {"generator": "file", "file": str(file)},
            "surface": {"sides": 4 * round(6.0 / edge / 4 + 2), "ring_spacing": edge, "smallest_edge": 0},
            "enclosure": {"inlet": plenum, "outlet": plenum},
            "tetmesh": {"engine": mesher, "edge": edge, "growth": edge / 0.6, "largest_edge": 4.0 * edge},
            "flow": {"fiber_wall": "no_slip"},
            "solve": {"stokes": {"tolerance": 1e-5}},
        },
        f"lattice {lattice}",
    )


def mean_pressure(field: FlowField, height: float, reach: float) -> float:
    """Mean of the air's pressure [Pa] about a plane across the flow.

    In a flow that repeats itself the means about two planes a period apart differ by the drop of a period, whatever
    even weight they have; the weight falls as a squared cosine to 0 at `reach` [m] from the plane.
    """
    places, weights = rule(True)
    values, slopes = shape(places)
    at = field.positions[field.cells]
    volume = np.abs(np.linalg.det(np.einsum("cka,qkb->cqab", at, slopes))) * weights
    z = np.einsum("ck,qk->cq", at[:, :, 2], values)
    pressure = field.pressure[field.cells[:, :4]] @ places.T
    share = volume * np.where(np.abs(z - height) < reach, np.cos(0.5 * np.pi * (z - height) / reach) ** 2, 0.0)
    return float((share * pressure).sum() / share.sum())


def climb_lattice(
    lattice: str, solidity: float, edge: float, mesher: str, folder: Path, progress: Progress = silent
) -> LatticeRung:
    """Run a lattice through the line, and read the permeability of its inner cell.

    Raises
    ------
    StageError
        If a stage fails.
    """
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "fibers.csv"
    file.write_text(fibers(lattice, solidity), encoding="ascii")
    case = lattice_case(lattice, solidity, edge, mesher, file)
    began = os.times()
    run(case, folder / "run", "solve", progress=progress, without=frozenset({"report", "export"}))
    took = os.times()
    results = Run(case, folder / "run")
    solution, measures, flow = results.read(Solution), results.read(TetmeshMeasures), case.flow.flow()
    side = pitch(lattice, solidity) * 0.5 * _DIAMETER
    low, high = _CELLS // 2 * side, (_CELLS // 2 + 1) * side
    drop = mean_pressure(results.read(FlowField), low, 0.25 * side)
    drop -= mean_pressure(results.read(FlowField), high, 0.25 * side)
    permeability = flow.viscosity * flow.face_velocity * side / drop / (0.5 * _DIAMETER) ** 2
    exact = EXACT[lattice][solidity]
    return LatticeRung(
        lattice=lattice,
        solidity=solidity,
        mesher=mesher,
        edge=case.tetmesh.edge,
        cells=measures.cells,
        spacing=(measures.fluid_volume / measures.cells) ** (1 / 3) / _DIAMETER,
        permeability=permeability,
        exact=exact,
        error=exact / permeability - 1.0,
        force_balance=solution.force_balance_error,
        mass_balance=solution.mass_balance_error,
        iterations=solution.iterations,
        processor_seconds=sum(took[:4]) - sum(began[:4]),
    )


def lattices(
    folder: Path, climbs: Sequence[tuple[str, str, float]] = CLIMBS, progress: Progress = silent
) -> Iterator[Callable[[], LatticeRung]]:
    """Give three rungs of every lattice to climb, coarse to fine."""
    for lattice, mesher, solidity in climbs:
        for level, edge in enumerate(EDGES):
            place = folder / mesher / f"{lattice}_{solidity:g}_{level}"
            yield partial(climb_lattice, lattice, solidity, edge, mesher, place, progress)
