"""The fibers of a mat become one closed surface, cut flush with the plan's sides."""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np

from pipeline.errors import StageError
from pipeline.geometry.box import Box
from pipeline.geometry.crossings import self_intersections
from pipeline.geometry.solids import Body, unite_within
from pipeline.geometry.triangles import Floats, Ints
from pipeline.nouns.fibers import ON_SIDE, Mat, Pieces
from pipeline.nouns.surface import Surface
from pipeline.progress import Progress, silent
from pipeline.surface.joints import polygon_radius
from pipeline.surface.settings import SurfaceSettings
from pipeline.surface.size import SECONDS_PER_TRIANGLE, refuse_too_large
from pipeline.surface.tubes import Ends, tubes


def unite(mat: Mat, settings: SurfaceSettings, progress: Progress = silent) -> Surface:
    """Unite the fibers into closed surfaces, cut flush with the plan's sides and open to nothing along z.

    An end on a side of the plan runs on through that side before the cut; an end inside gets a cap. In a
    periodic mat what leaves through one side enters through the opposite one.

    Parameters
    ----------
    mat : Mat
    settings : SurfaceSettings
    progress : Progress

    Returns
    -------
    Surface

    Raises
    ------
    StageError
        If no fiber lies within the plan, the surface would not fit into memory, the union fails, or the surface still
        cuts itself somewhere.
    """
    expected = refuse_too_large(mat, settings)
    bodies, fiber, _ = fiber_bodies(mat, settings, progress)
    progress(
        f"uniting {len(bodies)} tubes of {mat.fibers} fibers: about {expected:,.0f} triangles, the stage takes about "
        f"{max(1.0, SECONDS_PER_TRIANGLE * expected):.0f} s"
    )
    points, triangles, body = unite_within(bodies, clipping_box(mat, bodies))
    if len(triangles) == 0:
        raise StageError(f"none of the {mat.fibers} fibers lies within the plan {mat.slab}; check their coordinates")
    source = np.where(body >= 0, fiber[np.maximum(body, 0)], -1)
    fiber = spread(triangles, source)
    if settings.smallest_edge > 0:
        # numba takes half a second to load
        from pipeline.surface.tidy import tidied

        progress(f"clearing splinters from {len(triangles)} triangles")
        points, triangles, fiber = tidied(
            points, triangles, fiber, mat.radius, _sides(points, mat.slab), settings.smallest_edge
        )
    progress(f"looking for cuts in {len(triangles)} triangles")
    _refuse_cuts(points, triangles, fiber)
    return Surface(points, triangles, fiber, mat.radius, mat.slab, fiber_pieces(mat, settings))


def _refuse_cuts(points: Floats, triangles: Ints, fiber: Ints) -> None:
    cut = self_intersections(points, triangles)
    if len(cut):
        place = ", ".join(f"{1e6 * coordinate:.4g}" for coordinate in points[triangles[cut[0]]].mean(axis=0))
        names = ", ".join(str(name) for name in np.unique(fiber[cut])[:5].tolist())
        raise StageError(
            f"{len(cut)} of {len(triangles)} triangles of the united surface cut another one, first at ({place}) um, "
            f"of fibers {names}; set surface.smallest_edge = 0, or other surface.sides"
        )


def fiber_bodies(mat: Mat, settings: SurfaceSettings, progress: Progress = silent) -> tuple[list[Body], Ints, Ints]:
    """Build the closed tubes of every fiber, and of its periodic images that meet the plan.

    Parameters
    ----------
    mat : Mat
    settings : SurfaceSettings
    progress : Progress

    Returns
    -------
    bodies : list of (points, triangles)
        Running out through the plan's sides, not cut yet.
    fiber : (bodies,) int array
        Fiber that each body belongs to.
    before : (bodies,) int array
        The body that each one continues through a ball on a bend, with which it shares what lies in that ball; -1
        where there is none.
    """
    bodies: list[Body] = []
    fiber: list[int] = []
    before: list[int] = []
    for k in range(mat.fibers):
        if k % 100 == 0:
            progress("building tubes", k / mat.fibers)
        nodes, radius = mat.nodes[mat.first[k] : mat.first[k + 1]], float(mat.radius[k])
        if mat.periodic:
            ends = Ends(settings.caps, settings.caps)
        else:
            nodes, ends = run_through(nodes, radius, mat.slab, settings)
        last: dict[tuple[float, ...], int] = {}
        for (points, triangles), in_ball in tubes(nodes, radius, ends, settings):
            images = {tuple(shift.tolist()): len(bodies) + n for n, shift in enumerate(_images(points, mat))}
            for shift in images:
                bodies.append((points + np.array(shift), triangles))
                fiber.append(k)
                before.append(last.get(shift, -1) if in_ball else -1)
            last = images
    return bodies, np.array(fiber, dtype=np.int64), np.array(before, dtype=np.int64)


def fiber_pieces(mat: Mat, settings: SurfaceSettings) -> Pieces:
    """Give the straight pieces of every fiber, and of its periodic images that meet the plan.

    Parameters
    ----------
    mat : Mat
    settings : SurfaceSettings

    Returns
    -------
    Pieces
    """
    start, end, fiber, flat = [], [], [], []
    for k in range(mat.fibers):
        nodes, radius = mat.nodes[mat.first[k] : mat.first[k + 1]], float(mat.radius[k])
        ends = Ends(settings.caps, settings.caps)
        if not mat.periodic:
            nodes, ends = run_through(nodes, radius, mat.slab, settings)
        around = np.concatenate([nodes - radius, nodes + radius])
        is_flat = np.zeros((len(nodes) - 1, 2), dtype=bool)
        is_flat[0, 0], is_flat[-1, 1] = ends.start == "flat", ends.stop == "flat"
        for shift in _images(around, mat):
            start.append(nodes[:-1] + shift)
            end.append(nodes[1:] + shift)
            fiber.append(np.full(len(nodes) - 1, k))
            flat.append(is_flat)
    return Pieces(*(np.concatenate(parts) for parts in (start, end, fiber, flat)))


