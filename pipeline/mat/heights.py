"""The mat seen from above: which part of the face fibers cover, and how high they reach there."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats
from pipeline.nouns.fibers import Mat

_PER_DIAMETER = 8
_FINEST = 2048


def surface_heights(mat: Mat) -> Floats:
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
        As `surface_heights` gives it.

    Returns
    -------
    float [m]
        The slab's thickness where no tile has one.
    """
    if np.isnan(tops).all():
        # fibers so thin that no cell's middle lies under one
        return mat.thickness
    wide = max(1, round(float(mat.radius.mean()) * len(tops) / mat.slab.size[0]))
    nx, ny = (-(-count // wide) for count in tops.shape)
    padded = np.full((nx * wide, ny * wide), -np.inf)
    padded[: tops.shape[0], : tops.shape[1]] = np.where(np.isnan(tops), -np.inf, tops)
    highest = padded.reshape(nx, wide, ny, wide).max(axis=(1, 3))
    return float(highest[np.isfinite(highest)].mean())


def _beyond(mat: Mat) -> Floats:
    """How far each segment reaches beyond its start and its end [m], (segments, 2).

    At an end on a side of the plan: until its whole width has left the plan. At an end inside: not at all. Toward the
    next segment of its fiber: -1, for the ball that closes the bend.
    """
    start = mat.segment_starts()
    fiber = mat.segment_fibers()
    radius = mat.radius[fiber]
    beyond = np.full((len(radius), 2), -1.0)
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
    """Raise the heights in `tops` to the surfaces of the segments, cell by cell around each."""
    at = np.empty(2, np.int64)
    for k in range(len(begin)):
        r = radius[k]
        plan = np.sqrt((end[k, 0] - begin[k, 0]) ** 2 + (end[k, 1] - begin[k, 1]) ** 2)
        length = np.sqrt(plan * plan + (end[k, 2] - begin[k, 2]) ** 2)
        level, rise = plan / length, (end[k, 2] - begin[k, 2]) / length
        # walk along the axis that the segment follows more closely, and at each step across it
        major = 0 if abs(end[k, 0] - begin[k, 0]) >= abs(end[k, 1] - begin[k, 1]) else 1
        minor = 1 - major
        # one along z has no direction in plan: any will do
        run, drift = 1.0, 0.0
        if plan > 0.0:
            run, drift = (end[k, major] - begin[k, major]) / plan, (end[k, minor] - begin[k, minor]) / plan
        ball_before, ball_after = beyond[k, 0] < 0.0, beyond[k, 1] < 0.0
        # places along the axis, in space, where the cylinder begins and ends
        first, last = 0.0, length
        if not ball_before and level > 0.0:
            first = -beyond[k, 0] / level
        if not ball_after and level > 0.0:
            last = length + beyond[k, 1] / level
        reach = r * np.sqrt(2.0)
        low = min(begin[k, major] + first * level * run, begin[k, major] + last * level * run) - reach
        high = max(begin[k, major] + first * level * run, begin[k, major] + last * level * run) + reach
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
                if rho * rho >= r * r:
                    continue
                top = _top(t, np.sqrt(r * r - rho * rho), level, rise, first, last)
                if ball_before:
                    top = max(top, _ball(t, rho, r))
                if ball_after:
                    top = max(top, rise * length + _ball(t - plan, rho, r))
                if top == -np.inf:
                    continue
                at[major], at[minor] = i % tops.shape[major], j % tops.shape[minor]
                tops[at[0], at[1]] = max(tops[at[0], at[1]], begin[k, 2] + top)


@compiled
def _top(t: float, half: float, level: float, rise: float, first: float, last: float) -> float:
    """Height, over the axis' start, at which a line along z leaves a cylinder with flat ends; -inf where it misses.

    The line stands at the place `t` along the axis in plan, where the cylinder is `half` wide to both sides of the
    axis. (level, rise) is the axis' direction, and `first` to `last` the places along it between the ends.
    """
    low, high = -np.inf, np.inf
    if level > 1e-9:
        low, high = (t * rise - half) / level, (t * rise + half) / level
    elif abs(t) >= half:
        return -np.inf
    if abs(rise) > 1e-9:
        one, other = (first - t * level) / rise, (last - t * level) / rise
        low, high = max(low, min(one, other)), min(high, max(one, other))
    elif t * level < first or t * level > last:
        return -np.inf
    return high if low < high else -np.inf


@compiled
def _ball(t: float, rho: float, r: float) -> float:
    """Height of a ball's top over its middle at a place in plan; -inf beside it."""
    left = r * r - t * t - rho * rho
    return float(np.sqrt(left)) if left > 0.0 else -np.inf
