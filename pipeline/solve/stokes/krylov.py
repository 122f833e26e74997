"""Generalized minimal residuals, restarted, with a preconditioner on the right: the least that a flow needs of it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable
from typing import Protocol

import numpy as np

from pipeline.nouns.arrays import Floats
from pipeline.solve.stokes import sweeps
from pipeline.solve.stokes.sharing import Team

Linear = Callable[[Floats], Floats]


class Memory(Protocol):
    """What knows the iterations of a run that was stopped."""

    def begin(self, start: Floats) -> tuple[Floats, int]:
        """Give what to start from, and the iterations that led to it."""

    def recall(self, basis: Floats, hessenberg: Floats) -> int:
        """Put back what a round has of vectors and products, and give how many iterations they make."""

    def keep(self, basis: Floats, hessenberg: Floats, count: int) -> None:
        """Take note of the first iterations of a round."""

    def again(self, found: Floats, done: int) -> None:
        """Take note of the iterate that another round starts from."""


def gmres(
    matrix: Linear,
    preconditioner: Linear,
    right: Floats,
    start: Floats,
    settled: Callable[[int, Floats], bool],
    restart: int = 60,
    look_every: int = 6,
    most: int = 1000,
    memory: Memory | None = None,
    team: Team | None = None,
) -> tuple[Floats, int, bool]:
    """Solve a linear system until a function of the iterate says that it has settled.

    Parameters
    ----------
    matrix, preconditioner : callable
        Linear maps of (n,) arrays.
    right, start : (n,) arrays
    settled : callable
        Given the iterations so far and the iterate; asked every `look_every` iterations.
    restart : int
        Iterations after which the basis is dropped: it holds as many vectors.
    look_every : int
    most : int
        Iterations after which it is given up.
    memory : Memory, optional
        Of a run that may have been stopped: what it found comes out again.
    team : Team, optional
        Who shares the work; one core does all where there is none.

    Returns
    -------
    found : (n,) array
    iterations : int
    settled : bool

    Notes
    -----
    Saad & Schultz 1986. The basis is made orthogonal by classical Gram-Schmidt, two products with all of it at once.
    Their sums are added up share by share, so that they do not depend on who adds them.
    """
    found, done = (start.copy(), 0) if memory is None else memory.begin(start)
    basis = np.empty((restart + 1, len(right)))
    share, rows = team or Team(), len(right)
    while True:
        rest = right - matrix(found)
        size = float(np.linalg.norm(rest))
        if size == 0.0:
            return found, done, settled(done, found)
        basis[0] = rest / size
        hessenberg = np.zeros((restart + 1, restart))
        known = 0 if memory is None else memory.recall(basis, hessenberg)
        for k in range(restart):
            if k >= known:
                following = matrix(preconditioner(basis[k]))
                along = share.sums(rows, sweeps.products, k + 1, basis, k + 1, following)
                share.over(0, rows, sweeps.add_weighted, basis, -along, following)
                hessenberg[: k + 1, k] = along
                hessenberg[k + 1, k] = np.linalg.norm(following)
            done += 1
            last = k + 1 == restart or done == most or hessenberg[k + 1, k] == 0.0
            if not last and k >= known:
                basis[k + 1] = following / hessenberg[k + 1, k]
                if memory is not None:
                    memory.keep(basis, hessenberg, k + 1)
            if last or done % look_every == 0:
                target = np.zeros(k + 2)
                target[0] = size
                weights = np.linalg.lstsq(hessenberg[: k + 2, : k + 1], target, rcond=None)[0]
                step = np.zeros(rows)
                share.over(0, rows, sweeps.add_weighted, basis, weights, step)
                now = found + preconditioner(step)
                if settled(done, now):
                    return now, done, True
                if done == most:
                    return now, done, False
                if last:
                    found = now
                    if memory is not None:
                        memory.again(found, done)
                    break
