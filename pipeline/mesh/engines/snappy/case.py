"""The case's folder: all that snappyHexMesh needs, and the scripts that run it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np

from pipeline.mesh.engines.snappy import dictionaries as foam
from pipeline.mesh.engines.snappy.engine import SnappySettings
from pipeline.mesh.engines.snappy.layout import Layout, layout
from pipeline.mesh.engines.snappy.scripts import JOB_SCRIPT, MESH_SCRIPT, format_job_script, format_mesh_script
from pipeline.mesh.settings import TetmeshSettings
from pipeline.nouns.domain import FluidDomain
from pipeline.nouns.patches import FIBERS
from pipeline.openfoam.decompose import format_decompose


def write_case(domain: FluidDomain, settings: TetmeshSettings, folder: Path) -> Layout:
    """Write a case that ``./Allmesh`` meshes, here or anywhere else.

    Parameters
    ----------
    domain : FluidDomain
    settings : TetmeshSettings
    folder : Path
        Made if it is not there.

    Returns
    -------
    Layout
        What the case starts from.
    """
    unit, cores = domain.mean_diameter, settings.own(SnappySettings).cores
    lower, upper = np.array(domain.box.lower) / unit, np.array(domain.box.upper) / unit
    used, numbers = np.unique(domain.triangles[domain.patch == domain.patches.index(FIBERS)], return_inverse=True)
    points = domain.points[used] / unit
    start = layout(lower, upper, points, settings)
    for part in ("constant/triSurface", "system"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    for name, text in {
        f"constant/triSurface/{foam.SURFACE}": foam.format_surface(points, numbers.reshape(-1, 3)),
        "system/blockMeshDict": foam.format_block_mesh(lower, upper, start),
        "system/snappyHexMeshDict": foam.format_snappy(start),
        "system/decomposeParDict": format_decompose(cores),
        "system/controlDict": foam.format_control(),
        "system/fvSchemes": foam.format_schemes(),
        "system/fvSolution": foam.format_solution(),
        MESH_SCRIPT: format_mesh_script(unit, cores, start.counts),
        JOB_SCRIPT: format_job_script(cores),
    }.items():
        (folder / name).write_text(text, encoding="ascii")
    (folder / MESH_SCRIPT).chmod(0o755)
    return start
