"""Move single vertices where a solver would find fault with the cells around them.

fTetWild's energy knows the shape of a tetrahedron, not the angle between a face and the line that joins the two
cells beside it, nor how far that line passes from the face's middle. These two, non-orthogonality and skewness,
decide what a finite-volume solver makes of a mesh. A few faces in ten thousand break the usual limits; moving the
vertices around just those costs a small share of one more pass over the whole mesh.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

import numpy as np

from pipeline.geometry.adjacency import cells_at_vertices
from pipeline.geometry.compiled import compiled, compiled_for_threads
from pipeline.geometry.tets import FACES, Cells
from pipeline.geometry.threads import in_parts
from pipeline.geometry.triangles import area_vectors, vertex_sums
from pipeline.geometry.vectors import Vector, cross, dot, minus, symmetric_determinant
from pipeline.mesh.working_mesh import INTERFACE, WorkingMesh
from pipeline.nouns.arrays import Bools, Floats, Ints

_AIM_ANGLE = math.radians(68.0)  # under the usual limit of 70 degrees, by what rounding and neighbors may cost
_AIM_SKEWNESS = 3.5  # under the usual limit of 4
_AIM_WEIGHT = 0.06  # above the usual limit of 0.05; for tetrahedra it bounds their volume ratio too
_AIM_DETERMINANT = 2e-3  # above the usual limit of 1e-3
_EASE = 0.95  # fault from which a face counts: a mended face must not push its neighbor over the aim
_HOPELESS = 1e5  # fault of a face whose cells lie on the same side of it; worse than any finite fault in use
_THINNEST = 1e-5  # least volume of a cell, over a sixth of the cube of an edge
_TRIALS = 40  # places tried per vertex and sweep
_SWEEPS = 20  # the last of them move next to nothing
_FLAT = 0.9  # length of the summed area vectors at a vertex over the summed areas
_FEW = 8  # groups of vertices that are worth a thread
_LARGEST_STEP = 0.35  # of the mean edge length at the vertex


@compiled
def _corner(points: Floats, tets: Cells, cell: int, k: int) -> Vector:
    vertex = tets[cell, k]
    return (points[vertex, 0], points[vertex, 1], points[vertex, 2])


@compiled
def _center(points: Floats, tets: Cells, cell: int) -> Vector:
    x = y = z = 0.0
    for k in range(4):
        vertex = tets[cell, k]
        x += points[vertex, 0]
        y += points[vertex, 1]
        z += points[vertex, 2]
    return (0.25 * x, 0.25 * y, 0.25 * z)


@compiled
def _fault(points: Floats, tets: Cells, across: Cells, cell: int, side: int) -> float:
    """How far the face of a cell is beyond what is aimed at; 1 is the aim, above it is a fault."""
    other = across[cell, side]
    if other < 0:
        return 0.0
    center = _center(points, tets, cell)
    line = minus(_center(points, tets, other), center)
    a = _corner(points, tets, cell, FACES[side, 0])
    b = _corner(points, tets, cell, FACES[side, 1])
    c = _corner(points, tets, cell, FACES[side, 2])
    normal = cross(minus(b, a), minus(c, a))
    area = math.sqrt(dot(normal, normal))
    along = dot(normal, line)  # times the area, as the heights below
    if area == 0.0 or along <= 0.0:
        return _HOPELESS
    sideways = cross(normal, line)
    angle = math.atan2(math.sqrt(dot(sideways, sideways)), along)
    middle = ((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0)
    inward = minus(middle, center)
    height = dot(normal, inward)
    share = height / along
    if share <= 0.0 or share >= 1.0:
        return _HOPELESS
    aside = (inward[0] - share * line[0], inward[1] - share * line[1], inward[2] - share * line[2])
    skew = math.sqrt(dot(aside, aside))
    reach = 0.2 * math.sqrt(dot(line, line))
    if skew > 0.0:
        for corner in (a, b, c):
            reach = max(reach, abs(dot(aside, minus(corner, middle))) / skew)
    weight = min(share, 1.0 - share)
    return float(max(angle / _AIM_ANGLE, skew / reach / _AIM_SKEWNESS, _AIM_WEIGHT / weight))


@compiled
def _flatness(points: Floats, tets: Cells, cell: int) -> float:
    """0 for a cell of at least the least volume, else above every fault, and the more the worse it is inverted."""
    a = _corner(points, tets, cell, 0)
    b = minus(_corner(points, tets, cell, 1), a)
    c = minus(_corner(points, tets, cell, 2), a)
    d = minus(_corner(points, tets, cell, 3), a)
    # by its own size: the cells at a thin fiber are ten thousand times smaller than those at a thick one
    longest = max(dot(b, b), dot(c, c), dot(d, d))
    volume = dot(cross(b, c), d)
    least = _THINNEST * longest * math.sqrt(longest)
    return 0.0 if volume >= least else 10.0 * _HOPELESS * (2.0 - volume / max(least, 1e-300))


@compiled
def _indeterminacy(points: Floats, tets: Cells, across: Cells, cell: int) -> float:
    """Fault of a cell whose inner faces are too nearly parallel to carry a gradient; 1 is the aim."""
    inner = 0
    total = 0.0
    xx = xy = xz = yy = yz = zz = 0.0
    for side in range(4):
        if INTERFACE <= across[cell, side] < 0:
            continue
        a = _corner(points, tets, cell, FACES[side, 0])
        b = minus(_corner(points, tets, cell, FACES[side, 1]), a)
        x, y, z = cross(b, minus(_corner(points, tets, cell, FACES[side, 2]), a))
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
    determinant = abs(symmetric_determinant(xx, xy, xz, yy, yz, zz)) / 8.0
    return min(_HOPELESS, math.sqrt(_AIM_DETERMINANT / max(determinant, 1e-30)))


@compiled
def _cost_around(
    points: Floats, tets: Cells, across: Cells, first: Ints, cells: Cells, vertex: int, stop: float
) -> float:
    """Sum of squared excess faults of the cells at a vertex and of their faces; given up on reaching `stop`."""
    cost = 0.0
    for k in range(first[vertex], first[vertex + 1]):
        cell = cells[k]
        cost += max(0.0, _flatness(points, tets, cell) - _EASE) ** 2
        cost += max(0.0, _indeterminacy(points, tets, across, cell) - _EASE) ** 2
        if cost >= stop:
            return cost
        for side in range(4):
            # a face at the vertex belongs to two of its cells, and counts for both: its fault is looked for once
            weight = 1.0
            if tets[cell, 3 - side] != vertex:
                if across[cell, side] < cell:
                    continue
                weight = 2.0
            cost += weight * max(0.0, _fault(points, tets, across, cell, side) - _EASE) ** 2
            if cost >= stop:
                return cost
    return cost


@compiled
def _worst(points: Floats, tets: Cells, across: Cells, cell: int) -> float:
    """Give the flatness of a cell, or the worst fault of it and its faces."""
    worst = max(_flatness(points, tets, cell), _indeterminacy(points, tets, across, cell))
    for side in range(4):
        worst = max(worst, _fault(points, tets, across, cell, side))
    return worst


@compiled_for_threads
def _measure(points: Floats, tets: Cells, across: Cells, which: Ints, found: Floats, begin: int, end: int) -> None:
    for n in range(begin, end):
        found[n] = _worst(points, tets, across, which[n])


@compiled_for_threads
def _measure_all(points: Floats, tets: Cells, across: Cells, found: Bools, begin: int, end: int) -> None:
    for cell in range(begin, end):
        found[cell] = _worst(points, tets, across, cell) > 1.0


def faulty_cells(mesh: WorkingMesh, which: Ints | None = None) -> Bools:
    """Tell which cells are beyond what is aimed at, by themselves or by a face.

    Parameters
    ----------
    mesh : WorkingMesh
    which : (k,) int array, optional
        Cells to look at, all unless given.

    Returns
    -------
    (m,) or (k,) bool array
    """
    if which is None:
        found = np.zeros(mesh.cells, np.bool_)
        in_parts(lambda begin, end: _measure_all(mesh.points, mesh.tets, mesh.across, found, begin, end), mesh.cells)
        return found
    return np.asarray(faults(mesh, which) > 1.0)


def faults(mesh: WorkingMesh, which: Ints) -> Floats:
    """How far some cells are beyond what is aimed at, by themselves or by a face; above 1 a cell is faulty.

    Parameters
    ----------
    mesh : WorkingMesh
    which : (k,) int array

    Returns
    -------
    (k,) array
    """
    found = np.zeros(len(which))
    in_parts(lambda begin, end: _measure(mesh.points, mesh.tets, mesh.across, which, found, begin, end), len(which))
    return found


@compiled_for_threads
def _move(
    points: Floats,
    tets: Cells,
    across: Cells,
    first: Ints,
    cells: Cells,
    vertices: Ints,
    homes: Floats,
    bounds: Floats,
    directions: Floats,
    limits: Floats,
    moved: Bools,
    begin: int,
    end: int,
) -> None:
    """Move some vertices one by one, and tell which moved.

    A row of `homes` is where the vertex was at first; of `bounds`, along which axes it may move, the normal of its
    wall (0 where it has none), how far off and how far along the wall it may move in all.
    """
    at = np.empty(3)
    step = np.empty(3)
    for number in range(begin, end):
        vertex = vertices[number]
        free, normal = bounds[number, :3], bounds[number, 3:6]
        off, along = bounds[number, 6], bounds[number, 7]
        if off == 0.0 or max(free[0], free[1], free[2]) == 0.0:
            continue
        best = _cost_around(points, tets, across, first, cells, vertex, math.inf)
        if best == 0.0:
            continue
        at[0], at[1], at[2] = points[vertex, 0], points[vertex, 1], points[vertex, 2]
        length, count = 0.0, 0
        for k in range(first[vertex], first[vertex + 1]):
            for j in range(4):
                other = tets[cells[k], j]
                length += math.sqrt(
                    (points[other, 0] - at[0]) ** 2 + (points[other, 1] - at[1]) ** 2 + (points[other, 2] - at[2]) ** 2
                )
                count += 1
        reach = min(_LARGEST_STEP * length / (0.75 * count), max(off, along))
        on_wall = normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2 > 0.0
        for trial in range(len(directions)):
            for axis in range(3):
                step[axis] = free[axis] * directions[trial, axis]
            if on_wall and trial % 4 < 3:
                across_wall = step[0] * normal[0] + step[1] * normal[1] + step[2] * normal[2]
                for axis in range(3):
                    step[axis] = free[axis] * (step[axis] - across_wall * normal[axis])
            far = False
            square, height = 0.0, 0.0
            for axis in range(3):
                place = at[axis] + reach * step[axis]
                points[vertex, axis] = place
                far |= place < limits[0, axis] or place > limits[1, axis]
                stray = place - homes[number, axis]
                square += stray**2
                height += stray * normal[axis]
            # along the wall a vertex of a fiber may slide, since it stays on the fiber
            far |= abs(height) > off
            far |= square - height**2 > along**2 if on_wall else square > off**2
            if far:
                continue
            cost = _cost_around(points, tets, across, first, cells, vertex, best)
            if cost < best:
                best = cost
                at[0], at[1], at[2] = points[vertex, 0], points[vertex, 1], points[vertex, 2]
                moved[number] = True
            elif trial % 8 == 7:
                reach *= 0.6
        points[vertex, 0], points[vertex, 1], points[vertex, 2] = at[0], at[1], at[2]


def smoothed(mesh: WorkingMesh, loose: Ints, sweeps: int = _SWEEPS, seed: int = 0) -> tuple[WorkingMesh, Bools]:
    """Move vertices until no face is beyond the aim, or no move helps any more.

    Parameters
    ----------
    mesh : WorkingMesh
    loose : (k,) int array
        Vertices of walls that are no fiber's: they may move off the wall as far as along it.
    sweeps : int
        Most rounds over the vertices around faulty faces.
    seed : int
        Of the directions tried.

    Returns
    -------
    WorkingMesh
        Cells that were inverted are turned right where a move of their vertices can do it.
    faulty : (m,) bool array
        Cells that are still flat, or beyond the aim by themselves or by a face.
    """
    faulty = faulty_cells(mesh)
    if not faulty.any():
        return mesh, faulty
    result = mesh.moved(np.array(mesh.points))
    first, cells = cells_at_vertices(mesh.tets, len(mesh.points))
    normals, off, along = _bounds(mesh, loose)
    limits = np.stack(mesh.freedom.limits)
    rng = np.random.default_rng(seed)
    for _ in range(sweeps):
        directions = rng.standard_normal((_TRIALS, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        vertices, starts = _apart(mesh, first, cells, np.unique(mesh.tets[faulty]))
        free = mesh.freedom.free_axes(mesh.planes[vertices])
        bounds = np.column_stack([free, normals[vertices], off[vertices], along[vertices]])
        moved = np.zeros(len(vertices), np.bool_)
        _move_all(result, first, cells, vertices, starts, mesh.points[vertices], bounds, directions, limits, moved)
        if not moved.any():
            break
        changed = _around(mesh.across, first, cells, vertices[moved])
        faulty[changed] = faulty_cells(result, changed)
    return result, faulty


def _move_all(
    mesh: WorkingMesh, first: Ints, cells: Cells, vertices: Ints, starts: Ints, homes: Floats, bounds: Floats,
    directions: Floats, limits: Floats, moved: Bools,
) -> None:  # fmt: skip
    in_parts(
        lambda begin, end: _move(
            mesh.points, mesh.tets, mesh.across, first, cells, vertices, homes, bounds, directions, limits, moved,
            starts[begin], starts[end],
        ),
        len(starts) - 1,
        _FEW,
    )  # fmt: skip


def _bounds(mesh: WorkingMesh, loose: Ints) -> tuple[Floats, Floats, Floats]:
    """Give each vertex the normal of its wall (0 where it has none), and how far it may move off it and along it."""
    walls = mesh.walls()
    off, along = np.full(len(mesh.points), np.inf), np.zeros(len(mesh.points))
    on_wall = np.unique(walls)
    off[on_wall], along[on_wall] = mesh.freedom.off_and_along(mesh.points[on_wall])
    # where a crevice was filled the wall is no fiber's: its vertices may move
    loose = np.intersect1d(loose, on_wall)
    off[loose] = np.maximum(along[loose], off[loose])
    off[mesh.held_vertices()] = 0.0
    return wall_normals(mesh.points, walls), off, along


def wall_normals(points: Floats, walls: Ints) -> Floats:
    """Give the unit normal at each vertex where the wall is nearly flat, else 0.

    Parameters
    ----------
    points : (n, 3) array [m]
    walls : (b, 3) int array

    Returns
    -------
    (n, 3) array
    """
    vectors = area_vectors(points, walls)
    areas = np.linalg.norm(vectors, axis=1)
    normals = vertex_sums(walls, vectors, len(points))
    total = np.bincount(walls.ravel(), np.repeat(areas, 3), len(points))
    length = np.linalg.norm(normals, axis=1)
    # where fibers meet, or a wall ends at a plane of the duct, no direction is along it
    flat = (length > _FLAT * total) & (total > 0.0)
    return np.where(flat[:, None], normals / np.where(flat, length, 1.0)[:, None], 0.0)


@compiled
def _around(across: Cells, first: Ints, cells: Cells, vertices: Ints) -> Ints:
    """Cells at some vertices and those behind their faces, ascending."""
    chosen = np.zeros(len(across), np.bool_)
    for vertex in vertices:
        for k in range(first[vertex], first[vertex + 1]):
            chosen[cells[k]] = True
            for side in range(4):
                if across[cells[k], side] >= 0:
                    chosen[across[cells[k], side]] = True
    return np.flatnonzero(chosen)


@compiled
def _root(parent: Ints, n: int) -> int:
    while parent[n] != n:
        parent[n] = parent[parent[n]]
        n = parent[n]
    return n


@compiled
def _groups(across: Cells, first: Ints, cells: Cells, vertices: Ints) -> Ints:
    """Group of each vertex: what one does about its cells does not matter to a vertex of another group."""
    parent = np.arange(len(vertices))
    owner = np.full(len(across), -1, np.int32)
    for n in range(len(vertices)):
        for k in range(first[vertices[n]], first[vertices[n] + 1]):
            for side in range(-1, 4):
                cell = cells[k] if side < 0 else across[cells[k], side]
                if cell < 0:
                    continue
                if owner[cell] >= 0:
                    one, other = _root(parent, owner[cell]), _root(parent, n)
                    parent[max(one, other)] = min(one, other)
                owner[cell] = n
    for n in range(len(vertices)):
        parent[n] = _root(parent, n)
    return parent


def _apart(mesh: WorkingMesh, first: Ints, cells: Cells, vertices: Ints) -> tuple[Ints, Ints]:
    """Sort vertices into groups that can move at the same time: vertices, and the first of each group and the end."""
    group = _groups(mesh.across, first, cells, vertices)
    order = np.argsort(group, kind="stable")
    starts = np.flatnonzero(np.diff(group[order], prepend=-1, append=len(vertices)))
    return vertices[order], starts
