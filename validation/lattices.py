"""Three-dimensional lattices of fibers through the whole line, against permeabilities that no open table has."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from dataclasses import dataclass
from pathlib import Path

from pipeline.case import Case, validate
from pipeline.line.run import Run, run
from pipeline.nouns.flow import Solution, SolvingCost
from pipeline.nouns.mesh_measures import MeshingCost, TetmeshMeasures
from pipeline.progress import Progress, silent

EXACT = {
    "crossed": {0.02: 19.17, 0.1: 1.83853, 0.3: 0.21566},
    "cubic": {0.02: 25.390, 0.05: 6.8441, 0.2: 0.57481},
}
"""k/a^2 by solidity, by curved elements of fourth order until the digits stood, in a program of its own: crossed layers
(an x-fiber at z = 0, a y-fiber at z = L/2, flow along z), and three orthogonal fibers that meet in one point."""
EDGES = (0.5, 0.36, 0.26)
"""Edge at the fibers of each rung in fiber diameters, coarse to fine, where the gaps are wide."""
_DIAMETER = 1e-6
_CELLS = 3  # along the flow; the inner one counts
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
    seconds : float [s]
        Of mesher and solver.
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
    seconds: float


def pitch(lattice: str, solidity: float) -> float:
    r"""Period L over the fiber's radius.

    Crossed layers: :math:`\varphi = 2\pi (a/L)^2`; cubic: :math:`\varphi = 3\pi (a/L)^2 - 8\sqrt2\,(a/L)^3`.

    Examples
    --------
    >>> round(pitch("crossed", 0.1), 4), round(pitch("cubic", 0.2), 4)
    (7.9267, 6.1157)
    """
    if lattice == "crossed":
        return math.sqrt(2.0 * math.pi / solidity)
    low, high = 2.1, 100.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        share = 3.0 * math.pi / middle**2 - 8.0 * math.sqrt(2.0) / middle**3
        low, high = (middle, high) if share > solidity else (low, middle)
    return 0.5 * (low + high)


def fibers(lattice: str, solidity: float) -> tuple[str, list[list[int]]]:
    """Give a lattice as a file of fibers, and the fibers of each cell along the flow."""
    a = 0.5e6 * _DIAMETER
    side = pitch(lattice, solidity) * a
    lines: list[str] = []
    cells: list[list[int]] = []

    def add(one: tuple[float, float, float], two: tuple[float, float, float]) -> int:
        number = len(lines) // 2
        lines.extend(f"{number},{x!r},{y!r},{z!r},{a!r}" for x, y, z in (one, two))
        return number

    half = 0.5 * side
    for cell in range(_CELLS):
        low = cell * side
        if lattice == "crossed":
            cells.append(
                [
                    add((0.0, half, low + 0.25 * side), (side, half, low + 0.25 * side)),
                    add((half, 0.0, low + 0.75 * side), (half, side, low + 0.75 * side)),
                ]
            )
        else:
            cells.append(
                [
                    add((0.0, half, low + half), (side, half, low + half)),
                    add((half, 0.0, low + half), (half, side, low + half)),
                    add((half, half, low), (half, half, low + side)),
                ]
            )
    head = [f"# plan: {side!r} um x {side!r} um", f"# thickness: {_CELLS * side!r} um", "# periodic: no"]
    return "\n".join([*head, "fiber,x [um],y [um],z [um],radius [um]", *lines]) + "\n", cells


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
            "tetmesh": {"engine": mesher, "edge": edge, "growth": edge, "largest_edge": 4.0 * edge},
            "flow": {"fiber_wall": "no_slip"},
            "solve": {"stokes": {"tolerance": 1e-5}},
        },
        f"lattice {lattice}",
    )


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
    text, cells = fibers(lattice, solidity)
    file = folder / "fibers.csv"
    file.write_text(text, encoding="ascii")
    case = lattice_case(lattice, solidity, edge, mesher, file)
    run(case, folder / "run", "solve", progress=progress, without=frozenset({"report", "export"}))
    results = Run(case, folder / "run")
    solution, measures, flow = results.read(Solution), results.read(TetmeshMeasures), case.flow.flow()
    drag = sum(solution.drag_per_fiber[fiber] for fiber in cells[_CELLS // 2])
    side = pitch(lattice, solidity) * 0.5 * _DIAMETER
    # the pressure acts on the air's share of a cell's face, which a fiber along the flow leaves
    open_share = 1.0 - (math.pi / pitch(lattice, solidity) ** 2 if lattice == "cubic" else 0.0)
    permeability = flow.viscosity * flow.face_velocity * side**3 * open_share / drag / (0.5 * _DIAMETER) ** 2
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
        seconds=results.read(MeshingCost).seconds + results.read(SolvingCost).seconds,
    )


def lattices(folder: Path, mesher: str, progress: Progress = silent) -> list[LatticeRung]:
    """Climb three rungs of every lattice, coarse to fine."""
    return [
        climb_lattice(lattice, solidity, edge, mesher, folder / mesher / f"{lattice}_{solidity:g}_{level}", progress)
        for lattice, exact in EXACT.items()
        for solidity in exact
        for level, edge in enumerate(EDGES)
    ]
