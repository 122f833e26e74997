"""Move single vertices where a solver would find fault with the cells around them.

fTetWild's energy knows the shape of a tetrahedron, not the angle between a face and the line that joins the two
cells beside it, nor how far that line passes from the face's middle. These two, non-orthogonality and skewness,
decide what a finite-volume solver makes of a mesh. A few faces in ten thousand break the usual limits; moving the
vertices around just those costs a small share of one more pass over the whole mesh.
"""

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from pipeline.data import Floats, Ints
from pipeline.geometry.adjacency import cells_at_vertices, neighbors
from pipeline.geometry.tets import FACES, volumes

_AIM_ANGLE = math.radians(68.0)  # under the usual limit of 70 degrees, by what rounding and neighbors may cost
_AIM_SKEWNESS = 3.5  # under the usual limit of 4
_AIM_WEIGHT = 0.06  # above the usual limit of 0.05; for tetrahedra it bounds their volume ratio too
_AIM_DETERMINANT = 2e-3  # above the usual limit of 1e-3
_EASE = 0.95  # fault from which a face counts: a mended face must not push its neighbor over the aim
_HOPELESS = 1e5  # fault of a face whose cells lie on the same side of it; worse than any finite fault in use
_SMALLEST = 1e-5  # least volume of a cell, in medians
_TRIALS = 40  # places tried per vertex and sweep
_LARGEST_STEP = 0.35  # of the mean edge length at the vertex


@njit(cache=True)  # type: ignore[untyped-decorator]
def _fault(points: Floats, tets: Ints, across: Ints, cell: int, side: int) -> float:
    """How far the face of a cell is beyond what is aimed at; 1 is the aim, above it is a fault."""
    other = across[cell, side]
    if other < 0:
        return 0.0
    center = np.zeros(3)
    beyond = np.zeros(3)
    for k in range(4):
        center += 0.25 * points[tets[cell, k]]
        beyond += 0.25 * points[tets[other, k]]
    a = points[tets[cell, FACES[side, 0]]]
    b = points[tets[cell, FACES[side, 1]]]
    c = points[tets[cell, FACES[side, 2]]]
    normal = np.cross(b - a, c - a)
    area = math.sqrt(normal @ normal)
    if area == 0.0:
        return _HOPELESS
    normal /= area
    line = beyond - center
    distance = math.sqrt(line @ line)
    along = normal @ line
    if along <= 0.0 or distance == 0.0:
        return _HOPELESS
    across_line = np.cross(normal, line)
    angle = math.atan2(math.sqrt(across_line @ across_line), along)
    middle = (a + b + c) / 3.0
    inward = middle - center
    height = normal @ inward
    aside = inward - (height / along) * line
    skew = math.sqrt(aside @ aside)
    reach = 0.2 * distance
    if skew > 0.0:
        for corner in (a, b, c):
            reach = max(reach, abs((aside @ (corner - middle)) / skew))
    weight = min(height, along - height) / along
    worst = max(angle / _AIM_ANGLE, skew / reach / _AIM_SKEWNESS)
    return max(worst, _AIM_WEIGHT / weight) if weight > 0.0 else _HOPELESS