def run_through(nodes: Floats, radius: float, slab: Box, settings: SurfaceSettings) -> tuple[Floats, Ends]:
    """Extend the ends that lie on the plan's sides until the cut meets the whole cross-section.

    A chord that grazes a corner would have to run far before its cross-section has left through the side it
    ends on; it runs on to whichever side it leaves first.

    Parameters
    ----------
    nodes : (n, 3) array [m]
    radius : float [m]
    slab : Box [m]
    settings : SurfaceSettings

    Returns
    -------
    nodes : (n, 3) array [m]
        The first and last node moved outward, or a node added beyond them, where they lie on a side.
    ends : Ends
        How each end is closed.
    """
    reach = polygon_radius(radius, settings.sides)
    low, high = slab.lower[2] + radius, slab.upper[2] - radius
    how = []
    for end, inner in ((0, 1), (-1, -2)):
        outward = nodes[end] - nodes[inner]
        outward /= np.linalg.norm(outward)
        on_side, length = _way_out(nodes[end], outward, radius, reach, slab)
        if on_side:
            beyond = nodes[end] + length * outward
            if low <= beyond[2] <= high:
                nodes = np.concatenate([beyond[None], nodes[1:]] if end == 0 else [nodes[:-1], beyond[None]])
            else:  # a steep fiber that grazes a side would dive out of the slab: it runs on level
                beyond[2] = nodes[end, 2]
                nodes = np.concatenate([beyond[None], nodes] if end == 0 else [nodes, beyond[None]])
        how.append("flat" if on_side else settings.caps)
    return nodes, Ends(*how)


def _way_out(end: Floats, outward: Floats, radius: float, reach: float, slab: Box) -> tuple[bool, float]:
    """Tell whether an end lies on a side, and how far on from it the cross-section has left through a side."""
    lengths = [np.inf]
    on_side = False
    for axis in (0, 1):
        for side, sign in ((slab.lower[axis], -1.0), (slab.upper[axis], 1.0)):
            toward = sign * outward[axis]
            gap = sign * (side - end[axis])
            if toward <= 1e-9:
                continue
            on_side |= bool(gap <= ON_SIDE * radius)
            tilt = np.sqrt(max(0.0, 1.0 - toward**2))
            lengths.append((gap + 1.05 * reach * tilt) / toward + 0.5 * radius)
    return on_side, max(float(min(lengths)), 0.0)


def clipping_box(mat: Mat, bodies: list[Body]) -> Box:
    """Give the plan as a box that reaches beyond every body along z."""
    low = min(float(points[:, 2].min()) for points, _ in bodies)
    high = max(float(points[:, 2].max()) for points, _ in bodies)
    margin = 0.1 * (high - low)
    (x0, y0, _), (x1, y1, _) = mat.slab.lower, mat.slab.upper
    return Box((x0, y0, low - margin), (x1, y1, high + margin))


def _images(points: Floats, mat: Mat) -> list[Floats]:
    """Shifts by whole periods that bring some of the points into the plan."""
    if not mat.periodic:
        return [np.zeros(3)]
    ranges = []
    for axis in (0, 1):
        size = mat.slab.size[axis]
        first = np.ceil((mat.slab.lower[axis] - points[:, axis].max()) / size)
        last = np.floor((mat.slab.upper[axis] - points[:, axis].min()) / size)
        ranges.append(size * np.arange(first, last + 1))
    return [np.array([x, y, 0.0]) for x in ranges[0] for y in ranges[1]]


def _sides(points: Floats, slab: Box) -> Ints:
    """Give each point a bit per side of the plan that it lies on."""
    places = [(axis, place) for axis in (0, 1) for place in (slab.lower[axis], slab.upper[axis])]
    bits: Ints = sum(
        ((points[:, axis] == place).astype(np.int64) << k for k, (axis, place) in enumerate(places)),
        np.zeros(len(points), dtype=np.int64),
    )
    return bits


def spread(triangles: Ints, label: Ints) -> Ints:
    """Give each unlabeled triangle (-1) the label of a labeled one that it is connected to by edges.

    Parameters
    ----------
    triangles : (m, 3) int array
        A closed surface.
    label : (m,) int array

    Returns
    -------
    (m,) int array

    Examples
    --------
    >>> spread(np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), np.array([-1, 7, 7, -1])).tolist()
    [7, 7, 7, 7]
    """
    label = label.copy()
    start, end = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    # every edge stands twice in a closed surface: sorting brings its two triangles together
    order = np.lexsort((np.maximum(start, end), np.minimum(start, end)))
    one, other = order[0::2] // 3, order[1::2] // 3
    while (label < 0).any():
        known = label.copy()
        for a, b in ((one, other), (other, one)):
            take = (known[a] < 0) & (label[b] >= 0)
            known[a[take]] = label[b[take]]
        if (known == label).all():
            raise ValueError("a piece of the surface has no label anywhere")
        label = known
    return label
