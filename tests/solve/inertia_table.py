"""What inertia adds to the pressure drop of rows of cylinders, and to the drag in an array, beside what is published.

``python -m tests.solve.inertia_table [REYNOLDS ...]`` for rows; ``python -m tests.solve.inertia_table array`` for the
array: the drag on an inner one of five rows at solidity 0.4.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys
from collections.abc import Iterator, Sequence

import numpy as np

from pipeline.nouns.patches import FIBERS
from pipeline.solve.stokes import solver
from pipeline.solve.stokes.creeping import creep
from pipeline.solve.stokes.inertia import with_inertia
from pipeline.solve.stokes.system import System
from tests.solve.rows import rows
from tests.solve.test_inertia import RADIUS, at_reynolds
from tests.solve.test_stokes import solved

NUMBERS = (0.1, 1.0, 5.0, 10.0)
SOLIDITY, CREEPING_DRAG = 0.4, 217.89
"""Of the published array, and its drag over viscosity and face velocity without inertia (Sangani & Acrivos 1982)."""
PUBLISHED = ((6.344, 1.0262), (17.852, 1.1127))
"""Reynolds numbers of face velocity and diameter, and drag with inertia over that without, endless square array.

Forslund, Larsson, Hellstrom & Lundstrom, Transp. Porous Med. 148, 545 (2023), Fig. 6: finite differences on a
staircase, as the project TensorLBM read them off the open figure's vectors; their creeping drag is .6 % high.
"""
_ROWS, _INNER = 5, 2


def table(numbers: Sequence[float]) -> str:
    """Solve one row and three at each fiber Reynolds number, those below the solver's own limit too."""
    solver.CREEPING_REYNOLDS = 0.0
    lines = [f"| fiber Reynolds number | {' | '.join(f'{number:g}' for number in numbers)} |"]
    for name, count in (("one row", 1), ("three rows", 3)):
        mesh, domain = rows(0.1, count=count, around=6, outward=6, radius=RADIUS)
        told = []
        for number in numbers:
            found, _ = solved(mesh, domain, 0.01, flow=at_reynolds(number))
            told.append(f"{100.0 * (found.pressure_drop / (found.pressure_drop_creeping or 1.0) - 1.0):.3f} %")
        lines.append(f"| {name} | {' | '.join(told)} |")
    return "\n".join(lines)


def in_array(numbers: Sequence[float], around: int = 8, outward: int = 3) -> Iterator[tuple[float, float]]:
    """Give the drag on an inner row: without inertia over viscosity and velocity, then with it over that without."""
    mesh, domain = rows(SOLIDITY, count=_ROWS, around=around, outward=outward, radius=RADIUS)
    duct = solver.duct_of(mesh.face_mesh(), domain, "symmetry")
    middle = duct.points[duct.triangles[FIBERS]].mean(axis=1)
    pitch = np.sqrt(np.pi / SOLIDITY) / 2.0
    first = duct.pieces.start[0, 2]
    inner = np.abs(middle[:, 2] - first - _INNER * pitch) < 0.5 * pitch
    unknowns = np.unique(duct.unknown[duct.nodes.of_triangles(duct.triangles[FIBERS][inner])])

    def silent(iterations: int, drop: float, error: float) -> None:
        pass

    still = creep(System(duct, 0.0), 1e-4, 1000, silent)
    before = -float(still.force[unknowns, 2].sum())
    yield 0.0, before / duct.upper[0]
    for number in numbers:
        found = with_inertia(System(duct, 0.0), number, 1e-4, 2000, silent, still)
        yield number, -float(found.force[unknowns, 2].sum()) / before


def array_table() -> str:
    """Solve the published array, and hold it against what is published."""
    found = in_array([number for number, _ in PUBLISHED])
    _, drag = next(found)
    lines = [f"creeping F* {drag:.2f}, exact {CREEPING_DRAG} ({100.0 * (drag / CREEPING_DRAG - 1.0):+.2f} %)"]
    for (number, ratio), (_, published) in zip(found, PUBLISHED, strict=True):
        lines.append(f"| {number:g} | {ratio:.4f} | {published} | {100.0 * (ratio / published - 1.0):+.2f} % |")
    return "\n".join(lines)


if __name__ == "__main__":
    asked = sys.argv[1:]
    text = array_table() if asked == ["array"] else table(tuple(map(float, asked)) or NUMBERS)
    sys.stdout.write(text + "\n")
