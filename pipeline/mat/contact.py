"""Where a new fiber rests on the fibers below: the supports of its profile, by the paper or clear of all.

Every fiber is straight in plan, so two fibers meet in plan at one known place, or run beside each other over one
known stretch: no search is needed along them.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.triangles import Floats, Ints
from pipeline.mat.profile import profile

_LOOK = 1024
"""Earlier fibers to go through before asking whether the older ones can still matter; then again at each doubling."""

_LIFT = 4e-9
"""Share of the distance by which a clear contact is lifted, to stay clear once coordinates are rounded."""


@compiled
def supports(
    chord: Floats,
    radius: float,
    chords: Floats,
    radii: Floats,
    peaks: Floats,
    first: Ints,
    nodes: Floats,
    spacing: float,
    period: float,
    slope: float,
    clear: bool,
) -> Floats:
    """Find where a new fiber rests on the earlier ones.

    Parameters
    ----------
    chord : (5,) array [m, m, -, -, m]
        Start x, y, unit direction x, y, and length of the new fiber in plan.
    radius : float [m]
        Its radius.
    chords : (fibers, 5) array
        The earlier fibers in plan, in the same way.
    radii : (fibers,) array [m]
    peaks : (fibers,) array [m]
        Highest axis of each fiber and those before it.
    first : (fibers + 1,) int array
        Fiber k has the nodes ``first[k]`` to ``first[k + 1]``.
    nodes : (n, 2) array [m]
        Place along its chord and height of each node.
    spacing : float [m]
        Gap between surfaces.
    period : float [m]
        Period of the plan in x and y; 0 for a plan that does not wrap.
    slope : float [-]
        Relaxation slope.
    clear : bool
        Whether to keep clear of every earlier fiber, or to rest as in the paper: on fibers that the chord crosses in
        plan, at z_old + r_old + r_new + spacing.

    Returns
    -------
    (supports, 2) array [m]
        Place along the chord, within it, and least height of the new fiber's axis there. Supports that lie below
        all of the new fiber's profile may be missing.
    """
    found = np.empty((64, 2))
    count = 0
    # how far a support may stand above the highest axis below it: a tent over a piece of up to 4 R climbs 2 R slope
    above = radii.max() + radius + spacing if len(radii) > 0 else 0.0
    if clear:
        above *= (np.sqrt(1.0 + slope * slope) + 2.0 * slope) * (1.0 + 1e-6)
    lowest, look = -np.inf, _LOOK
    for back in range(len(radii)):
        k = len(radii) - 1 - back
        if back == look:
            # the newest fibers lie on top: once these bear the new fiber all along, those far below do not matter
            laid = profile(found[:count, 0].copy(), found[:count, 1].copy(), slope, radius, chord[4])
            lowest, look = laid[:, 1].min(), 2 * look
        if peaks[k] + above <= lowest:
            break
        reach = (radii[k] + radius + spacing) * (1.0 + _LIFT)
        columns, rows = _images(chord, chords, k, 0, reach, period), _images(chord, chords, k, 1, reach, period)
        for i in range(columns[0], columns[1]):
            for j in range(rows[0], rows[1]):
                gap_x, gap_y = chords[k, 0] + i * period - chord[0], chords[k, 1] + j * period - chord[1]
                # whole arrays with an index go in: a view per pair of fibers would cost more than most pairs do
                if clear:
                    found, count = _tents(chord, chords, k, gap_x, gap_y, nodes, first, reach, slope, found, count)
                else:
                    height = radii[k] + radius + spacing
                    found, count = _crossing(chord, chords, k, gap_x, gap_y, nodes, first, height, found, count)
    return found[:count]


@compiled
def _crossing(
    chord: Floats,
    chords: Floats,
    k: int,
    gap_x: float,
    gap_y: float,
    nodes: Floats,
    first: Ints,
    height: float,
    found: Floats,
    count: int,
) -> tuple[Floats, int]:
    """Add the paper's support, `height` above the axis where the chord crosses fiber k in plan, if it does."""
    cross = chord[2] * chords[k, 3] - chord[3] * chords[k, 2]
    if cross == 0.0:
        return found, count
    x = (gap_x * chords[k, 3] - gap_y * chords[k, 2]) / cross
    t = (gap_x * chord[3] - gap_y * chord[2]) / cross
    if 0.0 <= x <= chord[4] and 0.0 <= t <= chords[k, 4]:
        found = _with_room(found, count)
        found[count, 0], found[count, 1] = x, _height(nodes, first[k], first[k + 1], t) + height
        count += 1
    return found, count


