"""Products with the matrices of a flow, and smoothing: loops over compressed rows, three components at once.

Each takes the rows of one share, and writes to them alone. Compiled by numba: imported only where a flow is solved.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import numpy as np
import numpy.typing as npt

from pipeline.geometry.compiled import compiled_for_threads
from pipeline.nouns.arrays import Floats, Ints

Indices = npt.NDArray[np.int32]
Flags = npt.NDArray[np.uint8]
Blocks = npt.NDArray[np.float32]
Values = Floats | Blocks
_STRETCH = 2048  # entries of a vector that stay near the processor while others pass by


@compiled_for_threads
def times(first: int, end: int, start: Ints, column: Indices, values: Values, x: Floats, y: Floats) -> None:
    """Matrix of numbers times (n, 3) vectors, into y."""
    for row in range(first, end):
        a, b, c = 0.0, 0.0, 0.0
        for place in range(start[row], start[row + 1]):
            value, j = values[place], column[place]
            a += value * x[j, 0]
            b += value * x[j, 1]
            c += value * x[j, 2]
        y[row, 0], y[row, 1], y[row, 2] = a, b, c


@compiled_for_threads
def add_blocks(first: int, end: int, start: Ints, column: Indices, values: Blocks, x: Floats, y: Floats) -> None:
    """Matrix of (3, 3) blocks times (n, 3) vectors, added to y."""
    for row in range(first, end):
        a, b, c = 0.0, 0.0, 0.0
        for place in range(start[row], start[row + 1]):
            j = column[place]
            one, two, three = x[j, 0], x[j, 1], x[j, 2]
            a += values[place, 0, 0] * one + values[place, 0, 1] * two + values[place, 0, 2] * three
            b += values[place, 1, 0] * one + values[place, 1, 1] * two + values[place, 1, 2] * three
            c += values[place, 2, 0] * one + values[place, 2, 1] * two + values[place, 2, 2] * three
        y[row, 0] += a
        y[row, 1] += b
        y[row, 2] += c


@compiled_for_threads
def divergence(first: int, end: int, start: Ints, column: Indices, values: Floats, x: Floats, y: Floats) -> None:
    """Matrix of (k, 3) entries times an (n, 3) vector, into y of one number per row."""
    for row in range(first, end):
        total = 0.0
        for place in range(start[row], start[row + 1]):
            j = column[place]
            total += values[place, 0] * x[j, 0] + values[place, 1] * x[j, 1] + values[place, 2] * x[j, 2]
        y[row] = total


@compiled_for_threads
def add_gradient(first: int, end: int, start: Ints, row_of: Indices, values: Floats, p: Floats, y: Floats) -> None:
    """Add the transposed of `divergence`'s matrix, (k, 3) entries by its own rows, times p to y."""
    for row in range(first, end):
        a, b, c = 0.0, 0.0, 0.0
        for place in range(start[row], start[row + 1]):
            value = p[row_of[place]]
            a += values[place, 0] * value
            b += values[place, 1] * value
            c += values[place, 2] * value
        y[row, 0] += a
        y[row, 1] += b
        y[row, 2] += c


@compiled_for_threads
def products(first: int, end: int, basis: Floats, count: int, x: Floats, into: Floats) -> None:
    """Products of a share of a vector with that of each of `count` others."""
    for low in range(first, end, _STRETCH):
        high = min(low + _STRETCH, end)
        # four at a time: x is read once for them, and no sum waits for another
        for k in range(0, count - count % 4, 4):
            a, b, c, d = 0.0, 0.0, 0.0, 0.0
            for row in range(low, high):
                value = x[row]
                a += basis[k, row] * value
                b += basis[k + 1, row] * value
                c += basis[k + 2, row] * value
                d += basis[k + 3, row] * value
            into[k] += a
            into[k + 1] += b
            into[k + 2] += c
            into[k + 3] += d
        for k in range(count - count % 4, count):
            a = 0.0
            for row in range(low, high):
                a += basis[k, row] * x[row]
            into[k] += a


@compiled_for_threads
def add_weighted(first: int, end: int, basis: Floats, weights: Floats, x: Floats) -> None:
    """Add a share of vectors, each times its weight, to that of x."""
    for low in range(first, end, _STRETCH):
        high = min(low + _STRETCH, end)
        for k in range(len(weights)):
            weight = weights[k]
            for row in range(low, high):
                x[row] += weight * basis[k, row]


@compiled_for_threads
def sweep(
    first: int,
    end: int,
    start: Ints,
    column: Indices,
    values: Values,
    over: Values,
    fixed: Flags,
    right: Floats,
    before: Floats,
    x: Floats,
    backward: bool,
) -> None:
    """One Gauss-Seidel sweep of each component of a share's rows in place.

    `over` is one over the diagonal; what is fixed stays. Rows of the other shares change at the same time: what they
    were is in `before`.
    """
    for step in range(end - first):
        row = end - 1 - step if backward else first + step
        a, b, c = right[row, 0], right[row, 1], right[row, 2]
        for place in range(start[row], start[row + 1]):
            value, j = values[place], column[place]
            if first <= j < end:
                a -= value * x[j, 0]
                b -= value * x[j, 1]
                c -= value * x[j, 2]
            else:
                a -= value * before[j, 0]
                b -= value * before[j, 1]
                c -= value * before[j, 2]
        if not fixed[row, 0]:
            x[row, 0] += over[row] * a
        if not fixed[row, 1]:
            x[row, 1] += over[row] * b
        if not fixed[row, 2]:
            x[row, 2] += over[row] * c
