"""Which cubes the duct is cut into: each as small as the fibers near it ask for.

Cubes are named by their level and by whole numbers: a cube of level l has the edge 2^l of the smallest one, and its
lowest corner is 2^l times its *place*. Every cube that is split has a row in the table of its level; the cubes that
fill the box are the children that are not split themselves.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pipeline.geometry.compiled import compiled
from pipeline.geometry.cylinders import away, distance
from pipeline.geometry.fibers import Bools
from pipeline.geometry.triangles import Floats, Ints

_CHILDREN = np.array(list(np.ndindex(2, 2, 2)), dtype=np.int64)
_AROUND = np.array(list(np.ndindex(3, 3, 3)), dtype=np.int64) - 1


@dataclass(frozen=True, eq=False, slots=True)
class Octree:
    """Cubes that fill a box, neighbors (through corners too) differing by one level at the most.

    Parameters
    ----------
    counts : (3,) int array
        Smallest cubes along each axis.
    low : (n, 3) int array
        Lowest corner of each cube, in smallest cubes.
    level : (n,) int array
    """

    counts: Ints
    low: Ints
    level: Ints


@dataclass(frozen=True, eq=False, slots=True)
class Demand:
    """The size of cubes that each piece of a fiber asks for.

    Parameters
    ----------
    pieces, flat : (n, 8) and (n, 2) arrays
        As in `pipeline.geometry.cylinders`.
    fiber : (n,) int array
    edge : (n,) array
        Largest edge of a cube at the piece's surface.
    growth : float
        How much larger it may be per distance from the surface, at most `largest`.
    largest : float
    narrowest : float
        Share of a piece's edge that cubes may shrink to where the air between two fibers is narrow.
    """

    pieces: Floats
    flat: Bools
    fiber: Ints
    edge: Floats
    growth: float
    largest: float
    narrowest: float


@compiled
def _narrow(
    x: float,
    y: float,
    z: float,
    half: float,
    size: float,
    pieces: Floats,
    flat: Bools,
    fiber: Ints,
    edge: Floats,
    narrowest: float,
    share: float,
    near: Ints,
    box: Floats,
) -> bool:
    """Whether the air at a place is narrower than the cubes there, between two fibers or a fiber and a side."""
    one, first, other, second = 1e30, -1, 1e30, -1
    for k in near:
        found = distance(x, y, z, pieces, flat, k)
        if found < one:
            if first >= 0 and fiber[k] != fiber[first]:
                other, second = one, first
            one, first = found, k
        elif fiber[k] != fiber[first] and found < other:
            other, second = found, k
    if first < 0 or one < -half or one > half:
        return False  # no air, or no wall
    if size <= 1.001 * narrowest * edge[first]:
        return False
    nx, ny, nz = away(x, y, z, pieces, flat, first)
    if second >= 0 and size > 1.001 * narrowest * max(edge[first], edge[second]):
        mx, my, mz = away(x, y, z, pieces, flat, second)
        facing = -(nx * mx + ny * my + nz * mz)
        if one + other < share * size * facing:
            return True
    for axis in range(3):
        place = x if axis == 0 else y if axis == 1 else z
        normal = nx if axis == 0 else ny if axis == 1 else nz
        if one + place - box[0, axis] < -share * size * normal or one + box[1, axis] - place < share * size * normal:
            return True
    return False


@compiled
def _split(
    places: Ints,
    edge_of_cube: Floats,
    counts: Ints,
    width: int,
    may_stay: bool,
    first: Ints,
    near: Ints,
    pieces: Floats,
    flat: Bools,
    fiber: Ints,
    edge: Floats,
    growth: float,
    largest: float,
    narrowest: float,
    share: float,
) -> tuple[Bools, Ints, Ints]:
    """Tell which cubes of a level have to be split, and which pieces matter to each of those."""
    split = np.zeros(len(places), np.bool_)
    kept_first = np.zeros(len(places) + 1, np.int64)
    kept = np.empty(max(64, len(near)), np.int64)
    sizes = edge_of_cube * width
    size, half = sizes.max(), 0.5 * np.sqrt((sizes**2).sum())
    box = np.zeros((2, 3))
    box[1] = edge_of_cube * counts
    count = 0
    for n in range(len(places)):
        begin = count
        x = (places[n, 0] + 0.5) * sizes[0]
        y = (places[n, 1] + 0.5) * sizes[1]
        z = (places[n, 2] + 0.5) * sizes[2]
        inside = True
        for axis in range(3):
            inside &= (places[n, axis] + 1) * width <= counts[axis]
        solid = False
        wanted = not (inside and may_stay)
        unsure = False
        for m in range(first[n], first[n + 1]):
            k = near[m]
            away_from = distance(x, y, z, pieces, flat, k)
            solid |= away_from < -half - size
            apart = max(0.0, abs(away_from) - half)
            asked = min(largest, edge[k] + growth * apart)
            if size > 1.001 * min(largest, edge[k] + growth * abs(away_from)):
                wanted = True
            elif size > 1.001 * asked:
                unsure = True
            if asked < 0.999 * min(size, largest) or apart < 0.5 * edge[k]:
                kept[count] = k
                count += 1
        if solid:
            count = begin  # deep within a fiber
            wanted = not (inside and may_stay)
        elif not wanted:
            # the distance at eight places within the cube is nearer to that at its nearest place
            for c in range(8):
                cx = x + (0.25 if c & 4 else -0.25) * sizes[0]
                cy = y + (0.25 if c & 2 else -0.25) * sizes[1]
                cz = z + (0.25 if c & 1 else -0.25) * sizes[2]
                if unsure:
                    for k in kept[begin:count]:
                        apart = max(0.0, abs(distance(cx, cy, cz, pieces, flat, k)) - 0.5 * half)
                        wanted |= size > 1.001 * min(largest, edge[k] + growth * apart)
                if not wanted and narrowest < 1.0:
                    wanted = _narrow(
                        cx,
                        cy,
                        cz,
                        0.5 * half,
                        size,
                        pieces,
                        flat,
                        fiber,
                        edge,
                        narrowest,
                        share,
                        kept[begin:count],
                        box,
                    )
                if wanted:
                    break
        split[n] = wanted
        if not wanted:
            count = begin
        kept_first[n + 1] = count
    return split, kept_first, kept[:count].copy()


def octree(
    demand: Demand,
    counts: Ints,
    edge_of_cube: Floats,
    share: float,
    wrapped: Bools,
    refuse: Callable[[int], None],
    window: tuple[Ints, Ints] | None = None,
) -> Octree:
    """Split a box into cubes until each is as small as the fibers near it ask for.

    Parameters
    ----------
    demand : Demand
    counts : (3,) int array
        Smallest cubes along each axis.
    edge_of_cube : (3,) array
        Extent of the smallest cube along each axis.
    share : float
        Cubes are split where the air between walls that face each other is narrower than this many cubes.
    wrapped : (3,) bool array
        Axes along which the box repeats itself; its count is a multiple of the largest cube.
    refuse : callable
        Is told how many cubes there will be at least, as soon as that is known, and may raise an error.
    window : two (3,) int arrays, optional
        Lowest and highest corner, in smallest cubes, of the part of the box that is wanted: far outside of it the cubes
        are too large or missing, and twice the largest cube inside of it they are those of the whole box.

    Returns
    -------
    Octree
    """
    top = int(np.floor(np.log2(1.001 * demand.largest / edge_of_cube.max()))) if demand.largest else 0
    top = max(top, 0)
    level = max(int(np.ceil(np.log2(counts.max()))), top)
    places = np.zeros((1, 3), np.int64)
    first, near = np.array([0, len(demand.pieces)]), np.arange(len(demand.pieces))
    split: dict[int, Ints] = {}
    whole = 0
    while level > 0 and len(places):
        chosen, first, near = _split(
            places, edge_of_cube, counts, 1 << level, level <= top, first, near, demand.pieces, demand.flat,
            demand.fiber, demand.edge, demand.growth, demand.largest, demand.narrowest, share,
        )  # fmt: skip
        split[level] = places[chosen]
        whole += int((~chosen).sum())
        level -= 1
        places, parent = _children(split[level + 1], counts, level)
        if window is not None:
            meets = ((places << level < window[1]) & ((places + 1) << level > window[0])).all(axis=1)
            places, parent = places[meets], parent[meets]
        refuse(whole + len(places))
        rows = np.flatnonzero(chosen)[parent]
        first, near = _gathered(first, near, rows)
    low, level_of = _leaves(_balanced(split, counts, wrapped), counts)
    refuse(len(level_of))
    return Octree(counts, low, level_of)


@compiled
def _gathered(first: Ints, near: Ints, rows: Ints) -> tuple[Ints, Ints]:
    """Give the lists of some rows, one after the other."""
    result_first = np.zeros(len(rows) + 1, np.int64)
    for n in range(len(rows)):
        result_first[n + 1] = result_first[n] + first[rows[n] + 1] - first[rows[n]]
    result = np.empty(result_first[-1], np.int64)
    for n in range(len(rows)):
        result[result_first[n] : result_first[n + 1]] = near[first[rows[n]] : first[rows[n] + 1]]
    return result_first, result


def _children(places: Ints, counts: Ints, level: int) -> tuple[Ints, Ints]:
    """Children, of a level, of cubes above it that begin inside the box, and the row of each one's parent."""
    children = (2 * places[:, None, :] + _CHILDREN).reshape(-1, 3)
    inside = ((children << level) < counts).all(axis=1)
    return children[inside], np.repeat(np.arange(len(places)), 8)[inside]


