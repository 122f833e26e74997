"""What a mat is like, in numbers."""

import math
from dataclasses import dataclass

import numpy as np

from pipeline.data import Mat
from pipeline.geometry.triangles import Floats


@dataclass(frozen=True, slots=True)
class MatMeasures:
    """The measures of a mat [SI]; `dataclasses.asdict` makes them fit for JSON.

    Parameters
    ----------
    fibers : int
    segments : int
        Straight pieces of all fibers.
    coverage : float [-]
        Summed plan area of the fibers over the face's area; may exceed 1.
    thickness : float [m]
        Extent of the slab: in a layered mat the highest axis plus its radius.
    solidity : float [-]
        Summed cylinder volume over the slab's volume; what fibers share counts twice.
    """

    fibers: int
    segments: int
    coverage: float
    thickness: float
    solidity: float


def measure(mat: Mat) -> MatMeasures:
    """Measure a mat.

    A piece that runs within a side plane of the plan counts half: half of it lies outside.

    Parameters
    ----------
    mat : Mat

    Returns
    -------
    MatMeasures
    """
    start = mat.segment_starts()
    step = mat.nodes[start + 1] - mat.nodes[start]
    radius = mat.radius[mat.segment_fibers()]
    inside = share_inside(mat)
    plan = np.hypot(step[:, 0], step[:, 1])
    return MatMeasures(
        fibers=mat.fibers,
        segments=mat.segments,
        coverage=float((inside * 2.0 * radius * plan).sum()) / mat.slab.face_area,
        thickness=mat.thickness,
        solidity=float((inside * math.pi * radius**2 * mat.segment_lengths()).sum()) / mat.slab.volume,
    )


def share_inside(mat: Mat) -> Floats:
    """Share of each segment that lies within the plan: 1, or 1/2 where its axis runs within a side, (segments,)."""
    share = np.ones(mat.segments)
    if mat.periodic:
        return share
    start = mat.segment_starts()
    for axis in (0, 1):
        for side in (mat.slab.lower[axis], mat.slab.upper[axis]):
            on_side = (mat.nodes[start, axis] == side) & (mat.nodes[start + 1, axis] == side)
            share[on_side] *= 0.5
    return share
