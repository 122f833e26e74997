"""The drag on each row of an array, read from a solved case by OpenFOAM itself.

The outer rows lack neighbours: at solidity 0.1 a row of a square array that stands alone has 4.1 % more drag than one
among others (Tamada & Fujikawa 1957). What a missing row changes falls with distance z as (1 + k z) exp(-k z),
k = 2 pi over the pitch, so two rows away it is some 1e-4 of the drag: the middle one of three is as good as endless.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pipeline.errors import StageError
from pipeline.nouns.fibers import Mat
from pipeline.nouns.flow import Flow
from pipeline.nouns.patches import FIBERS
from pipeline.openfoam.environment import environment

_NAME = "rowDrag"
_NUMBERS_PER_BIN = 9  # total, pressure and viscous force, three components each
_ALONG_FLOW = 2


def row_drags(solved: Path, rows: int, flow: Flow) -> tuple[float, ...]:
    """Give the drag along the flow on each row of fibers [N], from the inlet to the outlet.

    Parameters
    ----------
    solved : Path
        A case as the solver left it; left as it is.
    rows : int
        Rows of fibers, evenly spaced along z and apart from each other.
    flow : Flow

    Returns
    -------
    tuple of float [N]

    Raises
    ------
    StageError
        If OpenFOAM cannot read the case.
    """
    with tempfile.TemporaryDirectory(prefix="fibertwin-") as folder:
        case = Path(folder) / "case"
        shutil.copytree(solved, case, ignore=shutil.ignore_patterns("postProcessing"))
        (case / "system" / _NAME).write_text(_function(rows, flow), encoding="ascii")
        command = ["simpleFoam", "-postProcess", "-dict", f"system/{_NAME}", "-latestTime"]
        done = subprocess.run(command, cwd=case, env=environment(case), capture_output=True, text=True, check=False)
        found = sorted(case.glob(f"postProcessing/{_NAME}/*/forceBin.dat"))
        if done.returncode or not found:
            raise StageError(f"the drag on each row of {solved} cannot be read:\n{done.stdout[-800:]}{done.stderr}")
        return drags_of_bins(found[-1].read_text(encoding="ascii"), rows)


def drags_of_fibers(mat: Mat, drags: Sequence[float], rows: int) -> tuple[float, ...]:
    """Sum the drag [N] of the fibers of each of an array's rows, from the inlet to the outlet."""
    height = mat.nodes[mat.first[:-1], 2]
    row = np.floor(height / mat.thickness * rows).astype(np.int64)
    return tuple(np.bincount(row, drags, rows).tolist())


def drags_of_bins(text: str, rows: int) -> tuple[float, ...]:
    r"""Read the total force along z of each bin from what OpenFOAM's `forces` wrote last.

    Examples
    --------
    >>> drags_of_bins("# Time\n7 (1 2 3) (0 0 1) (1 2 2) (4 5 6) (0 0 2) (4 5 4)\n", 2)
    (3.0, 6.0)
    """
    line = text.strip().split("\n")[-1].replace("(", " ").replace(")", " ")
    forces = [float(number) for number in line.split()[1:]]
    return tuple(forces[_NUMBERS_PER_BIN * row + _ALONG_FLOW] for row in range(rows))


def _function(rows: int, flow: Flow) -> str:
    # equal bins from the first row's front to the last row's back part rows that do not overlap along z
    return f"""FoamFile {{ version 2.0; format ascii; class dictionary; object {_NAME}; }}
functions
{{
    {_NAME}
    {{
        type            forces;
        libs            ("libforces.so");
        patches         ({FIBERS});
        rho             rhoInf;
        rhoInf          {flow.density!r};
        CofR            (0 0 0);
        log             no;
        binData
        {{
            nBin            {rows};
            direction       (0 0 1);
            cumulative      no;
        }}
    }}
}}
"""