def _balanced(split: dict[int, Ints], counts: Ints, wrapped: Bools) -> dict[int, Ints]:
    """Split more cubes until those that touch differ by one level at the most."""
    result: dict[int, Ints] = {}
    levels = sorted(split)
    for level in levels:
        result[level] = split[level]
        if level - 1 in result and len(result[level - 1]):
            # a split cube stands among cubes of its own size: their parents are split
            around = (result[level - 1][:, None, :] + _AROUND).reshape(-1, 3)
            beside = np.unique(_keys(_inside(around, counts, level - 1, wrapped), counts))
            parents = _places(beside, counts) >> 1
            result[level] = _places(np.unique(_keys(np.concatenate([parents, split[level]]), counts)), counts)
        result[level] = _mirrored(result[level], counts, level, wrapped)
    return result


def _mirrored(places: Ints, counts: Ints, level: int, wrapped: Bools) -> Ints:
    """Add to cubes at a side those at the opposite one, along axes that wrap."""
    for axis in np.flatnonzero(wrapped):
        last = (counts[axis] >> level) - 1
        added = [places]
        for here, there in ((0, last), (last, 0)):
            image = places[places[:, axis] == here].copy()
            image[:, axis] = there
            added.append(image)
        places = _places(np.unique(_keys(np.concatenate(added), counts)), counts) if last > 0 else places
    return places


