"""What inertia adds to the pressure drop of rows of cylinders: `python -m tests.solve.inertia_table [REYNOLDS ...]`."""

# SPDX-License-Identifier: GPL-3.0-or-later

import sys

from pipeline.solve.stokes import solver
from tests.solve.rows import rows
from tests.solve.test_inertia import RADIUS, at_reynolds
from tests.solve.test_stokes import solved

NUMBERS = (0.1, 1.0, 5.0, 10.0)


def table(numbers: tuple[float, ...]) -> str:
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


if __name__ == "__main__":
    sys.stdout.write(table(tuple(float(number) for number in sys.argv[1:]) or NUMBERS) + "\n")
