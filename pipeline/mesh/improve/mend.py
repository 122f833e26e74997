"""Move single vertices where a solver would find fault with the cells around them.

fTetWild's energy knows the shape of a tetrahedron, not the angle between a face and the line that joins the two
cells beside it, nor how far that line passes from the face's middle. These two, non-orthogonality and skewness,
decide what a finite-volume solver makes of a mesh. A few faces in ten thousand break the usual limits; moving the
vertices around just those costs a small share of one more pass over the whole mesh.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np
import numpy.typing as npt

from pipeline.geometry.adjacency import cells_at_vertices, neighbors
from pipeline.geometry.compiled import compiled
from pipeline.geometry.tets import FACES
from pipeline.nouns.arrays import Floats, Ints

Vector = tuple[float, float, float]

_AIM_ANGLE = math.radians(68.0)  # under the usual limit of 70 degrees, by what rounding and neighbors may cost
_AIM_SKEWNESS = 3.5  # under the usual limit of 4
_AIM_WEIGHT = 0.06  # above the usual limit of 0.05; for tetrahedra it bounds their volume ratio too
_AIM_DETERMINANT = 2e-3  # above the usual limit of 1e-3
_EASE = 0.95  # fault from which a face counts: a mended face must not push its neighbor over the aim
_HOPELESS = 1e5  # fault of a face whose cells lie on the same side of it; worse than any finite fault in use
_THINNEST = 1e-5  # least volume of a cell, over a sixth of the cube of an edge
_TRIALS = 40  # places tried per vertex and sweep
_LARGEST_STEP = 0.35  # of the mean edge length at the vertex


@compiled
def _corner(points: Floats, tets: Ints, cell: int, k: int) -> Vector:
    vertex = tets[cell, k]
    return (points[vertex, 0], points[vertex, 1], points[vertex, 2])


@compiled
def _center(points: Floats, tets: Ints, cell: int) -> Vector:
    x = y = z = 0.0
    for k in range(4):
        vertex = tets[cell, k]
        x += points[vertex, 0]
        y += points[vertex, 1]
        z += points[vertex, 2]
    return (0.25 * x, 0.25 * y, 0.25 * z)


@compiled
def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@compiled
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@compiled
def _fault(points: Floats, tets: Ints, across: Ints, cell: int, side: int) -> float:
    """How far the face of a cell is beyond what is aimed at; 1 is the aim, above it is a fault."""
    other = across[cell, side]
    if other < 0:
        return 0.0
    center = _center(points, tets, cell)
    line = _minus(_center(points, tets, other), center)
    a = _corner(points, tets, cell, FACES[side, 0])
    b = _corner(points, tets, cell, FACES[side, 1])
    c = _corner(points, tets, cell, FACES[side, 2])
    normal = _cross(_minus(b, a), _minus(c, a))
    area = math.sqrt(_dot(normal, normal))
    along = _dot(normal, line)  # times the area, as the heights below
    if area == 0.0 or along <= 0.0:
        return _HOPELESS
    sideways = _cross(normal, line)
    angle = math.atan2(math.sqrt(_dot(sideways, sideways)), along)
    middle = ((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0)
    inward = _minus(middle, center)
    height = _dot(normal, inward)
    share = height / along
    if share <= 0.0 or share >= 1.0:
        return _HOPELESS
    aside = (inward[0] - share * line[0], inward[1] - share * line[1], inward[2] - share * line[2])
    skew = math.sqrt(_dot(aside, aside))
    reach = 0.2 * math.sqrt(_dot(line, line))
    if skew > 0.0:
        for corner in (a, b, c):
            reach = max(reach, abs(_dot(aside, _minus(corner, middle))) / skew)
    weight = min(share, 1.0 - share)
    return float(max(angle / _AIM_ANGLE, skew / reach / _AIM_SKEWNESS, _AIM_WEIGHT / weight))


@compiled
def _flatness(points: Floats, tets: Ints, cell: int) -> float:
    """0 for a cell of at least the least volume, else above every fault, and the more the worse it is inverted."""
    a = _corner(points, tets, cell, 0)
    b = _minus(_corner(points, tets, cell, 1), a)
    c = _minus(_corner(points, tets, cell, 2), a)
    d = _minus(_corner(points, tets, cell, 3), a)
    # by its own size: the cells at a thin fiber are ten thousand times smaller than those at a thick one
    longest = max(_dot(b, b), _dot(c, c), _dot(d, d))
    volume = _dot(_cross(b, c), d)
    least = _THINNEST * longest * math.sqrt(longest)
    return 0.0 if volume >= least else 10.0 * _HOPELESS * (2.0 - volume / max(least, 1e-300))


@compiled
def _indeterminacy(points: Floats, tets: Ints, across: Ints, cell: int) -> float:
    """Fault of a cell whose inner faces are too nearly parallel to carry a gradient; 1 is the aim."""
    inner = 0
    total = 0.0
    xx = xy = xz = yy = yz = zz = 0.0
    for side in range(4):
        if across[cell, side] < 0:
            continue
        a = _corner(points, tets, cell, FACES[side, 0])
        b = _minus(_corner(points, tets, cell, FACES[side, 1]), a)
        x, y, z = _cross(b, _minus(_corner(points, tets, cell, FACES[side, 2]), a))
        inner += 1
        total += math.sqrt(x * x + y * y + z * z)
        xx += x * x
        xy += x * y
        xz += x * z
        yy += y * y
        yz += y * z
        zz += z * z
    if inner < 3 or total == 0.0:
        return 0.0  # no move of a vertex can help: `corners` splits such cells
    size = (total / inner) ** 2
    xx, xy, xz, yy, yz, zz = xx / size, xy / size, xz / size, yy / size, yz / size, zz / size
    determinant = abs(xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)) / 8.0
    return min(_HOPELESS, math.sqrt(_AIM_DETERMINANT / max(determinant, 1e-30)))


@compiled
def _cost_around(points: Floats, tets: Ints, across: Ints, first: Ints, cells: Ints, vertex: int, stop: float) -> float:
    """Sum of squared excess faults of the cells at a vertex and of their faces; given up on reaching `stop`."""
    cost = 0.0
    for k in range(first[vertex], first[vertex + 1]):
        cost += max(0.0, _flatness(points, tets, cells[k]) - _EASE) ** 2
        cost += max(0.0, _indeterminacy(points, tets, across, cells[k]) - _EASE) ** 2
        for side in range(4):
            cost += max(0.0, _fault(points, tets, across, cells[k], side) - _EASE) ** 2
            if cost >= stop:
                break
    return float(cost)


@compiled
def _update(points: Floats, tets: Ints, across: Ints, which: Ints, faults: Floats) -> None:
    """Measure some cells again: the flatness of each, or the worst fault of it and its faces."""
    for cell in which:
        worst = max(_flatness(points, tets, cell), _indeterminacy(points, tets, across, cell))
        for side in range(4):
            worst = max(worst, _fault(points, tets, across, cell, side))
        faults[cell] = worst


@compiled
def _move(
    points: Floats,
    tets: Ints,
    across: Ints,
    first: Ints,
    cells: Ints,
    vertices: Ints,
    homes: Floats,
    leash: Floats,
    normals: Floats,
    slide: Floats,
    free: Floats,
    directions: Floats,
    low: Floats,
    high: Floats,
) -> Ints:
    """Move the vertices one by one; give those that moved."""
    moved = np.zeros(len(vertices), dtype=np.bool_)
    for number, vertex in enumerate(vertices):
        if leash[vertex] == 0.0 or free[vertex].max() == 0.0:
            continue
        best = _cost_around(points, tets, across, first, cells, vertex, math.inf)
        if best == 0.0:
            continue
        place = points[vertex].copy()
        length, count = 0.0, 0
        for k in range(first[vertex], first[vertex + 1]):
            for j in range(4):
                edge = points[tets[cells[k], j]] - place
                length += math.sqrt((edge**2).sum())
                count += 1
        reach = min(_LARGEST_STEP * length / (0.75 * count), max(leash[vertex], slide[vertex]))
        normal = normals[vertex]
        on_wall = (normal**2).sum() > 0.0
        for trial in range(len(directions)):
            step = free[vertex] * directions[trial]
            if on_wall and trial % 4 < 3:
                step = step - (step * normal).sum() * normal
                step *= free[vertex]
            points[vertex] = place + reach * step
            stray = points[vertex] - homes[vertex]
            off = (stray * normal).sum()
            # along the wall a vertex of a fiber may slide, since it stays on the fiber
            far = (stray**2).sum() - off**2 > slide[vertex] ** 2 if on_wall else (stray**2).sum() > leash[vertex] ** 2
            far = far or abs(off) > leash[vertex]
            if far or (points[vertex] < low).any() or (points[vertex] > high).any():
                continue
            cost = _cost_around(points, tets, across, first, cells, vertex, best)
            if cost < best:
                best = cost
                place = points[vertex].copy()
                moved[number] = True
            elif trial % 8 == 7:
                reach *= 0.6
        points[vertex] = place
    return vertices[moved]


def faults(points: Floats, tets: Ints, across: Ints, which: Ints | None = None) -> Floats:
    """How far each cell is beyond what is aimed at, by itself or by a face; above 1 it is faulty.

    Parameters
    ----------
    points : (n, 3) array
    tets, across : (m, 4) int arrays
        Tetrahedra, and the neighbor of each across each face, -1 on the boundary.
    which : (k,) int array, optional
        Cells to look at, all unless given.

    Returns
    -------
    (m,) or (k,) array
    """
    found = np.zeros(len(tets))
    if which is None:
        _update(points, tets, across, np.arange(len(tets)), found)
        return found
    _update(points, tets, across, which, found)
    return found[which]


def mended(
    points: Floats,
    tets: Ints,
    free: Floats,
    leash: Floats,
    sweeps: int,
    limits: tuple[Floats, Floats],
    normals: Floats | None = None,
    slide: Floats | None = None,
    seed: int = 0,
) -> tuple[Floats, npt.NDArray[np.bool_]]:
    """Move vertices until no face is beyond the aim, or no move helps any more.

    Parameters
    ----------
    points : (n, 3) array
    tets : (m, 4) int array
        Tetrahedra; their vertices stay the same ones.
    free : (n, 3) array of 0 and 1
        Along which axes each vertex may move: two on a plane of the duct, one on its edges, three elsewhere.
    leash : (n,) array
        How far each vertex may move in all: infinity inside, within the envelope on the fibers.
    sweeps : int
        Most rounds over the vertices around faulty faces.
    limits : tuple of two (3,) arrays
        Lowest and highest coordinates of the box that no vertex may leave.
    normals : (n, 3) array, optional
        Outward unit normal of the wall at each vertex that may slide along it, else 0.
    slide : (n,) array, optional
        How far such a vertex may move along its wall; its leash bounds how far off it.
    seed : int
        Of the directions tried.

    Returns
    -------
    points : (n, 3) array
        Cells that were inverted are turned right where a move of their vertices can do it.
    faulty : (m,) bool array
        Cells that are still flat, or beyond the aim by themselves or by a face.
    """
    result = np.array(points, dtype=np.float64)
    across = neighbors(tets)
    first, cells = cells_at_vertices(tets, len(points))
    rng = np.random.default_rng(seed)
    homes = result.copy()
    along = np.zeros_like(result) if normals is None else normals
    sliding = np.zeros(len(result)) if slide is None else slide
    found = np.zeros(len(tets))
    _update(result, tets, across, np.arange(len(tets)), found)
    for _ in range(sweeps):
        directions = rng.standard_normal((_TRIALS, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        vertices = np.unique(tets[found > 1.0])
        moved = _move(
            result,
            tets,
            across,
            first,
            cells,
            vertices,
            homes,
            leash,
            along,
            sliding,
            free,
            directions,
            *limits,
        )
        if len(moved) == 0:
            break
        touched = np.unique(np.concatenate([cells[first[vertex] : first[vertex + 1]] for vertex in moved]))
        beside = across[touched]
        _update(result, tets, across, np.union1d(touched, beside[beside >= 0]), found)
    return result, found > 1.0