@njit(cache=True)  # type: ignore[untyped-decorator]
def _flatness(points: Floats, tets: Ints, cell: int, smallest: float) -> float:
    """0 for a cell of at least the smallest volume, else above every fault, and the more the worse it is inverted."""
    a = points[tets[cell, 0]]
    volume = np.cross(points[tets[cell, 1]] - a, points[tets[cell, 2]] - a) @ (points[tets[cell, 3]] - a)
    return 0.0 if volume >= smallest else 1e6 * (2.0 - volume / smallest)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _indeterminacy(points: Floats, tets: Ints, across: Ints, cell: int) -> float:
    """Fault of a cell whose inner faces are too nearly parallel to carry a gradient; 1 is the aim."""
    inner = 0
    total = 0.0
    tensor = np.zeros((3, 3))
    for side in range(4):
        if across[cell, side] < 0:
            continue
        a = points[tets[cell, FACES[side, 0]]]
        normal = 0.5 * np.cross(points[tets[cell, FACES[side, 1]]] - a, points[tets[cell, FACES[side, 2]]] - a)
        inner += 1
        total += math.sqrt(normal @ normal)
        for i in range(3):
            for j in range(3):
                tensor[i, j] += normal[i] * normal[j]
    if inner < 3 or total == 0.0:
        return 0.0  # no move of a vertex can help: `corners` splits such cells
    determinant = abs(
        tensor[0, 0] * (tensor[1, 1] * tensor[2, 2] - tensor[1, 2] * tensor[2, 1])
        - tensor[0, 1] * (tensor[1, 0] * tensor[2, 2] - tensor[1, 2] * tensor[2, 0])
        + tensor[0, 2] * (tensor[1, 0] * tensor[2, 1] - tensor[1, 1] * tensor[2, 0])
    ) / (8.0 * (total / inner) ** 6)
    return min(_HOPELESS, math.sqrt(_AIM_DETERMINANT / max(determinant, 1e-30)))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _cost_around(
    points: Floats, tets: Ints, across: Ints, first: Ints, cells: Ints, vertex: int, smallest: float, stop: float
) -> float:
    """Sum of squared excess faults of the cells at a vertex and of their faces; given up on reaching `stop`."""
    cost = 0.0
    for k in range(first[vertex], first[vertex + 1]):
        cost += max(0.0, _flatness(points, tets, cells[k], smallest) - _EASE) ** 2
        cost += max(0.0, _indeterminacy(points, tets, across, cells[k]) - _EASE) ** 2
        for side in range(4):
            cost += max(0.0, _fault(points, tets, across, cells[k], side) - _EASE) ** 2
            if cost >= stop:
                break
    return float(cost)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _faults(points: Floats, tets: Ints, across: Ints, smallest: float) -> Floats:
    """Per cell, its flatness or the worst fault of its faces."""
    fault = np.zeros(len(tets))
    for cell in range(len(tets)):
        fault[cell] = max(_flatness(points, tets, cell, smallest), _indeterminacy(points, tets, across, cell))
        for side in range(4):
            fault[cell] = max(fault[cell], _fault(points, tets, across, cell, side))
    return fault


@njit(cache=True)  # type: ignore[untyped-decorator]
def _move(
    points: Floats,
    tets: Ints,
    across: Ints,
    first: Ints,
    cells: Ints,
    vertices: Ints,
    homes: Floats,
    leash: Floats,
    free: Floats,
    directions: Floats,
    smallest: float,
) -> int:
    moved = 0
    for vertex in vertices:
        if leash[vertex] == 0.0 or free[vertex].max() == 0.0:
            continue
        best = _cost_around(points, tets, across, first, cells, vertex, smallest, math.inf)
        place = points[vertex].copy()
        length, count = 0.0, 0
        for k in range(first[vertex], first[vertex + 1]):
            for j in range(4):
                edge = points[tets[cells[k], j]] - place
                length += math.sqrt(edge @ edge)
                count += 1
        reach = min(_LARGEST_STEP * length / (0.75 * count), leash[vertex])
        better = False
        for trial in range(len(directions)):
            points[vertex] = place + reach * free[vertex] * directions[trial]
            stray = points[vertex] - homes[vertex]
            if stray @ stray > leash[vertex] ** 2:
                continue
            cost = _cost_around(points, tets, across, first, cells, vertex, smallest, best)
            if cost < best:
                best = cost
                place = points[vertex].copy()
                better = True
            elif trial % 8 == 7:
                reach *= 0.6
        points[vertex] = place
        moved += better
    return moved


def mended(
    points: Floats, tets: Ints, free: Floats, leash: Floats, sweeps: int, seed: int = 0
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
    smallest = _SMALLEST * float(np.median(6.0 * volumes(result, tets)))
    homes = result.copy()
    faults = _faults(result, tets, across, smallest)
    for _ in range(sweeps):
        faulty = faults > 1.0
        if not faulty.any():
            break
        directions = rng.standard_normal((_TRIALS, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        vertices = np.unique(tets[faulty])
        if _move(result, tets, across, first, cells, vertices, homes, leash, free, directions, smallest) == 0:
            break
        faults = _faults(result, tets, across, smallest)
    return result, faults > 1.0
