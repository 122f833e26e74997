"""What meshing will take, before it starts."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pipeline.line.stage import Estimate
    from pipeline.mesh.settings import TetmeshSettings
    from pipeline.nouns.domain import FluidDomain

_REACH = 1.36  # diameters: half the spacing of fibers in a mat of solidity 0.135, as the default case's
_SHARED = 0.8  # of what lone fibers would have: measured on the default case, where fibers touch
_STEPS = 200  # of the sum over distances from a fiber's axis


def estimate(case: Any) -> "Estimate | None":
    """Give what meshing a case will take by its fibers' length; None where that is not known before.

    Parameters
    ----------
    case : Case
    """
    mat = case.mat
    stop = getattr(mat, "stop", None)
    if stop is None:
        return None
    diameter = mat.fiber_diameter.mean
    if stop.coverage is not None:
        slender = stop.coverage * (mat.side / diameter) ** 2
    elif stop.count is not None:
        slender = stop.count * mat.mean_length / diameter
    else:
        return None
    settings: TetmeshSettings = case.tetmesh
    return settings.mesher.estimate(slender, settings) if settings.mesher.estimate is not None else None


def slenderness(domain: "FluidDomain") -> float:
    """Give the sum over all fibers of length in the air over diameter [-], by the area of their walls."""
    import numpy as np

    from pipeline.geometry.triangles import area_vectors

    walls = domain.fiber >= 0
    area = np.linalg.norm(area_vectors(domain.points, domain.triangles[walls]), axis=1)
    return float((area / (4.0 * math.pi * domain.radius[domain.fiber[walls]] ** 2)).sum())


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