@compiled
def _tents(
    chord: Floats,
    chords: Floats,
    k: int,
    gap_x: float,
    gap_y: float,
    nodes: Floats,
    first: Ints,
    reach: float,
    slope: float,
    found: Floats,
    count: int,
) -> tuple[Floats, int]:
    """Add supports that keep the new fiber's axis `reach` away from fiber k's, `gap_x`, `gap_y` from its start.

    A line that falls with the slope passes clear over a point of the earlier axis at (xi, z), rho beside the chord,
    if it stays above the disc of radius sqrt(R^2 - rho^2) there. Over a straight piece, the height of that line at the
    chord's start, c = slope xi + z + k sqrt(R^2 - rho^2) with k = sqrt(1 + slope^2), is concave, with its maximum at
    rho = m R / sqrt(k^2 + m^2), m = (slope d xi + d z) / d rho, or at an end. The falling and the rising line over a
    piece meet in the apex of its tent. Pieces are cut to at most 4 R along the chord: one tent over a long piece
    that runs beside the chord would stand needlessly high.
    """
    # along and across the chord: where the earlier fiber starts, and how fast it goes
    xi_start, rho_start = chord[2] * gap_x + chord[3] * gap_y, chord[2] * gap_y - chord[3] * gap_x
    along = chord[2] * chords[k, 2] + chord[3] * chords[k, 3]
    across = chord[2] * chords[k, 3] - chord[3] * chords[k, 2]
    begin, end = _stretch(rho_start, across, -reach, reach, 0.0, chords[k, 4])
    if begin > end:
        return found, count
    begin, end = _stretch(xi_start, along, -reach, chord[4] + reach, begin, end)
    if begin > end:
        return found, count
    steep = np.sqrt(1.0 + slope * slope)
    node = _segment(nodes, first[k], first[k + 1], begin)
    while node < first[k + 1] - 1 and nodes[node, 0] <= end:
        t0, t1 = max(begin, nodes[node, 0]), min(end, nodes[node + 1, 0])
        rise = (nodes[node + 1, 1] - nodes[node, 1]) / (nodes[node + 1, 0] - nodes[node, 0])
        cuts = max(1, int(np.ceil((t1 - t0) * abs(along) / (4.0 * reach))))
        dt = (t1 - t0) / cuts
        step = (along * dt, across * dt, rise * dt)
        for cut in range(cuts):
            t = t0 + cut * dt
            piece = (xi_start + along * t, rho_start + across * t, nodes[node, 1] + rise * (t - nodes[node, 0]))
            fall = _highest(piece, step, slope, steep, reach)
            climb = _highest(piece, step, -slope, steep, reach)
            found = _with_room(found, count)
            found[count, 0], found[count, 1] = _apex(fall, climb, slope, chord[4])
            count += 1
        node += 1
    return found, count


@compiled
def _highest(
    piece: tuple[float, float, float], step: tuple[float, float, float], slope: float, steep: float, reach: float
) -> float:
    """Largest slope xi + z + steep sqrt(reach^2 - rho^2) over a piece from `piece` to `piece + step`."""
    (xi, rho, z), (d_xi, d_rho, d_z) = piece, step
    start = slope * xi + z
    change = slope * d_xi + d_z
    best: float = max(
        start + steep * np.sqrt(max(reach * reach - rho * rho, 0.0)),
        start + change + steep * np.sqrt(max(reach * reach - (rho + d_rho) ** 2, 0.0)),
    )
    if d_rho != 0.0:
        m = change / d_rho
        rho_top = m * reach / np.sqrt(steep * steep + m * m)
        share = (rho_top - rho) / d_rho
        if 0.0 < share < 1.0:
            best = max(best, start + share * change + steep * np.sqrt(max(reach * reach - rho_top * rho_top, 0.0)))
    return best


@compiled
def _apex(fall: float, climb: float, slope: float, length: float) -> tuple[float, float]:
    """Place and height of the tent under the lines ``fall - slope x`` and ``climb + slope x``, on the chord."""
    if slope == 0.0:
        return 0.0, fall
    x = 0.5 * (fall - climb) / slope
    if x < 0.0:
        return 0.0, fall
    if x > length:
        return length, climb + slope * length
    return x, 0.5 * (fall + climb)


@compiled
def _stretch(start: float, rate: float, low: float, high: float, begin: float, end: float) -> tuple[float, float]:
    """Part of ``begin`` to ``end`` where ``start + rate t`` lies between `low` and `high`; empty if begin > end."""
    if rate == 0.0:
        return (begin, end) if low <= start <= high else (1.0, 0.0)
    t0, t1 = (low - start) / rate, (high - start) / rate
    return max(begin, min(t0, t1)), min(end, max(t0, t1))


@compiled
def _segment(nodes: Floats, low: int, high: int, t: float) -> int:
    """Node at which the segment starts that holds the place `t`, of the fiber with the nodes `low` up to `high`."""
    high -= 1
    while high - low > 1:
        middle = (low + high) // 2
        if nodes[middle, 0] <= t:
            low = middle
        else:
            high = middle
    return low


@compiled
def _height(nodes: Floats, low: int, high: int, t: float) -> float:
    node = _segment(nodes, low, high, t)
    share = (t - nodes[node, 0]) / (nodes[node + 1, 0] - nodes[node, 0])
    height: float = nodes[node, 1] + share * (nodes[node + 1, 1] - nodes[node, 1])
    return height


@compiled
def _images(chord: Floats, chords: Floats, k: int, axis: int, reach: float, period: float) -> tuple[int, int]:
    """First and one past the last period by which fiber k may come within reach of the chord along an axis."""
    if period == 0.0:
        return 0, 1
    far = 0.5 * (chord[4] + chords[k, 4]) + reach
    gap = chords[k, axis] + 0.5 * chords[k, 4] * chords[k, 2 + axis] - chord[axis] - 0.5 * chord[4] * chord[2 + axis]
    return int(np.ceil((-far - gap) / period)), int(np.floor((far - gap) / period)) + 1


@compiled
def _with_room(found: Floats, count: int) -> Floats:
    if count < len(found):
        return found
    larger = np.empty((2 * len(found), 2))
    larger[: len(found)] = found
    return larger
