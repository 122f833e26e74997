"""The mat seen from above: which part of the face fibers cover, and how high they reach there."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats
from pipeline.nouns.fibers import Mat

_PER_DIAMETER = 8
_FINEST = 2048


def relief(mat: Mat) -> Floats:
    """Give the height of the highest fiber surface over the middle of each cell of a grid over the plan.

    Parameters
    ----------
    mat : Mat

    Returns
    -------
    (nx, ny) array [m]
        Eight cells to a mean diameter, at most 2048 along x or y; NaN where no fiber lies.
    """
    width, depth, _ = mat.slab.size
    cell = max(2.0 * float(mat.radius.mean()) / _PER_DIAMETER, max(width, depth) / _FINEST)
    counts = np.array([int(np.ceil(width / cell)), int(np.ceil(depth / cell))])
    start = mat.segment_starts()
    origin = np.array(mat.slab.lower)
    tops = np.full((counts[0], counts[1]), -np.inf)
    _raise(
        mat.nodes[start] - origin,
        mat.nodes[start + 1] - origin,
        mat.radius[mat.segment_fibers()],
        _beyond(mat),
        np.array([width, depth]) / counts,
        mat.periodic,
        tops,
    )
    tops[np.isneginf(tops)] = np.nan
    return tops


def mean_top(mat: Mat, tops: Floats) -> float:
    """Average the highest surface within tiles one mean radius wide, leaving out those without a fiber.

    Parameters
    ----------
    mat : Mat
    tops : (nx, ny) array [m]
        As `relief` gives it.

    Returns
    -------
    float [m]
    """
    wide = max(1, round(float(mat.radius.mean()) * len(tops) / mat.slab.size[0]))
    nx, ny = (-(-count // wide) for count in tops.shape)
    padded = np.full((nx * wide, ny * wide), -np.inf)
    padded[: tops.shape[0], : tops.shape[1]] = np.where(np.isnan(tops), -np.inf, tops)
    highest = padded.reshape(nx, wide, ny, wide).max(axis=(1, 3))
    return float(highest[np.isfinite(highest)].mean())


def _beyond(mat: Mat) -> Floats:
    """How far each segment reaches beyond its start and its end [m], (segments, 2).

    To the next segment of its fiber: a radius, which closes the bend. At an end on a side of the plan: until its whole
    width has left the plan. At an end inside: not at all.
    """
    start = mat.segment_starts()
    fiber = mat.segment_fibers()
    radius = mat.radius[fiber]
    beyond = np.repeat(radius[:, None], 2, axis=1)
    for column, node, is_end in (
        (0, start, start == mat.first[fiber]),
        (1, start + 1, start + 1 == mat.first[fiber + 1] - 1),
    ):
        beyond[is_end, column] = 0.0
        if mat.periodic:
            continue
        step = mat.nodes[start + 1, :2] - mat.nodes[start, :2]
        slant = np.abs(step) / np.maximum(np.hypot(step[:, 0], step[:, 1]), 1e-300)[:, None]
        for axis in (0, 1):
            on_side = (mat.nodes[node, axis] == mat.slab.lower[axis]) | (mat.nodes[node, axis] == mat.slab.upper[axis])
            out = is_end & on_side & (slant[:, axis] > 0)
            beyond[out, column] = radius[out] * np.minimum(slant[out, 1 - axis] / slant[out, axis], 50.0)
    return beyond


@compiled
def _raise(
    begin: Floats, end: Floats, radius: Floats, beyond: Floats, cell: Floats, periodic: bool, tops: Floats
) -> None:
    """Raise the heights in `tops` to the surfaces of the segments, cell by cell across each."""
    at = np.empty(2, np.int64)
    for k in range(len(begin)):
        r = radius[k]
        plan = np.sqrt((end[k, 0] - begin[k, 0]) ** 2 + (end[k, 1] - begin[k, 1]) ** 2)
        if plan == 0.0:
            continue
        # walk along the axis that the segment follows more closely, and at each step across it
        major = 0 if abs(end[k, 0] - begin[k, 0]) >= abs(end[k, 1] - begin[k, 1]) else 1
        minor = 1 - major
        run, drift = (end[k, major] - begin[k, major]) / plan, (end[k, minor] - begin[k, minor]) / plan
        rise = (end[k, 2] - begin[k, 2]) / plan
        bulge = np.sqrt(1.0 + rise * rise)
        first, last = -beyond[k, 0], plan + beyond[k, 1]
        low = min(begin[k, major] + first * run, begin[k, major] + last * run) - r
        high = max(begin[k, major] + first * run, begin[k, major] + last * run) + r
        for i in range(int(np.floor(low / cell[major])), int(np.floor(high / cell[major])) + 1):
            if not periodic and (i < 0 or i >= tops.shape[major]):
                continue
            along = (i + 0.5) * cell[major] - begin[k, major]
            middle, half = begin[k, minor] + along * drift / run, r / abs(run)
            j_low, j_high = int(np.floor((middle - half) / cell[minor])), int(np.floor((middle + half) / cell[minor]))
            for j in range(j_low, j_high + 1):
                if not periodic and (j < 0 or j >= tops.shape[minor]):
                    continue
                across = (j + 0.5) * cell[minor] - begin[k, minor]
                t = along * run + across * drift
                rho = across * run - along * drift
                if t < first or t > last or rho * rho >= r * r:
                    continue
                over = min(t, 0.0) + max(t - plan, 0.0)
                top = begin[k, 2] + rise * t + bulge * np.sqrt(r * r - rho * rho)
                # beyond a bend the fiber is a ball
                if (t < 0.0 and beyond[k, 0] == r) or (t > plan and beyond[k, 1] == r):
                    if rho * rho + over * over >= r * r:
                        continue
                    top = begin[k, 2] + rise * (t - over) + np.sqrt(r * r - rho * rho - over * over)
                at[major], at[minor] = i % tops.shape[major], j % tops.shape[minor]
                tops[at[0], at[1]] = max(tops[at[0], at[1]], top)
