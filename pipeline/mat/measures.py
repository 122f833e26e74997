"""What a mat is like, in numbers."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.geometry.box import Box
from pipeline.geometry.triangles import Floats
from pipeline.mat.neighbors import near_fibers
from pipeline.mat.windows import lengths_within
from pipeline.nouns.fibers import Mat
from pipeline.nouns.mat_measures import DiameterMoments, MatMeasures, SolidityProfile

CONTACT_GAP = 0.01
"""Fibers count as touching whose surfaces are this share of the sum of their radii apart, or less."""

_LAYERS = 50

_FRAME = 0.1  # of the plan's width, on each side


def measure(mat: Mat) -> MatMeasures:
    """Measure a mat.

    A piece that runs within a side plane of the plan counts half: half of it lies outside.

    Parameters
    ----------
    mat : Mat

    Returns
    -------
    MatMeasures

    Examples
    --------
    >>> from pipeline.mat.generate import generate
    >>> from pipeline.mat.settings import ArraySettings
    >>> array = generate(ArraySettings(arrangement="square", solidity=0.1, fiber_diameter=1e-6, rows=4))
    >>> round(measure(array).solidity, 12)
    0.1
    """
    # numba is loaded where a mat is measured, not where a case file is read
    from pipeline.mat.heights import mean_top, surface_heights
    from pipeline.mat.layers import solidity_profile

    start = mat.segment_starts()
    step = mat.nodes[start + 1] - mat.nodes[start]
    fiber = mat.segment_fibers()
    radius = mat.radius[fiber]
    inside = mat.share_inside()
    length = inside * mat.segment_lengths()
    tops = surface_heights(mat)
    touching = near_fibers(mat, (1.0 + CONTACT_GAP) * mat.radius)
    return MatMeasures(
        fibers=mat.fibers,
        segments=mat.segments,
        coverage=float((inside * 2.0 * radius * np.hypot(step[:, 0], step[:, 1])).sum()) / mat.slab.face_area,
        thickness=mat.thickness,
        solidity=float((math.pi * radius**2 * length).sum()) / mat.slab.volume,
        covered_fraction=float(np.isfinite(tops).mean()),
        robust_thickness=mean_top(mat, tops),
        total_length=float(length.sum()),
        contacts_per_fiber=2.0 * int((touching.first != touching.second).sum()) / mat.fibers,
        orientation=_orientation(step, length),
        diameters=_moments(2.0 * mat.radius, _per_fiber(mat, length)),
        profile=_profile(mat, solidity_profile(mat, inside, _LAYERS)),
        frame_density=_frame_density(mat, math.pi * radius**2 * inside),
    )


def _frame_density(mat: Mat, section: Floats) -> float | None:
    """Compare the solid per plan area in the outer tenth of the plan, all around, with that of the rest."""
    (x0, y0, _), (x1, y1, _) = mat.slab.lower, mat.slab.upper
    dx, dy = _FRAME * (x1 - x0), _FRAME * (y1 - y0)
    if mat.periodic or min(dx, dy) < 2.0 * float(mat.radius.mean()):
        return None
    start = mat.segment_starts()
    begin, end = mat.nodes[start], mat.nodes[start + 1]
    heights = mat.nodes[:, 2]
    # beyond all axes along z
    low, high = float(heights.min()) - mat.thickness, float(heights.max()) + mat.thickness
    center = float((section * lengths_within(Box((x0 + dx, y0 + dy, low), (x1 - dx, y1 - dy, high)), begin, end)).sum())
    if center == 0.0:
        return None
    frame = float((section * mat.segment_lengths()).sum()) - center
    inner = (1.0 - 2.0 * _FRAME) ** 2
    return (frame / (1.0 - inner)) / (center / inner)


def _per_fiber(mat: Mat, length: Floats) -> Floats:
    sums: Floats = np.add.reduceat(length, mat.first[:-1] - np.arange(mat.fibers))
    return sums


def _orientation(step: Floats, length: Floats) -> tuple[tuple[float, ...], ...]:
    direction = step / np.linalg.norm(step, axis=1)[:, None]
    tensor = np.einsum("k,ki,kj->ij", length, direction, direction) / length.sum()
    return tuple(tuple(row) for row in tensor.tolist())


def _moments(diameters: Floats, length: Floats) -> DiameterMoments:
    mean, std = float(diameters.mean()), float(diameters.std())
    # the rounding of the mean would pass for a spread
    same = diameters.min() == diameters.max()
    return DiameterMoments(
        mean=mean,
        std=0.0 if same else std,
        min=float(diameters.min()),
        max=float(diameters.max()),
        skewness=0.0 if same else float((((diameters - mean) / std) ** 3).mean()),
        length_weighted=float((diameters * length).sum() / length.sum()),
        surface_weighted=float((diameters**2 * length).sum() / (diameters * length).sum()),
    )


def _profile(mat: Mat, solidity: Floats) -> SolidityProfile:
    layers = len(solidity)
    z = mat.slab.lower[2] + (np.arange(layers) + 0.5) * mat.thickness / layers
    return SolidityProfile(tuple(z.tolist()), tuple(solidity.tolist()))
