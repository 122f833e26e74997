"""Matrices of Taylor-Hood elements on straight and curved tetrahedra.

Compiled by numba: imported only where a flow is solved.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import itertools
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled
from pipeline.nouns.arrays import Floats, Ints
from pipeline.nouns.flow_field import EDGES

Indices = npt.NDArray[np.int32]


def shape(places: Floats) -> tuple[Floats, Floats]:
    """Quadratic basis functions and their derivatives by the last three barycentric coordinates.

    Parameters
    ----------
    places : (q, 4) array
        Barycentric coordinates.

    Returns
    -------
    values : (q, 10) array
        Of the four vertices' and the six edges' functions.
    slopes : (q, 10, 3) array
    """
    by_place = np.array([[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    one, two = EDGES.T
    values = np.hstack([places * (2.0 * places - 1.0), 4.0 * places[:, one] * places[:, two]])
    corner = (4.0 * places - 1.0)[:, :, None] * by_place
    edge = 4.0 * (places[:, one, None] * by_place[two] + places[:, two, None] * by_place[one])
    return values, np.concatenate([corner, edge], axis=1)


def _orbit(*barycentric: float) -> Floats:
    return np.array(sorted(set(itertools.permutations(barycentric))))


def rule(curved: bool) -> tuple[Floats, Floats]:
    """Quadrature points, (q, 4) barycentric coordinates, and weights that sum to 1/6.

    Notes
    -----
    On straight cells the integrands are quadratic: the rule of 4 points is exact. On curved cells it is that of
    14 points and degree 5 (Walkington 2000).
    """
    if not curved:
        a = (5.0 - np.sqrt(5.0)) / 20.0
        return _orbit(1.0 - 3.0 * a, a, a, a), np.full(4, 1.0 / 24.0)
    a, b, c = 0.31088591926330060980, 0.092735250310891226402, 0.045503704125649649492
    weights = [0.018781320953002641800, 0.012248840519393658257, 0.0070910034628469110730]
    places = [_orbit(1 - 3 * a, a, a, a), _orbit(1 - 3 * b, b, b, b), _orbit(0.5 - c, 0.5 - c, c, c)]
    return np.concatenate(places), np.repeat(weights, [4, 4, 6])


@compiled
def _columns_of_rows(rows_of: Indices, columns_of: Indices, rows: int) -> tuple[Ints, Indices]:
    """Pattern of a matrix whose entries join the row numbers and the column numbers of each cell."""
    first = np.zeros(rows + 1, np.int64)
    cells, per_row = rows_of.shape
    per_column = columns_of.shape[1]
    for cell in range(cells):
        for k in range(per_row):
            first[rows_of[cell, k] + 1] += 1
    for row in range(rows):
        first[row + 1] += first[row]
    at = np.empty(first[rows], np.int32)
    filled = first[:-1].copy()
    for cell in range(cells):
        for k in range(per_row):
            at[filled[rows_of[cell, k]]] = cell
            filled[rows_of[cell, k]] += 1
    seen = np.full(columns_of.max() + 1, -1, np.int32)
    start = np.zeros(rows + 1, np.int64)
    for row in range(rows):
        count = 0
        for place in range(first[row], first[row + 1]):
            for k in range(per_column):
                column = columns_of[at[place], k]
                if seen[column] != row:
                    seen[column] = row
                    count += 1
        start[row + 1] = start[row] + count
    seen[:] = -1
    column_of = np.empty(start[rows], np.int32)
    for row in range(rows):
        fill = start[row]
        for place in range(first[row], first[row + 1]):
            for k in range(per_column):
                column = columns_of[at[place], k]
                if seen[column] != row:
                    seen[column] = row
                    column_of[fill] = column
                    fill += 1
        column_of[start[row] : fill] = np.sort(column_of[start[row] : fill])
    return start, column_of


@compiled
def _transposed(start: Ints, column_of: Indices, columns: int) -> tuple[Ints, Indices, Indices]:
    """Pattern by column: where each begins, the rows of its entries, and their places in the pattern by row."""
    first = np.zeros(columns + 1, np.int64)
    for column in column_of:
        first[column + 1] += 1
    for column in range(columns):
        first[column + 1] += first[column]
    row_of, place_of = np.empty(len(column_of), np.int32), np.empty(len(column_of), np.int32)
    filled = first[:-1].copy()
    for row in range(len(start) - 1):
        for place in range(start[row], start[row + 1]):
            at = filled[column_of[place]]
            row_of[at], place_of[at] = row, place
            filled[column_of[place]] += 1
    return first, row_of, place_of


@compiled
def place_of(start: Ints, column_of: Indices, row: int, column: int) -> int:
    """Place of an entry in the pattern of compressed rows; it has to be there."""
    low, high = int(start[row]), int(start[row + 1]) - 1
    while low < high:
        middle = (low + high) // 2
        if column_of[middle] < column:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def inverse_of(j: Floats, out: Floats) -> float:
    """Invert a (3, 3) array into `out`, and give its determinant."""
    out[0, 0] = j[1, 1] * j[2, 2] - j[1, 2] * j[2, 1]
    out[0, 1] = j[0, 2] * j[2, 1] - j[0, 1] * j[2, 2]
    out[0, 2] = j[0, 1] * j[1, 2] - j[0, 2] * j[1, 1]
    out[1, 0] = j[1, 2] * j[2, 0] - j[1, 0] * j[2, 2]
    out[1, 1] = j[0, 0] * j[2, 2] - j[0, 2] * j[2, 0]
    out[1, 2] = j[0, 2] * j[1, 0] - j[0, 0] * j[1, 2]
    out[2, 0] = j[1, 0] * j[2, 1] - j[1, 1] * j[2, 0]
    out[2, 1] = j[0, 1] * j[2, 0] - j[0, 0] * j[2, 1]
    out[2, 2] = j[0, 0] * j[1, 1] - j[0, 1] * j[1, 0]
    determinant = float(j[0, 0] * out[0, 0] + j[0, 1] * out[1, 0] + j[0, 2] * out[2, 0])
    for a in range(3):
        for b in range(3):
            out[a, b] /= determinant
    return determinant


@compiled
def _add_cells(
    which: Ints,
    positions: Floats,
    cells: Ints,
    unknown: Indices,
    places: Floats,
    weights: Floats,
    slopes: Floats,
    stiff_start: Ints,
    stiff_column: Indices,
    stiff: Floats,
    div_start: Ints,
    div_column: Indices,
    div: Floats,
    mass: Floats,
    vertex_start: Ints,
    vertex_column: Indices,
) -> None:
    """Add what each cell gives to the stiffness, the divergence and the pressure's mass."""
    jacobian, inverse = np.empty((3, 3)), np.empty((3, 3))
    slope = np.empty((10, 3))
    local, local_div, local_mass = np.empty((10, 10)), np.empty((4, 10, 3)), np.empty((4, 4))
    for cell in which:
        local[:], local_div[:], local_mass[:] = 0.0, 0.0, 0.0
        for q in range(len(weights)):
            jacobian[:] = 0.0
            for k in range(10):
                node = cells[cell, k]
                for a in range(3):
                    for b in range(3):
                        jacobian[a, b] += positions[node, a] * slopes[q, k, b]
            weight = weights[q] * inverse_of(jacobian, inverse)
            for k in range(10):
                for a in range(3):
                    slope[k, a] = (
                        slopes[q, k, 0] * inverse[0, a]
                        + slopes[q, k, 1] * inverse[1, a]
                        + slopes[q, k, 2] * inverse[2, a]
                    )
            for k in range(10):
                for m in range(k + 1):
                    local[k, m] += weight * (
                        slope[k, 0] * slope[m, 0] + slope[k, 1] * slope[m, 1] + slope[k, 2] * slope[m, 2]
                    )
            for v in range(4):
                by = weight * places[q, v]
                for k in range(10):
                    for a in range(3):
                        local_div[v, k, a] -= by * slope[k, a]
                for m in range(4):
                    local_mass[v, m] += by * places[q, m]
        for k in range(10):
            row = unknown[cell, k]
            for m in range(10):
                place = place_of(stiff_start, stiff_column, row, unknown[cell, m])
                stiff[place] += local[k, m] if m <= k else local[m, k]
        for v in range(4):
            row = unknown[cell, v]
            for k in range(10):
                place = place_of(div_start, div_column, row, unknown[cell, k])
                for a in range(3):
                    div[place, a] += local_div[v, k, a]
            for m in range(4):
                mass[place_of(vertex_start, vertex_column, row, unknown[cell, m])] += local_mass[v, m]


