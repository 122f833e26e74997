"""Work on a flow that is shared by threads: what is found does not depend on them."""

# SPDX-License-Identifier: GPL-3.0-or-later

import dataclasses

import numpy as np
import pytest

from pipeline.mesh.wall_fibers import wall_fibers
from pipeline.progress import silent
from pipeline.solve.bed import Bed
from pipeline.solve.settings import StokesSettings
from pipeline.solve.stokes import sharing, sweeps
from pipeline.solve.stokes.sharing import Team, team
from pipeline.solve.stokes.solver import solve_stokes
from tests.openfoam import AIR
from tests.solve.rows import rows


def test_three_threads_find_what_one_does_to_the_last_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    # rows are cut into the same shares whoever does them; only norms are left to libraries with threads of their own
    monkeypatch.setattr(sharing, "_MANY", 1)
    mesh, domain = rows(0.1, around=4, outward=3)
    faces = mesh.face_mesh()
    faces = dataclasses.replace(faces, fiber=wall_fibers(faces, domain))
    found = [
        solve_stokes(faces, domain, AIR, Bed(1.0, 1.0), 0.1, "slip", "symmetry", StokesSettings(), silent, cores=cores)[
            0
        ]
        for cores in (1, 3)
    ]
    assert found[0].iterations == found[1].iterations
    assert found[0].pressure_drop == pytest.approx(found[1].pressure_drop, rel=1e-10)
    assert found[0].drag_per_fiber == pytest.approx(found[1].drag_per_fiber, rel=1e-10)


@pytest.mark.parametrize("size", [1, 7, 5000, 40_000])
def test_sums_over_all_rows_are_the_same_for_any_threads(size: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sharing, "_MANY", 1)
    draw = np.random.default_rng(size)
    basis, x = draw.normal(size=(7, size)), draw.normal(size=size)
    weights = draw.normal(size=6)
    found = []
    for cores in (1, 3):
        with team(cores) as threads:
            added = x.copy()
            threads.over(0, size, sweeps.add_weighted, basis, weights, added)
            found.append((threads.sums(size, sweeps.products, 6, basis, 6, x), added))
    assert np.array_equal(found[0][0], found[1][0])
    assert np.array_equal(found[0][1], found[1][1])
    exact = basis[:6]
    assert found[0][0] == pytest.approx(exact @ x, rel=0, abs=1e-12 * size)
    assert found[0][1] == pytest.approx(x + weights @ exact, rel=0, abs=1e-13)


def test_every_row_is_in_one_share(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sharing, "_MANY", 1)
    for first, end in ((0, 3), (5, 29), (0, 1000)):
        visits = np.zeros(1000, int)

        def visit(low: int, high: int, visits: np.ndarray[tuple[int], np.dtype[np.int_]] = visits) -> None:
            visits[low:high] += 1

        with team(2) as threads:
            threads.over(first, end, visit)
        assert (visits[first:end] == 1).all()
        assert visits.sum() == end - first


def test_a_sweep_over_one_share_is_gauss_and_seidels() -> None:
    # each row's new value solves its own equation with the newest values of the others
    rng = np.random.default_rng(2)
    matrix = rng.normal(size=(6, 6)) + 8.0 * np.eye(6)
    start, column = np.arange(0, 37, 6), np.tile(np.arange(6, dtype=np.int32), 6)
    right, x = rng.normal(size=(2, 6, 3))
    before, fixed = x.copy(), np.zeros((6, 3), np.uint8)
    fixed[2, 1] = 1
    sweeps.sweep(0, 6, start, column, matrix.ravel(), 1.0 / np.diag(matrix), fixed, right, before, x, False)
    by_hand = before.copy()
    for row in range(6):
        new = by_hand[row] + (right[row] - matrix[row] @ by_hand) / matrix[row, row]
        by_hand[row] = np.where(fixed[row], by_hand[row], new)
    assert x == pytest.approx(by_hand, rel=1e-12)
    assert x[2, 1] == before[2, 1]


def test_shares_read_what_the_others_were_and_not_what_they_become() -> None:
    rng = np.random.default_rng(3)
    matrix = rng.normal(size=(16, 16)) + 20.0 * np.eye(16)
    start, column = np.arange(0, 257, 16), np.tile(np.arange(16, dtype=np.int32), 16)
    right, first = rng.normal(size=(2, 16, 3))
    fixed, over = np.zeros((16, 3), np.uint8), 1.0 / np.diag(matrix)
    found = []
    for order in (range(sharing.SHARES), reversed(range(sharing.SHARES))):
        x = first.copy()
        for share in order:
            sweeps.sweep(2 * share, 2 * share + 2, start, column, matrix.ravel(), over, fixed, right, first, x, True)
        found.append(x)
    assert np.array_equal(*found)
    shared = first.copy()
    Team().over(0, 16, sweeps.sweep, start, column, matrix.ravel(), over, fixed, right, first, shared, True)
    assert np.array_equal(shared, found[0])
