"""Whether OpenFOAM is there, and what it needs around it."""

# SPDX-License-Identifier: GPL-3.0-or-later

import os
import shutil
from collections.abc import Sequence
from pathlib import Path

DEBIAN_HOME = Path("/usr/share/openfoam")
INSTALL = "on Debian and Ubuntu: apt-get install openfoam; otherwise see openfoam.com, and source its bashrc"

SOLVER = {"com": "simpleFoam", "org": "foamRun"}
"""Program that solves a written case, by the dialect it is written for."""


def openfoam_missing(cores: int = 1, solver: str = "simpleFoam") -> str | None:
    """Say why OpenFOAM cannot run here, and what to do; None where it can.

    Parameters
    ----------
    cores : int
        Above 1, MPI and the tools that split a case are needed too.
    solver : str
        ``"foamRun"`` for a case of OpenFOAM.org's dialect.
    """
    return programs_missing([solver] if cores == 1 else [solver, "decomposePar", "mpirun"])


def programs_missing(programs: Sequence[str]) -> str | None:
    """Say which of some programs are not here, and what to do; None where all are."""
    missing = [program for program in programs if shutil.which(program) is None]
    if not missing:
        return None
    listed = " and ".join(filter(None, [", ".join(missing[:-1]), missing[-1]]))
    return f"OpenFOAM's {listed} not found on the PATH; {INSTALL}"


def environment(case: Path) -> dict[str, str]:
    """Give the environment in which OpenFOAM's programs run in a case's folder."""
    around = {**os.environ, "PWD": str(case)}
    if "WM_PROJECT_DIR" not in around and DEBIAN_HOME.is_dir():
        # Debian's package has no bashrc to source, only this
        around["WM_PROJECT_DIR"] = str(DEBIAN_HOME)
    # a container has one user and may show fewer cores than it gives: both stop Open MPI otherwise
    around["OMPI_MCA_rmaps_base_oversubscribe"] = "1"
    if os.geteuid() == 0:
        around["OMPI_ALLOW_RUN_AS_ROOT"] = around["OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"] = "1"
    return around