@compiled
def _add_straight(
    positions: Floats, cells: Ints, unknown: Indices, start: Ints, column: Indices, stiff: Floats
) -> None:
    """Add each cell's stiffness of linear elements."""
    jacobian, inverse = np.empty((3, 3)), np.empty((3, 3))
    slope = np.empty((4, 3))
    for cell in range(len(cells)):
        for k in range(3):
            for a in range(3):
                jacobian[a, k] = positions[cells[cell, k + 1], a] - positions[cells[cell, 0], a]
        volume = inverse_of(jacobian, inverse) / 6.0
        for a in range(3):
            slope[0, a] = -inverse[0, a] - inverse[1, a] - inverse[2, a]
            for k in range(3):
                slope[k + 1, a] = inverse[k, a]
        for v in range(4):
            for m in range(4):
                value = slope[v, 0] * slope[m, 0] + slope[v, 1] * slope[m, 1] + slope[v, 2] * slope[m, 2]
                stiff[place_of(start, column, unknown[cell, v], unknown[cell, m])] += volume * value


@dataclass(frozen=True, eq=False, slots=True)
class Matrices:
    """Compressed rows of the matrices of a mesh at viscosity 1; unknown numbers below `vertices` are the vertices'.

    Parameters
    ----------
    unknowns, vertices : int
        Nodes and vertices that are told apart, once opposite sides are one.
    start, column, stiff : arrays
        Of the gradient's product, for one component of the velocity.
    div_start, div_column, div : arrays
        Rows by vertex, columns by node, (k, 3) values: minus the divergence against the pressure's functions.
    grad_start, grad_row, grad_place : arrays
        The divergence's pattern by column: rows by node, their vertices, and the places of their entries in `div`.
    grad : (k, 3) array
        The divergence's values in that order, as they are read one behind the other.
    vertex_start, vertex_column, mass, linear : arrays
        Of the pressure's mass and of the stiffness of linear elements.
    """

    unknowns: int
    vertices: int
    start: Ints
    column: Indices
    stiff: Floats
    div_start: Ints
    div_column: Indices
    div: Floats
    grad_start: Ints
    grad_row: Indices
    grad_place: Indices
    grad: Floats
    vertex_start: Ints
    vertex_column: Indices
    mass: Floats
    linear: Floats


