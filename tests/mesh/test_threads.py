"""The mesh is the same however many cores make it."""

# SPDX-License-Identifier: GPL-3.0-or-later

from pathlib import Path

import numpy as np
import pytest

from pipeline.case import read_case
from pipeline.enclosure.duct import enclose
from pipeline.geometry import threads
from pipeline.mat.generate import generate
from pipeline.mesh.fill import fill
from pipeline.surface.union import unite

CASES = Path(__file__).parents[2] / "cases"


def test_one_core_and_five_make_the_same_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    case = read_case(CASES / "smoke.toml")
    domain = enclose(unite(generate(case.mat), case.surface), case.enclosure)
    meshes = []
    for cores in (1, 5):
        monkeypatch.setattr(threads, "cores", lambda cores=cores: cores)
        # so few rows for a thread that every loop of a small mesh is cut into parts
        monkeypatch.setattr(threads, "_LEAST", 50)
        meshes.append(fill(domain, case.tetmesh)[0])
    one, five = meshes
    for name in ("points", "corners", "owner", "neighbour", "fiber"):
        np.testing.assert_array_equal(getattr(one, name), getattr(five, name))


def test_every_row_is_done_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "cores", lambda: 3)
    for count in (0, 1, 7, 100, 1001):
        done = np.zeros(count, np.int64)

        def work(begin: int, end: int, done: np.ndarray = done) -> None:
            done[begin:end] += 1

        threads.in_parts(work, count, 2)
        assert (done == 1).all()