def _inside(places: Ints, counts: Ints, level: int, wrapped: Bools) -> Ints:
    several = np.where(wrapped, counts >> level, np.int64(1) << 40)
    places = np.where(wrapped, places % np.maximum(several, 1), places)
    return places[((places >= 0) & ((places << level) < counts)).all(axis=1)]


def _keys(places: Ints, counts: Ints) -> Ints:
    keys: Ints = (places[:, 0] * (counts[1] + 1) + places[:, 1]) * (counts[2] + 1) + places[:, 2]
    return keys


def _places(keys: Ints, counts: Ints) -> Ints:
    rest, z = np.divmod(keys, counts[2] + 1)
    x, y = np.divmod(rest, counts[1] + 1)
    return np.stack([x, y, z], axis=1)


def _leaves(split: dict[int, Ints], counts: Ints) -> tuple[Ints, Ints]:
    low, level = [], []
    for above, places in split.items():
        children, _ = _children(places, counts, above - 1)
        whole = children
        if above - 1 in split and len(split[above - 1]):
            whole = children[~np.isin(_keys(children, counts), _keys(split[above - 1], counts))]
        low.append(whole << (above - 1))
        level.append(np.full(len(whole), above - 1))
    if not split:
        return np.zeros((1, 3), np.int64), np.zeros(1, np.int64)
    return np.concatenate(low), np.concatenate(level)