def assemble(positions: Floats, cells: Ints, unknown: Ints, curved: npt.NDArray[np.bool_]) -> Matrices:
    """Integrate the matrices over a mesh.

    Parameters
    ----------
    positions : (nodes, 3) array
    cells : (m, 10) int array
        Nodes of each tetrahedron.
    unknown : (m, 10) int array
        Number of the unknown at each of them; vertices' numbers come before edges'.
    curved : (m,) bool array
        Which tetrahedra have an edge whose middle is off its straight line.

    Returns
    -------
    Matrices
    """
    numbers = np.ascontiguousarray(unknown, np.int32)
    corners = np.ascontiguousarray(numbers[:, :4])
    unknowns, vertices = int(numbers.max()) + 1, int(corners.max()) + 1
    start, column = _columns_of_rows(numbers, numbers, unknowns)
    div_start, div_column = _columns_of_rows(corners, numbers, vertices)
    vertex_start, vertex_column = _columns_of_rows(corners, corners, vertices)
    stiff, div = np.zeros(len(column)), np.zeros((len(div_column), 3))
    mass, linear = np.zeros(len(vertex_column)), np.zeros(len(vertex_column))
    for bent in (False, True):
        places, weights = rule(bent)
        _add_cells(
            np.flatnonzero(curved == bent), positions, cells, numbers, places, weights, shape(places)[1],
            start, column, stiff, div_start, div_column, div, mass, vertex_start, vertex_column,
        )  # fmt: skip
    _add_straight(positions, cells, numbers, vertex_start, vertex_column, linear)
    grad_start, grad_row, grad_place = _transposed(div_start, div_column, unknowns)
    return Matrices(
        unknowns, vertices, start, column, stiff, div_start, div_column, div, grad_start, grad_row, grad_place,
        div[grad_place], vertex_start, vertex_column, mass, linear,
    )  # fmt: skip


def div_entries(matrices: Matrices, row: Ints, column: Ints, values: Floats) -> Floats:
    """Sum (k, 3) values at places of the divergence's pattern into an array of its entries."""
    rows = np.repeat(np.arange(matrices.vertices), np.diff(matrices.div_start))
    known = rows * matrices.unknowns + matrices.div_column
    found = np.zeros_like(matrices.div)
    np.add.at(found, np.searchsorted(known, row * matrices.unknowns + column), values)
    return found
