"""What OpenFOAM's function objects wrote while it ran."""

# SPDX-License-Identifier: GPL-3.0-or-later

import re
from pathlib import Path

import numpy as np

from pipeline.nouns.arrays import Floats

PRESSURE_IN, PRESSURE_OUT, FLOW_IN, FLOW_OUT, DRAG = (
    "inletPressure",
    "outletPressure",
    "inletFlow",
    "outletFlow",
    "drag",
)
_NOT_NUMBERS = str.maketrans("()", "  ")
_RESIDUAL = re.compile(r"Solving for (\w+), Initial residual = ([-+.0-9einfa]+)")


def history(case: Path, name: str, column: int = 1) -> Floats:
    """Read one number per iteration that a function object wrote, over all restarts.

    Parameters
    ----------
    case : Path
    name : str
        Of the function object.
    column : int
        Which number of a line; 0 is the iteration itself.

    Returns
    -------
    (k, 2) array
        Iteration and value; where a restart wrote an iteration again, the later run counts.
    """
    found: dict[float, float] = {}
    for start in sorted((case / "postProcessing" / name).glob("*"), key=_iteration):
        for path in sorted(start.glob("*.dat")):
            if path.name.startswith("moment"):
                continue
            # a run that starts again at an iteration replaces what came after it
            found = {at: value for at, value in found.items() if at <= _iteration(start)}
            found |= _rows(path.read_text(encoding="ascii", errors="replace"), column)
    rows = sorted(found.items())
    return np.array(rows, np.float64).reshape(-1, 2)


def table(case: Path) -> Floats:
    """Read what is known of each iteration that all tables tell of, that of the drag among them.

    A run that is ended between the lines that two tables get of one iteration would be told by this one and that.

    Returns
    -------
    (k, 5) array
        Iteration, mean pressure over the density at inlet and outlet, flow out of inlet and outlet.
    """
    each = [history(case, name) for name in (PRESSURE_IN, PRESSURE_OUT, FLOW_IN, FLOW_OUT)]
    common = history(case, DRAG)[:, 0]
    for other in each:
        common = np.intersect1d(common, other[:, 0])
    return np.column_stack([common, *(found[np.isin(found[:, 0], common), 1] for found in each)])


def _iteration(folder: Path) -> float:
    try:
        return float(folder.name)
    except ValueError:
        return -1.0


def _rows(text: str, column: int) -> dict[float, float]:
    rows = {}
    # the last line may be half written while the solver runs
    for line in text.split("\n")[:-1]:
        numbers = line.translate(_NOT_NUMBERS).split()
        if len(numbers) > column and not line.startswith("#"):
            rows[float(numbers[0])] = float(numbers[column])
    return rows


def residuals(log: str) -> dict[str, float]:
    """Give the latest initial residual of each equation.

    Examples
    --------
    >>> residuals("GAMG:  Solving for p, Initial residual = 0.5, Final residual = 0.01, No Iterations 6")
    {'p': 0.5}
    """
    return {name: float(value) for name, value in _RESIDUAL.findall(log)}
