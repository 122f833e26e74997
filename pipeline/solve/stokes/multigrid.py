"""The preconditioner: quadratic to linear elements, then algebraic multigrid; and the diagonal of the pressure's mass.

Compiled by numba: imported only where a flow is solved.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pipeline.nouns.arrays import Floats, Ints
from pipeline.solve.stokes import sweeps
from pipeline.solve.stokes.conditions import Conditions
from pipeline.solve.stokes.elements import Matrices
from pipeline.solve.stokes.sharing import Team

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_SMALL = 200  # unknowns below which a level of multigrid is solved directly

_THICKER = 0.1
"""What the air is thickened by in a cycle with inertia, per Reynolds number: smoothing would not be stable without.

By trial on three rows of cylinders: a step takes 15, 27 and 51 iterations at Reynolds numbers of 10, 20 and 40; at half
of it the last takes 240, and at none those above 10 do not end.
"""


class VelocityCycle:
    """One V-cycle for the three components of a velocity.

    Edges' middles and vertices are smoothed by Gauss-Seidel; the rest is corrected on the vertices alone, where
    linear elements stand, by smoothed aggregation (pyamg). Forward before, backward after: symmetric without inertia.

    Parameters
    ----------
    matrices : Matrices
    ends : (e, 2) int array
        Unknowns of the vertices at both ends of the middle ``matrices.vertices + k``.
    conditions : Conditions
    team : Team
    carried : (k,) array, optional
        What inertia adds to the stiffness.
    reynolds : float
        With it.
    """

    def __init__(
        self,
        matrices: Matrices,
        ends: Ints,
        conditions: Conditions,
        team: Team,
        carried: npt.NDArray[np.float32] | None = None,
        reynolds: float = 0.0,
    ) -> None:
        from scipy.sparse import csr_array

        self.team, self.start, self.column = team, matrices.start, matrices.column
        values, linear = matrices.stiff, csr_array((matrices.linear, matrices.vertex_column, matrices.vertex_start))
        rise = csr_array(
            (np.full(2 * len(ends), 0.5), ends.ravel(), np.arange(0, 2 * len(ends) + 1, 2)),
            shape=(len(ends), matrices.vertices),
        )
        if conditions.rub is not None:
            values = values + _entries(conditions.rub, self.start, self.column)
            split = matrices.vertices
            rub = conditions.rub
            linear = linear + (
                rub[:split, :split] + rise.T @ rub[split:, :split] + rub[:split, split:] @ rise
                + rise.T @ rub[split:, split:] @ rise
            )  # fmt: skip
        if carried is not None:
            thicker, split = 1.0 + _THICKER * reynolds, matrices.vertices
            inertia = csr_array((carried.astype(np.float64), self.column, self.start))
            values = thicker * values + carried
            linear = thicker * linear + (
                inertia[:split, :split] + rise.T @ inertia[split:, :split] + inertia[:split, split:] @ rise
                + rise.T @ inertia[split:, split:] @ rise
            )  # fmt: skip
        # half the memory to read, in what need not be exact
        self.values = values.astype(np.float32)
        row = np.repeat(np.arange(matrices.unknowns), np.diff(self.start))
        self.over = 1.0 / values[row == self.column]
        self.fixed = conditions.fixed
        self.rise, self.fall = rise, rise.T.tocsr()
        self.vertices = matrices.vertices
        self.coarse: list[tuple[Ints, Callable[[Floats], Floats]]] = []
        for axis in range(3):
            free = np.flatnonzero(self.fixed[: self.vertices, axis] == 0)
            self.coarse.append((free, _aggregated(linear[free][:, free], carried is None)))

    def __call__(self, residual: Floats) -> Floats:
        """Give about the velocity, (unknowns, 3) array, that has this residual."""
        change = np.zeros_like(residual)
        rest = np.empty_like(residual)
        self._smooth(residual, change, False)
        self.team.over(0, len(rest), sweeps.times, self.start, self.column, self.values, change, rest)
        np.subtract(residual, rest, out=rest)
        rest[self.fixed != 0] = 0.0
        low = rest[: self.vertices] + self.fall @ rest[self.vertices :]
        found = np.zeros_like(low)
        for axis, (free, cycle) in enumerate(self.coarse):
            found[free, axis] = cycle(np.ascontiguousarray(low[free, axis]))
        change[: self.vertices] += found
        rise = self.rise @ found
        rise[self.fixed[self.vertices :] != 0] = 0.0
        change[self.vertices :] += rise
        self._smooth(residual, change, True)
        return change

    def _smooth(self, residual: Floats, change: Floats, backward: bool) -> None:
        """Sweep over the vertices, then over the edges' middles, or the other way round: shares of each at a time."""
        kinds = ((0, self.vertices), (self.vertices, len(change)))
        for kind in reversed(kinds) if backward else kinds:
            self.team.over(
                *kind, sweeps.sweep, self.start, self.column, self.values, self.over, self.fixed, residual,
                change.copy(), change, backward,
            )  # fmt: skip


def _aggregated(matrix: "csr_array", symmetric: bool) -> Callable[[Floats], Floats]:
    """Smoothed aggregation of a matrix: a function that gives about the solution."""
    import pyamg
    from scipy.sparse import csr_matrix

    # it draws the vectors from which it estimates eigenvalues: equal flows need equal ones
    drawn = np.random.get_state()  # noqa: NPY002
    np.random.seed(0)  # noqa: NPY002
    try:
        levels = pyamg.smoothed_aggregation_solver(
            csr_matrix(matrix),
            max_coarse=_SMALL,
            strength=("symmetric", {"theta": 0.0}),
            symmetry="hermitian" if symmetric else "nonsymmetric",
        )
    finally:
        np.random.set_state(drawn)  # noqa: NPY002
    cycle: Callable[[Floats], Floats] = levels.aspreconditioner().matvec
    return cycle


def _entries(matrix: "csr_array", start: Ints, column: npt.NDArray[np.int32]) -> Floats:
    """Values of a sparse matrix at the places of a pattern that holds all of its own."""
    rows = len(start) - 1
    known = np.repeat(np.arange(rows), np.diff(start)) * rows + column
    entry = matrix.tocoo()
    values = np.zeros(len(column))
    np.add.at(values, np.searchsorted(known, entry.row.astype(np.int64) * rows + entry.col), entry.data)
    return values


def pressure_scale(matrices: Matrices) -> Floats:
    """Give about the inverse of the pressure's Schur complement, (vertices,) array: twice that of the mass' diagonal.

    The factor, by trial on mats with and without slip: 1 takes a fifth more iterations, 4 a tenth.
    """
    row = np.repeat(np.arange(matrices.vertices), np.diff(matrices.vertex_start))
    scale: Floats = 2.0 / matrices.mass[row == matrices.vertex_column]
    return scale
