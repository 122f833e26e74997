"""What meshing will take, before it starts."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import TYPE_CHECKING, Any

from pipeline.machine import MEMORY_SHARE, memory_allowed
from pipeline.mesh.engines.engine import Slenderness

if TYPE_CHECKING:
    from pipeline.line.stage import Estimate
    from pipeline.mesh.settings import TetmeshSettings
    from pipeline.nouns.domain import FluidDomain

_REACH = 1.36  # diameters: half the spacing of fibers in a mat of solidity 0.135, as the default case's
_SHARED = 0.8  # of what lone fibers would have: measured on the default case, where fibers touch
_STEPS = 200  # of the sum over distances from a fiber's axis
_COARSEST, _STEP = 20.0, 1.05  # edge that is looked at for one that fits, and from one to the next
UNSURE = 1.5
"""Factor that a mesh may take more memory than estimated, or less: for mats of thick and thin fibers."""


def estimate(case: Any) -> "Estimate | None":
    """Give what meshing a case will take by its fibers' length; None where that is not known before.

    Parameters
    ----------
    case : Case
    """
    slender, settings = slenderness_of_case(case), case.tetmesh
    if slender is None or settings.mesher.estimate is None:
        return None
    expected: Estimate = settings.mesher.estimate(slender, settings)
    return expected


def slenderness_of_case(case: Any) -> Slenderness | None:
    """Give the slenderness of the fibers that a case asks for; None where only growing the mat tells.

    Parameters
    ----------
    case : Case
    """
    mat = case.mat
    stop = getattr(mat, "stop", None)
    if stop is None:
        return None
    # length times diameter, number and volume of the fibers are given, and wanted is length over diameter: as long as
    # thick and thin fibers are alike in length, the moments of the diameter tell
    moment = mat.fiber_diameter.moment
    if stop.coverage is not None:
        slender = stop.coverage * mat.side**2 * moment(-1) / moment(1)
    elif stop.count is not None:
        slender = stop.count * mat.mean_length * moment(-1)
    elif stop.solidity is not None and hasattr(mat, "thickness"):
        slender = stop.solidity * mat.side**2 * mat.thickness * moment(-1) / (0.25 * math.pi * moment(2))
    else:
        return None
    return Slenderness(float(slender), mat.fiber_diameter.distribution == "constant")


def slenderness(domain: "FluidDomain") -> Slenderness:
    """Give the slenderness of what lies of the fibers in the air, by the area of their walls."""
    import numpy as np

    from pipeline.geometry.triangles import area_vectors

    walls = domain.fiber >= 0
    area = np.linalg.norm(area_vectors(domain.points, domain.triangles[walls]), axis=1)
    total = float((area / (4.0 * math.pi * domain.radius[domain.fiber[walls]] ** 2)).sum())
    return Slenderness(total, bool(np.ptp(domain.radius) <= 1e-6 * domain.radius.max()))


def field_cells(settings: "TetmeshSettings") -> float:
    """Give how many tetrahedra of the edges asked for fill the space around a fiber, per diameter of its length.

    Parameters
    ----------
    settings : TetmeshSettings

    Returns
    -------
    float [-]
        Within half the usual distance between fibers, the fiber's inside included; a regular tetrahedron of the edge h
        has the volume h^3 / (6 sqrt 2).
    """
    step = _REACH / _STEPS
    total = 0.0
    for k in range(_STEPS):
        distance = (k + 0.5) * step
        edge = min(settings.largest_edge, settings.edge + settings.growth * max(0.0, distance - 1.0))
        total += 2.0 * math.pi * distance * step / edge**3
    return _SHARED * 6.0 * math.sqrt(2.0) * total


def too_large(
    expected: "Estimate", slender: Slenderness, settings: "TetmeshSettings", unsure: float = 1.0, parts: bool = True
) -> str | None:
    """Say that a mesh would not fit into memory, and what would; None where it fits.

    Parameters
    ----------
    expected : Estimate
        Of the mesh.
    slender : Slenderness
    settings : TetmeshSettings
    unsure : float [-]
        Factor by which the estimate has to be beyond what is allowed.
    parts : bool
        Whether the mesh could be made in more parts.

    Returns
    -------
    str, optional
        Cells, memory, what is allowed, and the keys that take less.
    """
    allowed = memory_allowed(settings.memory_limit)
    if expected.memory <= unsure * allowed:
        return None
    engine = settings.mesher
    said = (
        f"the engine {engine.name} would make about {expected.cells:,.2g} cells and take {_size(expected.memory)}, and "
    )
    if settings.memory_limit is None:
        share = f"{100 * MEMORY_SHARE:.0f} % of what is free"
        said += f"{_size(allowed)} may be used ({share}; tetmesh.memory_limit names another limit)"
    else:
        said += f"tetmesh.memory_limit allows {_size(allowed)}"
    edge = _edge_within(allowed / expected.memory, slender, settings)
    less = [f"tetmesh.edge = {edge:g} would fit" if edge is not None else "no tetmesh.edge would fit"]
    less.append("raise tetmesh.edge or tetmesh.growth, take a smaller plan or fewer fibers, or free memory")
    if engine.in_tiles and parts:
        less.append("fibertwin tiles meshes a part at a time")
    return f"{said}: {'; '.join(less)}"


def _edge_within(share: float, slender: Slenderness, settings: "TetmeshSettings") -> float | None:
    """Find the finest edge with which an engine takes so small a share of the memory; None if there is none."""
    engine = settings.mesher
    if engine.estimate is None:
        return None
    most, edge = share * engine.estimate(slender, settings).memory, settings.edge
    while edge * _STEP < _COARSEST - 0.01:
        edge *= _STEP
        rounded = math.ceil(100.0 * edge) / 100.0
        if engine.estimate(slender, settings.changed(edge=rounded)).memory <= most:
            return rounded
    return None


def _size(memory: float) -> str:
    return f"{memory / 2**30:.2g} GiB"
