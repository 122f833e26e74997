"""Generalized minimal residuals, restarted, with a preconditioner on the right: the least that a flow needs of it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from collections.abc import Callable

import numpy as np

from pipeline.nouns.arrays import Floats

Linear = Callable[[Floats], Floats]


def gmres(
    matrix: Linear,
    preconditioner: Linear,
    right: Floats,
    start: Floats,
    settled: Callable[[int, Floats], bool],
    restart: int = 60,
    look_every: int = 6,
    most: int = 1000,
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

    Returns
    -------
    found : (n,) array
    iterations : int
    settled : bool

    Notes
    -----
    Saad & Schultz 1986. The basis is made orthogonal by classical Gram-Schmidt, two products with all of it at once.
    """
    found, done = start.copy(), 0
    basis = np.empty((restart + 1, len(right)))
    while True:
        rest = right - matrix(found)
        size = float(np.linalg.norm(rest))
        if size == 0.0:
            return found, done, settled(done, found)
        basis[0] = rest / size
        hessenberg = np.zeros((restart + 1, restart))
        for k in range(restart):
            following = matrix(preconditioner(basis[k]))
            along = basis[: k + 1] @ following
            following -= along @ basis[: k + 1]
            hessenberg[: k + 1, k] = along
            hessenberg[k + 1, k] = np.linalg.norm(following)
            done += 1
            last = k + 1 == restart or done == most or hessenberg[k + 1, k] == 0.0
            if not last:
                basis[k + 1] = following / hessenberg[k + 1, k]
            if last or done % look_every == 0:
                target = np.zeros(k + 2)
                target[0] = size
                weights = np.linalg.lstsq(hessenberg[: k + 2, : k + 1], target, rcond=None)[0]
                now = found + preconditioner(weights @ basis[: k + 1])
                if settled(done, now):
                    return now, done, True
                if done == most:
                    return now, done, False
                if last:
                    found = now
                    break
