"""Vectors of three numbers inside compiled loops. Compiled by numba: imported only where loops run."""

# SPDX-License-Identifier: GPL-3.0-or-later

import math

from pipeline.geometry.compiled import compiled_for_threads
from pipeline.geometry.triangles import Floats

Vector = tuple[float, float, float]


@compiled_for_threads
def row(array: Floats, place: int) -> Vector:
    """Give a row of an (n, 3) array."""
    return (array[place, 0], array[place, 1], array[place, 2])


@compiled_for_threads
def minus(a: Vector, b: Vector) -> Vector:
    """Give a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@compiled_for_threads
def dot(a: Vector, b: Vector) -> float:
    """Give the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled_for_threads
def cross(a: Vector, b: Vector) -> Vector:
    """Give the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@compiled_for_threads
def symmetric_determinant(xx: float, xy: float, xz: float, yy: float, yz: float, zz: float) -> float:
    """Give the determinant of a symmetric matrix of three rows."""
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)


@compiled_for_threads
def length(a: Vector) -> float:
    """Give the Euclidean length."""
    return math.sqrt(dot(a, a))
