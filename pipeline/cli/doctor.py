"""What this machine has of what fibertwin needs and can use."""

# SPDX-License-Identifier: GPL-3.0-or-later

import importlib.metadata
import os
import platform
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import psutil

from pipeline import child_process
from pipeline.mesh.engines.snappy.running import PARALLEL, PROGRAMS
from pipeline.openfoam.environment import INSTALL, environment
from pipeline.scratch import scratch_folder

_SOLVER = ("checkMesh", "simpleFoam")
_TIME_LIMIT = 120.0  # seconds after which a program that was asked something says nothing any more
_INSTALL_MPI = "on Debian: apt-get install openmpi-bin"
_SPHERE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=[60, 60])
plotter.add_mesh(pyvista.Sphere())
assert plotter.screenshot(None, return_img=True).std() > 0
"""


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing looked for: what was found, whether that will do, and what to do if not."""

    name: str
    found: str
    fine: bool
    needed: bool
    advice: str = ""


def examine() -> list[Finding]:
    """Look at the interpreter, the libraries, OpenFOAM, MPI, OpenGL, memory and cores."""
    findings = [Finding("Python", platform.python_version(), True, True)]
    for requirement in importlib.metadata.requires("fibertwin") or []:
        if "extra ==" in requirement:
            continue
        name = requirement.split(">")[0].split(";")[0].strip()
        findings.append(_library(name))
    findings += [
        _openfoam(),
        _programs("snappyHexMesh", (*PROGRAMS, *PARALLEL), 'only tetmesh.engine = "snappy" needs it', INSTALL),
        _programs("MPI", ("mpirun",), "only more than one core needs it", _INSTALL_MPI),
        _opengl(),
    ]
    memory = psutil.virtual_memory()
    enough = memory.available >= 4 * 2**30
    findings.append(
        Finding(
            "memory",
            f"{memory.available / 2**30:.1f} of {memory.total / 2**30:.1f} GiB free",
            enough,
            False,
            "" if enough else "the default case wants 4 GiB: close other programs, or raise tetmesh.edge",
        )
    )
    findings.append(Finding("cores", str(os.cpu_count()), True, False))
    return findings


def _library(name: str) -> Finding:
    try:
        return Finding(name, importlib.metadata.version(name), True, True)
    except importlib.metadata.PackageNotFoundError:
        return Finding(name, "missing", False, True, "make setup")


def _openfoam() -> Finding:
    found = _programs("OpenFOAM", _SOLVER, "only `solve` needs it", INSTALL)
    if not found.fine:
        return found
    _, said = _run(["simpleFoam", "-help"], environment(Path.cwd()))
    # "Using: OpenFOAM-v2312 (2312) - visit www.openfoam.com", or with a name of its own before the parenthesis
    version = re.search(r"Using:?\s+OpenFOAM\S*\s+\(([^)]+)\)", said)
    return Finding("OpenFOAM", version[1] if version else "found", True, False)


def _run(command: list[str], around: dict[str, str]) -> tuple[int | None, str]:
    """Run a program and give its code, None where it does not end, and what it said."""
    with scratch_folder("doctor") as folder:
        log = folder / "log"
        with child_process.started(command, folder, log, around, [folder]) as child:
            try:
                code = child.wait(_TIME_LIMIT)
            except subprocess.TimeoutExpired:
                code = None
        return code, log.read_text(errors="replace")


def _programs(name: str, programs: Sequence[str], purpose: str, advice: str) -> Finding:
    missing = [program for program in programs if shutil.which(program) is None]
    if missing:
        return Finding(name, f"{', '.join(missing)} not on the PATH", False, False, f"{purpose}; {advice}")
    return Finding(name, "found", True, False)


def _opengl() -> Finding:
    from pipeline.report.views.render import rendering_environment

    # a process of its own: VTK ends the one that asks in vain
    code, _ = _run([sys.executable, "-P", "-c", _SPHERE], rendering_environment())
    if code != 0:
        return Finding(
            "OpenGL", "VTK draws nothing", False, False,
            "pages have no pictures without it; on Debian: apt-get install libegl1 libgl1-mesa-dri",
        )  # fmt: skip
    return Finding("OpenGL", "draws", True, False)
